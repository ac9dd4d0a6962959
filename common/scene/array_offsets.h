#pragma once
// Arrays of one scene that join another's: indices in their elements move by where each array's elements go.
// What is in an element is named here field by field, so that none can be forgotten: a new field, or a new
// element of `geometry` in scene_arrays.inc, does not compile until it is told here what becomes of it.
#include "common/scene/scene.h"

namespace rayfarm {

/// What becomes of an array when objects are taken from a file of their own.
enum class ArrayRole {
  geometry,   ///< its elements are appended, with their indices moved
  described,  ///< its elements become part of the description, and are compiled again
  remade      ///< it is made anew from the others
};

template <typename>
using ArrayOffset = uint32_t;
/// By array: how many elements stand before those that are appended.
using ArrayOffsets = SceneArrays<ArrayOffset>;

/// Its name in the list.
enum class ArrayName {
#define RAYFARM_ARRAY(element, name, role) name,
#include "common/scene/scene_arrays.inc"
#undef RAYFARM_ARRAY
};

inline ArrayOffsets offsets_behind(const SceneArrays<GrowingArray>& arrays) {
  ArrayOffsets offsets;
#define RAYFARM_ARRAY(element, name, role) offsets.name = static_cast<uint32_t>(arrays.name.size());
#include "common/scene/scene_arrays.inc"
#undef RAYFARM_ARRAY
  return offsets;
}

/// Plain values.
inline void shift(glm::vec3&, const ArrayOffsets&) {}
inline void shift(glm::vec2&, const ArrayOffsets&) {}
inline void shift(VertexColor&, const ArrayOffsets&) {}
inline void shift(Vec3&, const ArrayOffsets&) {}
inline void shift(Vec4&, const ArrayOffsets&) {}

void shift(VolumeNode& node, const ArrayOffsets& offsets);
void shift(TriangleBlock& block, const ArrayOffsets& offsets);
void shift(SphereBlock& block, const ArrayOffsets& offsets);
void shift(Collection& collection, const ArrayOffsets& offsets);
void shift(Grid& grid, const ArrayOffsets& offsets);
void shift(BoundingTree& tree, const ArrayOffsets& offsets);
void shift(BoundingNode& node, const ArrayOffsets& offsets);
inline void shift(BoundingVolume&, const ArrayOffsets&) {}
void shift(Octree& octree, const ArrayOffsets& offsets);
void shift(OctreeNode& node, const ArrayOffsets& offsets);
void shift(OctreeCell& cell, const ArrayOffsets& offsets);
void shift(OctantTree& tree, const ArrayOffsets& offsets);
void shift(OctantVolume& volume, const ArrayOffsets& offsets);
void shift(PrimitivePointer& pointer, const ArrayOffsets& offsets);
void shift(PrimitiveId& id, const ArrayOffsets& offsets);
void shift(SphereRecord& sphere, const ArrayOffsets& offsets);
void shift(Polygon& polygon, const ArrayOffsets& offsets);
void shift(Quadric& quadric, const ArrayOffsets& offsets);
void shift(TriangleShading& shading, const ArrayOffsets& offsets);
void shift(LuminaireTriangle& triangle, const ArrayOffsets& offsets);
void shift(MeshFace& face, const ArrayOffsets& offsets);
void shift(Part& part, const ArrayOffsets& offsets);
void shift(Material& material, const ArrayOffsets& offsets);
void shift(PrincipledMaterial& material, const ArrayOffsets& offsets);
void shift(Light& light, const ArrayOffsets& offsets);

/// Of the array `name`: where elements are bare numbers, the array tells what they are.
template <ArrayName name, typename T>
void shift_element(T& element, const ArrayOffsets& offsets) {
  if constexpr (name == ArrayName::face_corners)
    element += offsets.mesh_points;
  else if constexpr (name == ArrayName::face_normals)
    element += offsets.normals;
  else if constexpr (name == ArrayName::grid_cells)
    element += offsets.primitive_pointers;
  else if constexpr (name != ArrayName::octree_hash)  // its numbers are the octree's own
    shift(element, offsets);
}

}  // namespace rayfarm
