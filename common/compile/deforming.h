#pragma once
// Objects whose shape changes from frame to frame: their parts, the first of the scene.
#include <functional>
#include <map>
#include <vector>

#include "common/description/scene_description.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// True if the object's shape changes: one of its meshes has a skin whose bones move, or a morph target whose
/// weight changes. Others keep the shape that the still skin or weights give them.
bool changes_shape(const SceneDescription& description, const ObjectDescription& object);

/// Stores what vertices are made of.
class VertexCompiler {
 public:
  /// Both must outlive it.
  VertexCompiler(SceneArrays<GrowingArray>& arrays, const SceneDescription& description)
      : arrays_(arrays), description_(description) {}
  void add(const MeshShape& mesh);
  /// When all vertices are there.
  void finish();

 private:
  uint32_t first_bone_of(uint32_t skeleton);
  SceneArrays<GrowingArray>& arrays_;
  const SceneDescription& description_;
  std::map<uint32_t, uint32_t> first_bones_;  ///< by skeleton
};

/// The mesh as its skin and targets have it, of an object that does not change its shape.
PrimitiveDescription make_still(const SceneDescription& description, const PrimitiveDescription& primitive);

/// Adds a part for each of the objects (indices) that has triangles, as the first frame has it, before
/// anything else is in the arrays but materials and textures; sets `part_of` (by object). Throws InputError
/// for one that has other shapes, or no finite place, and Stopped. `is_stored`: called with each object when
/// its meshes are needed no more.
void add_deforming_parts(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                         std::span<const uint32_t> objects, const BuildOptions& options,
                         std::span<uint32_t> part_of, const std::function<void(uint32_t)>& is_stored);

}  // namespace rayfarm
