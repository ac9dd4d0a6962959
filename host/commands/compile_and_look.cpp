#include "host/commands/compile_and_look.h"

#include <fmt/core.h>

#include <new>

#include "common/compile/darkness.h"
#include "host/process/console.h"

namespace rayfarm {

CompiledScene compile_and_look(const SceneDescription& scene, const BuildOptions& build) try {
  CompiledScene compiled = compile(scene, build);
  const int frame = scene.frames ? (*scene.frames)[0] : 0;
  const auto [width, height] = scene.view.size_px();
  try {
    if (const auto problem = nothing_in_view(compiled.scene, frame, width, height))
      compiled.notes.add(scene.source(), fmt::format("at frame {}: {}", frame, *problem));
  } catch (const std::domain_error& e) {
    throw InputError({scene.files.at(0)}, fmt::format("at frame {}: {}", frame, e.what()));
  }
  RenderSettings paths;
  paths.lighting = LightingModel::path;
  if (is_dark(compiled.scene, paths) && !is_dark(compiled.scene, {}))
    compiled.notes.add(
        scene.source(),
        "`--lighting path` shows the scene black: it leaves ambient light out, and nothing else "
        "lights the scene");
  for (const std::string& note : compiled.notes.lines()) say("rayfarm: {}\n", note);
  return compiled;
} catch (const std::bad_alloc&) {
  throw IoError(fmt::format("{}: the scene needs more memory than there is", scene.files.at(0)));
}

}  // namespace rayfarm
