#pragma once
// What a hierarchy is made of in the scene block: nodes, and the blocks of primitives that are tested eight
// at a time.
#include <array>
#include <cstdint>

#include "common/math/box.h"
#include "common/shapes/primitive_id.h"

namespace rayfarm {

/// How a part's primitives are found.
enum class Structure : uint32_t {
  volumes,  ///< a tree of volumes (thesis 4.2)
  list      ///< one by one, all of them: for parts of few primitives, and as the judge of the others
};

/// What a child slot of a volume node leads to. `meta` = kind << 29 | count.
enum class ChildKind : uint32_t {
  empty,
  inner,      ///< first = node
  triangles,  ///< first = triangle block, count blocks
  spheres,    ///< first = sphere block, count blocks
  mixed,      ///< first = index into leaf_primitives, count primitives (large or concave polygons, quadrics)
  instances   ///< first = index into leaf_instances, count instances
};
struct ChildRef {
  uint32_t first = 0;
  uint32_t meta = 0;
  ChildKind kind() const { return static_cast<ChildKind>(meta >> 29); }
  uint32_t count() const { return meta & 0x1fffffffu; }
};
constexpr ChildRef make_child(ChildKind kind, uint32_t first, uint32_t count = 1) {
  return {first, static_cast<uint32_t>(kind) << 29 | count};
}

/// Eight child boxes, structure of arrays, rounded outward; an unused slot is an inverted box. 256 bytes.
struct alignas(64) VolumeNode {
  std::array<std::array<std::array<float, 8>, 3>, 2> planes;  ///< [low, high][axis][child]
  std::array<ChildRef, 8> children;
};

/// Up to eight triangles, structure of arrays: meshes' and those that small convex polygons are cut into.
/// Unused lanes hold NaN, which no test accepts. 320 bytes.
struct alignas(64) TriangleBlock {
  std::array<std::array<std::array<float, 8>, 3>, 3> vertices;  ///< [vertex][axis][lane]
  std::array<PrimitiveId, 8> primitives;                        ///< whose triangle it is
};

/// Up to eight spheres, structure of arrays; unused lanes hold NaN. 320 bytes with its padding.
struct alignas(64) SphereBlock {
  std::array<std::array<double, 8>, 3> center;  ///< [axis][lane]
  std::array<double, 8> radius;
  std::array<uint32_t, 8> spheres;
};

/// A traverser's stack must hold this many levels, one of them made by the structurer.
inline constexpr int kMostHierarchyLevels = 72;

/// The nearest float that is not above, or not below.
float round_down(double v);
float round_up(double v);

/// A node with eight unused slots.
VolumeNode make_empty_node();
/// Stores a box outward: the float box holds the double one with a margin for the rounding of hit points.
void set_child(VolumeNode& node, size_t slot, const Box& box, ChildRef child);
/// The union of a node's child boxes.
Box bounds_of(const VolumeNode& node);
Box child_box(const VolumeNode& node, size_t slot);

}  // namespace rayfarm
