#pragma once
// What is asked for and changes nothing, said once.
#include "common/compile/compile.h"
#include "common/compile/parts.h"

namespace rayfarm {

/// `built`: primitives that were given to the builder.
void add_notes_of_idle(const SceneDescription& description, const BuildOptions& options, Purpose purpose,
                       const Scene& scene, size_t built, const InUse& in_use, Notes& notes);

}  // namespace rayfarm
