#pragma once
// The beginning of a job: the scene is loaded while the nodes report.
#include "common/compile/compile.h"
#include "host/farm/roll_call.h"
#include "host/render/render_options.h"

namespace rayfarm {

struct LoadedScene {
  RenderOptions options;  ///< with what the scene asks for
  SceneDescription description;
  CompiledScene compiled;
  std::vector<uint32_t> open_objects;  ///< where rays have to know what they are in
  double load_s = 0, build_s = 0;
};

/// Loads and compiles the scene while the nodes report, until both are done. A scene that can't be loaded
/// ends the job at once, whoever has reported. Throws what loading throws, and JobError (see RollCall).
LoadedScene load_while_nodes_report(const RenderOptions& options, RollCall& roll_call);

}  // namespace rayfarm
