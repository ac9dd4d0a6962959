#pragma once
// Description to compiled scene: shapes become flat records, objects become parts with a volume hierarchy
// below each, and the object tree is expanded into instances with a hierarchy of boxes over them.
#include "common/hierarchy/builder.h"
#include "common/scene/scene_block.h"
#include "common/scene/scene_description.h"

namespace rayfarm {

struct CompiledScene {
  SceneBlock block;
  Scene scene;  ///< a view into the block
  Notes notes;  ///< of loading and compiling
};

/// Throws InputError for what only shows while compiling: a quadric that its planes don't bound, a view
/// without a direction, an object that an animation flattens at its first frame.
CompiledScene compile(const SceneDescription& description, const BuildOptions& options = {});

/// The instances that the object tree expands to, stopping at `most` + 1.
size_t count_instances(const SceneDescription& description, size_t most);

}  // namespace rayfarm
