#include <fmt/core.h>

#include <filesystem>

#include "common/compile/compile.h"
#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/mesh_scene.h"
#include "common/description/part_file.h"
#include "common/image/image_file.h"
#include "host/commands/commands.h"
#include "host/commands/hierarchy_options.h"
#include "host/commands/load_options.h"
#include "host/process/console.h"
#include "host/process/exit_code.h"
#include "host/process/interrupt.h"

namespace rayfarm {
namespace {

struct CompileOptions {
  std::string scene, output;
  LoadOptions load;
  BuildOptions build;
};

void check_options(const CompileOptions& o) {
  if (extension_of(o.output) != ".rfp")
    throw UsageError(fmt::format("-o {}: the name must end in .rfp", o.output));
  if (extension_of(o.scene) == ".rfp")
    throw UsageError(
        fmt::format("{}: is compiled already; compile the scene that it was made from", o.scene));
}

int compile_objects(const CompileOptions& o) try {
  const StopOnInterrupt stop;
  LoadOptions load = o.load;
  load.stop = stop.token();
  const SceneDescription scene =
      find_mesh_format(o.scene) ? load_bare_mesh(o.scene, load) : load_scene(o.scene, load);
  BuildOptions build = o.build;
  build.stop = stop.token();
  const CompiledScene compiled = compile(scene, build, Purpose::library);
  for (const std::string& note : compiled.notes.lines()) say("rayfarm: {}\n", note);
  if (compiled.scene.instances.empty() && compiled.scene.lights.empty())
    throw InputError(scene.source(), "there is no object in it that could be compiled");
  if (compiled.scene.object_nodes.size() > limits::kObjects)
    throw InputError(scene.source(),
                     fmt::format("it expands to {} objects; a file of compiled objects holds at most {}",
                                 compiled.scene.object_nodes.size(), limits::kObjects));
  throw_if_stopped(stop.token());
  write_part_file(o.output, compiled.block, o.scene);
  fmt::print("{}\n", o.output);
  return kComplete;
} catch (const Stopped&) {
  say("rayfarm: stopped before {} was written\n", o.output);
  return kStopped;
}

}  // namespace

void add_compile_command(CommandLine& line) {
  const auto o = std::make_shared<CompileOptions>();
  Verb verb;
  verb.name = "compile";
  verb.help = "build the hierarchies of a scene's objects once, into a file that scenes use";
  verb.examples = {{"rayfarm compile trees.obj -o trees.rfp", "for `use: {file: trees.rfp}` in scenes"}};
  verb.check = [o](const auto&) { check_options(*o); };
  verb.run = [o](const Renders&) { return compile_objects(*o); };
  Options options = line.add(std::move(verb));
  options.text("SCENE", o->scene, ".yaml, .nff, .glb, .gltf or a mesh, whose objects are compiled")
      .required();
  options.begin_group("Output");
  options.text("-o,--output", o->output, "FILE.rfp, for `use: {file: FILE.rfp}` in scenes; required", "FILE")
      .required();
  add_load_options(options, o->load);
  options.begin_group("Hierarchy");
  add_hierarchy_options(options, o->build);
}

}  // namespace rayfarm
