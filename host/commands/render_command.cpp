#include "host/commands/commands.h"
#include "host/commands/render_words.h"
#include "host/commands/scene_choices.h"

namespace rayfarm {

void add_render_command(CommandLine& line) {
  const auto o = std::make_shared<RenderOptions>();
  Verb verb;
  verb.name = "render";
  verb.help = "render a scene to image files";
  verb.examples = {{"rayfarm render scene.yaml -o picture.png", "a still, by all cores of this machine"},
                   {"mpirun -n 9 rayfarm render shot.yaml -o out/shot.####.exr --frames 1-24",
                    "an animation, on one host and eight nodes"},
                   {"rayfarm render model.glb -o picture.png --lighting path --samples 256",
                    "a model by itself, lit as in nature"}};
  verb.check = [o](const std::vector<std::string>& words) { check_until_scene_is_known(*o, words); };
  verb.run = [o](const Renders& renders) { return renders.as_launched(*o); };
  verb.is_for_all_ranks = true;
  Options options = line.add(std::move(verb));
  add_render_options(options, *o);
}

}  // namespace rayfarm
