#include "common/scene/deformation_checks.h"

#include <cmath>

#include "common/scene/check_tools.h"

namespace rayfarm {
namespace {

void check_vertices(const Scene& s, size_t count) {
  uint32_t delta = 0, influence = 0;
  for (const DeformingVertex& vertex : s.deforming_vertices) {
    require(is_finite(Vec3(vertex.position)) && is_finite(Vec3(vertex.normal)), "a vertex");
    require(vertex.first_delta >= delta && vertex.first_influence >= influence,
            "a vertex's deltas and joints");
    delta = vertex.first_delta;
    influence = vertex.first_influence;
  }
  require(delta == s.morph_deltas.size() && influence == s.joint_weights.size() &&
              (count == 0 ||
               (s.deforming_vertices[0].first_delta == 0 && s.deforming_vertices[0].first_influence == 0)),
          "the vertices' deltas and joints");
  for (const MorphDelta& d : s.morph_deltas)
    require(d.target < s.morph_weights.size() && is_finite(Vec3(d.position)) && is_finite(Vec3(d.normal)),
            "a morph target");
  for (const JointWeight& w : s.joint_weights)
    require(w.joint < s.joints.size() && std::isfinite(w.weight) && w.weight >= 0, "a vertex's joint");
  for (const Joint& joint : s.joints) require(joint.bone < s.bones.size(), "a joint");
}

/// A part's nodes and blocks are its own, and follow those of the part before: a frame has copies of them.
class OwnVolumes {
 public:
  explicit OwnVolumes(const Scene& s) : s_(s) {}

  void check(const Part& part, const DeformingPart& shape) {
    const Collection& c = part.collection;
    require(c.structure == Structure::volumes && part.sphere_block_count == 0 &&
                part.leaf_primitive_count == 0 && c.sphere_block_count == 0 && c.leaf_primitive_count == 0,
            "what changes its shape");
    require(shape.first_node == node_ && shape.node_count <= s_.nodes.size() - node_ &&
                part.first_triangle_block == block_ &&
                part.triangle_block_count <= s_.triangle_blocks.size() - block_ &&
                c.first_triangle_block == block_ && c.triangle_block_count == part.triangle_block_count,
            "the volumes of what changes its shape");
    require(std::isfinite(shape.cost) && shape.cost >= 0, "what volumes cost");
    require(shape.first_triangle == triangle_ &&
                shape.triangle_count <= s_.deforming_triangles.size() - triangle_ && shape.triangle_count > 0,
            "the triangles of what changes its shape");
    const uint32_t node = node_;
    node_ += shape.node_count;
    block_ += part.triangle_block_count;
    triangle_ += shape.triangle_count;
    check(c.root, node, part.first_triangle_block);
    require(c.root.kind() != ChildKind::inner || c.root.first == node, "a root");
    for (uint32_t i = node; i < node_; ++i)
      for (const ChildRef& child : s_.nodes[i].children) check(child, node, part.first_triangle_block);
    for (const TriangleBlock& block :
         s_.triangle_blocks.subspan(part.first_triangle_block, part.triangle_block_count))
      for (const PrimitiveId id : block.primitives)
        require(id == kNoPrimitive || (id.kind() == PrimitiveKind::triangle &&
                                       id.index() >= shape.first_triangle && id.index() < triangle_),
                "a triangle that changes its shape");
  }
  bool has_all_triangles() const { return triangle_ == s_.deforming_triangles.size(); }

 private:
  void check(const ChildRef& child, uint32_t first_node, uint32_t first_block) const {
    switch (child.kind()) {
      case ChildKind::empty:
        return;
      case ChildKind::inner:
        return require(child.first >= first_node && child.first < node_, "a node of what changes its shape");
      case ChildKind::triangles:  // the sum can't overflow: the range is known to be in the array
        return require(child.first >= first_block && child.first + child.count() <= block_,
                       "a leaf of what changes its shape");
      default:
        require(false, "a leaf of what changes its shape");
    }
  }

  const Scene& s_;
  uint32_t node_ = 0, block_ = 0, triangle_ = 0;  ///< where the next part's begin
};

}  // namespace

void check_deformation(const Scene& s) {
  const size_t vertices = s.deforming_vertices.empty() ? 0 : s.deforming_vertices.size() - 1;
  check_vertices(s, vertices);
  require(s.deforming_parts.size() <= s.parts.size() &&
              s.deforming_triangles.size() <= s.triangle_shading.size() && vertices <= s.normals.size(),
          "what changes its shape");
  for (size_t i = 0; i < s.deforming_triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const uint32_t normal = s.triangle_shading[i].normals[static_cast<size_t>(k)];
      require(s.deforming_triangles[i][k] < vertices && (normal == kNone || normal < vertices),
              "the corners of what changes its shape");
    }
  OwnVolumes volumes(s);
  for (size_t i = 0; i < s.deforming_parts.size(); ++i) volumes.check(s.parts[i], s.deforming_parts[i]);
  require(volumes.has_all_triangles(), "the triangles of what changes its shape");
}

}  // namespace rayfarm
