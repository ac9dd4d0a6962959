#pragma once
// Description to compiled scene: shapes become flat records, objects become parts with a volume hierarchy
// below each, and the object tree is expanded into instances with a hierarchy of boxes over them.
#include "common/description/scene_description.h"
#include "common/hierarchy/builder.h"
#include "common/scene/scene_block.h"

namespace rayfarm {

struct CompiledScene {
  SceneBlock block;
  Scene scene;                    ///< a view into the block
  Notes notes;                    ///< of loading and compiling
  std::vector<uint32_t> objects;  ///< by node of the object tree: which of the description's it is
};

/// For what a compiled scene is.
enum class Purpose {
  pictures,
  library  ///< to be taken into scenes: the objects alone. Each node stays one, as if it were defined there
};

/// Throws InputError for what only shows while compiling: a quadric that its planes don't bound, a view
/// without a direction, an object that an animation flattens at its first frame.
CompiledScene compile(const SceneDescription& description, const BuildOptions& options = {},
                      Purpose purpose = Purpose::pictures);

/// The same, but what is compiled of meshes leaves the description at once: it and the scene never stand
/// beside each other as wholes. Their primitives stay, without points or faces.
CompiledScene compile_away(SceneDescription& description, const BuildOptions& options = {},
                           Purpose purpose = Purpose::pictures);

}  // namespace rayfarm
