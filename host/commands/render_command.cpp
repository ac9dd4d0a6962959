#include "host/commands/commands.h"
#include "host/commands/render_words.h"
#include "host/commands/scene_choices.h"

namespace rayfarm {

void add_render_command(CommandLine& line) {
  const auto o = std::make_shared<RenderOptions>();
  Verb verb;
  verb.name = "render";
  verb.help = "render a scene to image files";
  verb.check = [o](const std::vector<std::string>& words) { check_until_scene_is_known(*o, words); };
  verb.run = [o](const Renders& renders) { return renders.as_launched(*o); };
  verb.is_for_all_ranks = true;
  Options options = line.add(std::move(verb));
  add_render_options(options, *o);
}

}  // namespace rayfarm
