#pragma once
// What scenes are read for: --clip, --fps, --camera and --up.
#include "common/description/load_options.h"
#include "host/commands/command_line.h"

namespace rayfarm {

/// What a scene may be in, for help.
inline constexpr const char* kSceneKinds =
    ".yaml, .nff, .glb, .gltf, a mesh (.obj, .off, .ply, .stl) or .rfp";

void add_load_options(Options& options, LoadOptions& load);

}  // namespace rayfarm
