#pragma once
// The structurer (Shirley, Sung and Brown's word; of any Structure): turns the builder's leaves into the
// records that the traverser tests eight at a time.
#include "common/hierarchy/builder.h"
#include "common/shapes/sphere.h"

namespace rayfarm {

/// The growing arrays that leaves are packed into.
struct LeafArrays {
  LargeVector<VolumeNode>& nodes;
  LargeVector<TriangleBlock>& triangle_blocks;
  LargeVector<SphereBlock>& sphere_blocks;
  LargeVector<PrimitiveId>& leaf_primitives;
};

/// A triangle's three vertices as they are stored and tested.
using TriangleVertices = std::array<glm::vec3, 3>;

/// The primitives of one part in one numbering: what the builder's references mean. A polygon that was cut
/// into triangles stands here once for each of them.
struct PartPrimitives {
  LargeVector<PrimitiveId> ids;

  void add(PrimitiveId id) {
    ids.push_back(id);
    triangle_of_.push_back(kNone);
  }
  void add_triangle(PrimitiveId id, const TriangleVertices& vertices) {
    ids.push_back(id);
    triangle_of_.push_back(static_cast<uint32_t>(triangles_.size()));
    triangles_.push_back(vertices);
  }
  /// The triangles that are added by their places in a mesh; it must stay where it is, and is not copied.
  void begin_mesh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
    const uint32_t first =
        meshes_.empty() ? 0 : meshes_.back().first + static_cast<uint32_t>(meshes_.back().triangles.size());
    meshes_.push_back({first, positions, triangles});
    make_room(ids, triangles.size());
    make_room(triangle_of_, triangles.size());
  }
  void add_mesh_triangle(PrimitiveId id, size_t triangle) {
    ids.push_back(id);
    triangle_of_.push_back(kOfMesh | (meshes_.back().first + static_cast<uint32_t>(triangle)));
  }

  /// False of what is tested as it is.
  bool is_triangle(uint32_t primitive) const { return triangle_of_[primitive] != kNone; }
  TriangleVertices triangle(uint32_t primitive) const;

 private:
  static constexpr uint32_t kOfMesh = 1u << 31;
  struct Mesh {
    uint32_t first;  ///< its first triangle among those of all meshes
    std::span<const glm::vec3> positions;
    std::span<const glm::uvec3> triangles;
  };
  LargeVector<uint32_t> triangle_of_;  ///< of triangles_, or kOfMesh and of the meshes'; or kNone
  LargeVector<TriangleVertices> triangles_;
  std::vector<Mesh> meshes_;
};

/// Packs one leaf. A leaf of several kinds becomes a node with one child per kind.
ChildRef pack_leaf(std::span<const PrimitiveReference> references, const PartPrimitives& part,
                   std::span<const SphereRecord> spheres, LeafArrays& arrays);

}  // namespace rayfarm
