#pragma once
#include "common/compile/compile.h"

namespace rayfarm {

/// What a render of the scene's first frame would refuse, or could not show: compiles, looks through the
/// camera, and says what is odd. Throws InputError.
CompiledScene compile_and_look(const SceneDescription& scene, const BuildOptions& build);

}  // namespace rayfarm
