#pragma once
// What a hierarchy is made of in the scene block: nodes, and the blocks of primitives that are tested eight
// at a time.
#include <array>
#include <cstdint>

#include "common/math/box.h"
#include "common/scene/build_options.h"
#include "common/shapes/primitive_id.h"

namespace rayfarm {

/// How the primitives of a collection are found.
enum class Structure : uint32_t {
  volumes,   ///< a tree of volumes (thesis 4.2)
  list,      ///< one by one, all of them: for few primitives, and as the judge of the others
  regular,   ///< in equal cells (thesis 2.6.2)
  adaptive,  ///< in an octree's cells (thesis 2.6.2; Glassner 1984)
  object,    ///< in bounding volumes about objects (thesis 2.6.1)
  octants    ///< in spheres about the data of octants (thesis 4.2, to the letter)
};

/// What a child slot of a volume node leads to. `meta` = kind << 29 | count.
enum class ChildKind : uint32_t {
  empty,
  inner,      ///< first = node
  triangles,  ///< first = triangle block, count blocks
  spheres,    ///< first = sphere block, count blocks
  mixed,      ///< first = index into leaf_primitives, count primitives (large or concave polygons, quadrics,
              ///< collections)
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

/// A primitive as lists of cells name it (the thesis's pointer), by where its numbers stand. A primitive that
/// was cut into triangles is named once, by the first of them; the others follow it.
enum class PointerKind : uint32_t {
  triangle,  ///< 8 × block + lane in triangle_blocks
  sphere,    ///< 8 × block + lane in sphere_blocks
  other      ///< an index into leaf_primitives
};
struct PrimitivePointer {
  uint32_t bits = 0;  ///< kind << 30 | place
  PointerKind kind() const { return static_cast<PointerKind>(bits >> 30); }
  uint32_t place() const { return bits & 0x3fffffffu; }
};
constexpr PrimitivePointer make_pointer(PointerKind kind, uint32_t place) {
  return {static_cast<uint32_t>(kind) << 30 | place};
}

/// Of a grid, along an axis.
inline constexpr uint32_t kMostCells = 512;

/// A box in equal cells. Each has a list of the primitives that have a part in it.
struct Grid {
  Vec3 low{0};                      ///< the box's corner
  Vec3 cell{0};                     ///< a cell's edges
  std::array<uint32_t, 3> cells{};  ///< along each axis
  uint32_t first_cell =
      0;  ///< in grid_cells; x runs fastest. One more stands behind the last: where its list ends
  size_t cell_count() const { return size_t{cells[0]} * cells[1] * cells[2]; }
  size_t index(uint32_t x, uint32_t y, uint32_t z) const { return (size_t{z} * cells[1] + y) * cells[0] + x; }
  Box box() const { return {low, low + cell * Vec3(cells[0], cells[1], cells[2])}; }
};

/// Of an octree: how often its cube may be halved, so that names of cells fit into 64 bits.
inline constexpr uint32_t kMostOctreeDepth = 20;

/// Of an octree's hash table.
inline constexpr uint32_t kMostHashPlaces = 1'000'000;

/// A cube that is halved about its centre, into eight, where it holds much. Lengths inside are counted in
/// halves of the smallest edge that a cell may have, from the cube's corner.
struct Octree {
  Vec3 low{0};                                ///< the cube's corner
  double unit = 0;                            ///< a half of the smallest edge
  uint32_t size = 0;                          ///< of the cube, in units: a power of two
  OctreeNext next = OctreeNext::root;         ///< how rays find their way
  uint32_t first_node = 0, node_count = 0;    ///< in octree_nodes; the first is the root
  uint32_t first_cell = 0, cell_count = 0;    ///< in octree_cells
  uint32_t first_place = 0, place_count = 0;  ///< of the hash table, in octree_hash; none: by pointers
  uint32_t max_primitives = 1;                ///< a cell that holds more is divided
  /// While tracing: the octree is one cell here, and what is made of it belongs to the process
  /// (TracingState).
  OctreeBuild build = OctreeBuild::before;
  Box box() const { return {low, low + Vec3(unit * size)}; }
};

/// A node of the tree that tells how an octree was made (the thesis's construction tree). Octants without
/// data have none. Indices are the octree's own.
struct OctreeNode {
  uint32_t size = 0;                 ///< its edges, in units
  std::array<uint32_t, 3> center{};  ///< in units
  uint32_t child = kNone;    ///< of one that is divided the first; else its cell, kNone where names find it
  uint32_t sibling = kNone;  ///< the next octant with data; kNone behind the last
  uint32_t is_divided = 0;
};

/// What an undivided node holds.
struct OctreeCell {
  uint64_t name = 0;           ///< of the root 1, of a child 8 × its parent's + octant
  uint32_t first_pointer = 0;  ///< in primitive_pointers
  uint32_t pointer_count = 0;
  uint32_t next = kNone;  ///< the next cell at its place in the hash table
  uint32_t padding = 0;
};

/// A volume of the thesis's (4.2.1.2, Table 4.4): an interior one, which is divided into octants about its
/// centre, or a leaf with a list of the primitives that have a part in it. All of them lie in the sphere.
struct OctantVolume {
  Vec3 center{0};  ///< of the sphere, and "the origin of the local coordinate system": the thesis's 24 bytes
                   ///< hold one point
  double radius = 0;     ///< with a margin
  uint32_t octants = 0;  ///< of an interior one bit i: octant i of Table 4.1 holds data; 0: a leaf
  /// Of an interior one the first of its octants in its tree's volumes, which stand side by side in ascending
  /// order; of a leaf the first of its list in primitive_pointers.
  uint32_t first = 0;
  uint32_t pointer_count = 0;  ///< of a leaf
  uint32_t padding = 0;
  bool is_leaf() const { return octants == 0; }
};

/// A tree of such volumes.
struct OctantTree {
  double magnitude = 0;                         ///< the largest of a coordinate in it
  uint32_t first_volume = 0, volume_count = 0;  ///< in octant_volumes; the first is the root
};

/// A shape about all that is in an object or group, larger by its tree's margin.
struct BoundingVolume {
  VolumeKind kind = VolumeKind::sphere;
  uint32_t padding = 0;
  /// Sphere: centre, radius. Box: low corner, high corner. Cylinder: the axis's middle, its direction (a unit
  /// vector), radius, half its height. Slabs: the least and the greatest distance along each of the normals.
  std::array<double, 14> numbers{};
};

/// An object with its primitives, or a group of what is in it.
struct BoundingNode {
  uint32_t first_child = 0, child_count = 0;    ///< of a group: behind it in bounding_nodes
  uint32_t first_volume = 0, volume_count = 0;  ///< in bounding_volumes: what is in it lies in all of them
  /// Of an object: the instance that has it, in whose space its volumes don't stand. kNone: the one whose
  /// collection the tree belongs to.
  uint32_t instance = kNone;
  uint32_t padding = 0;
  /// Of an object: its triangles, spheres and others. All empty where it is an instance as a whole.
  std::array<ChildRef, 3> leaves{};
  bool is_group() const { return child_count > 0; }
  bool has_leaves() const { return leaves[0].count() + leaves[1].count() + leaves[2].count() > 0; }
};

/// A hierarchy of objects: the root is a node, below it come groups and objects.
struct BoundingTree {
  uint32_t root = 0;  ///< in bounding_nodes
  ObjectOrder order = ObjectOrder::sorted;
  double magnitude = 0;  ///< the largest of a coordinate in it
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
