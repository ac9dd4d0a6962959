#include "common/hierarchy/deformed_parts.h"

#include <stdexcept>

#include "common/hierarchy/structurer.h"
#include "common/scene/animation.h"
#include "common/scene/array_offsets.h"

namespace rayfarm {
namespace {

/// A tree whose cost has grown by so much is built anew. Building takes about ten times as long as refitting,
/// and a ray of a frame pays for every box that is too large.
constexpr double kMostGrowth = 1.5;

/// The first of an array's elements, which stand for the vertices: one less than records, as one is behind
/// the last.
size_t vertex_count(const Scene& scene) {
  return scene.deforming_vertices.empty() ? 0 : scene.deforming_vertices.size() - 1;
}
size_t node_count(const Scene& scene) {
  return scene.deforming_parts.empty()
             ? 0
             : size_t{scene.deforming_parts.back().first_node} + scene.deforming_parts.back().node_count;
}
size_t block_count(const Scene& scene) {
  if (scene.deforming_parts.empty()) return 0;
  const Part& last = scene.parts[scene.deforming_parts.size() - 1];
  return size_t{last.first_triangle_block} + last.triangle_block_count;
}

/// What joints do to the vertices that hang on them alone.
std::vector<Affine> joint_transforms(const Scene& scene, double frame) {
  const std::vector<Affine> bones = scene.transforms_to_root(scene.bones, frame);
  std::vector<Affine> transforms;
  transforms.reserve(scene.joints.size());
  for (const Joint& joint : scene.joints) transforms.push_back(bones[joint.bone] * joint.bone_from_mesh);
  return transforms;
}

/// Their mean by weight, or as it is without any.
Affine blend(std::span<const JointWeight> influences, std::span<const Affine> transforms) {
  Affine sum{Mat3(0), Vec3(0)};
  double weights = 0;
  for (const JointWeight& i : influences) {
    const double weight = i.weight;
    const Affine& joint = transforms[i.joint];
    sum.linear += weight * joint.linear;
    sum.translation += weight * joint.translation;
    weights += weight;
  }
  if (!(weights > 0)) return {};
  return {sum.linear / weights, sum.translation / weights};
}

/// The inverse transpose of the matrix times its determinant: planes' normals go with it even where the
/// matrix is singular.
Vec3 turn_normal(const Mat3& m, const Vec3& n) {
  return n.x * glm::cross(m[1], m[2]) + n.y * glm::cross(m[2], m[0]) + n.z * glm::cross(m[0], m[1]);
}

class TriangleSource : public PrimitiveSource {
 public:
  TriangleSource(std::span<const glm::uvec3> triangles, std::span<const glm::vec3> positions)
      : triangles_(triangles), positions_(positions) {}
  size_t size() const override { return triangles_.size(); }
  Box bounds(uint32_t i) const override {
    Box box;
    for (int k = 0; k < 3; ++k) box.grow(Vec3(positions_[triangles_[i][k]]));
    return box;
  }
  Box clipped(uint32_t i, const Box& cell) const override { return intersection(bounds(i), cell); }

 private:
  std::span<const glm::uvec3> triangles_;
  std::span<const glm::vec3> positions_;
};

/// Nodes and blocks that a random ray meets which meets the bounds: the surface area heuristic.
double cost_of(std::span<const VolumeNode> nodes) {
  double sum = 0;
  for (const VolumeNode& node : nodes)
    for (size_t slot = 0; slot < 8; ++slot) {
      const ChildRef& child = node.children[slot];
      if (child.kind() == ChildKind::empty) continue;
      sum += child_box(node, slot).area() * (child.kind() == ChildKind::inner ? 1 : child.count());
    }
  const double whole = nodes.empty() ? 0 : bounds_of(nodes[0]).area();
  return whole > 0 ? sum / whole : 0;
}

Box bounds_of_block(const TriangleBlock& block, Box box) {
  for (size_t lane = 0; lane < 8; ++lane)
    if (block.primitives[lane] != kNoPrimitive)
      for (const auto& vertex : block.vertices)
        box.grow(Vec3(vertex[0][lane], vertex[1][lane], vertex[2][lane]));
  return box;
}

void set_union(VolumeNode& node, size_t slot, const VolumeNode& child) {
  for (size_t axis = 0; axis < 3; ++axis) {  // unused slots are inverted boxes, which change nothing
    const auto &low = child.planes[0][axis], &high = child.planes[1][axis];
    node.planes[0][axis][slot] = *std::min_element(low.begin(), low.end());
    node.planes[1][axis][slot] = *std::max_element(high.begin(), high.end());
  }
}

}  // namespace

void deform(const Scene& scene, double frame, DeformedVertices& vertices) {
  const std::vector<Affine> joints = joint_transforms(scene, frame);
  std::vector<double> weights;
  for (const uint32_t curve : scene.morph_weights) weights.push_back(scene.eval(curve, frame).x);
  const auto count = static_cast<uint32_t>(vertex_count(scene));
  vertices.positions.resize(count);
  vertices.normals.resize(count);
  for (uint32_t i = 0; i < count; ++i) {
    Vec3 p(scene.deforming_vertices[i].position), n(scene.deforming_vertices[i].normal);
    for (const MorphDelta& delta : scene.deltas_of(i)) {
      p += weights[delta.target] * Vec3(delta.position);
      n += weights[delta.target] * Vec3(delta.normal);
    }
    if (const auto influences = scene.joints_of(i); !influences.empty()) {
      const Affine skin = blend(influences, joints);
      p = skin.point(p);
      n = turn_normal(skin.linear, n);
    }
    vertices.positions[i] = glm::vec3(p);
    vertices.normals[i] = glm::vec3(normalized(n));
    if (!is_finite(Vec3(vertices.positions[i])) || !is_finite(Vec3(vertices.normals[i])))
      throw std::domain_error("a vertex of a mesh that changes its shape is too far away, or nowhere");
  }
}

Part build_deformed_part(const Scene& scene, const DeformedVertices& vertices, const BuildOptions& options,
                         DeformingPart& shape, DeformedArrays arrays) {
  const auto triangles = scene.deforming_triangles.subspan(shape.first_triangle, shape.triangle_count);
  Part part;
  part.triangle_count = shape.triangle_count;
  part.first_triangle_block = static_cast<uint32_t>(arrays.triangle_blocks.size());
  shape.first_node = static_cast<uint32_t>(arrays.nodes.size());
  PartPrimitives primitives;
  primitives.begin_mesh(vertices.positions, triangles);
  for (uint32_t i = 0; i < shape.triangle_count; ++i)
    primitives.add_mesh_triangle(make_primitive_id(PrimitiveKind::triangle, shape.first_triangle + i), i);
  LargeVector<SphereBlock> no_spheres;
  LargeVector<PrimitiveId> no_others;
  LeafArrays leaves{arrays.nodes, arrays.triangle_blocks, no_spheres, no_others};
  const LeafMaker make_leaf = [&](std::span<const PrimitiveReference> references) {
    throw_if_stopped(options.stop);
    return pack_leaf(references, primitives, {}, leaves);
  };
  const TriangleSource source(triangles, vertices.positions);
  for (uint32_t i = 0; i < shape.triangle_count; ++i) part.collection.bounds.grow(source.bounds(i));
  part.collection.root = build_hierarchy(
      source, {.quality = BuildQuality::fast, .progress = options.progress, .stop = options.stop}, make_leaf,
      arrays.nodes);
  part.triangle_block_count =
      static_cast<uint32_t>(arrays.triangle_blocks.size()) - part.first_triangle_block;
  part.collection.first_triangle_block = part.first_triangle_block;
  part.collection.triangle_block_count = part.triangle_block_count;
  shape.node_count = static_cast<uint32_t>(arrays.nodes.size()) - shape.first_node;
  shape.cost = cost_of(std::span(arrays.nodes).subspan(shape.first_node));
  return part;
}

DeformedParts::DeformedParts(const Scene& scene)
    : scene_(scene),
      shapes_(scene),
      parts_(scene.parts.begin(), scene.parts.begin() + static_cast<ptrdiff_t>(scene.deforming_parts.size())),
      nodes_(scene.nodes.begin(), scene.nodes.begin() + static_cast<ptrdiff_t>(node_count(scene))),
      triangle_blocks_(scene.triangle_blocks.begin(),
                       scene.triangle_blocks.begin() + static_cast<ptrdiff_t>(block_count(scene))),
      trees_(scene.deforming_parts.begin(), scene.deforming_parts.end()) {}

void DeformedParts::set(double frame) {
  deform(scene_, frame, vertices_);
  place_triangles();
  refit();
  std::vector<char> is_bad(trees_.size());
  for (size_t i = 0; i < trees_.size(); ++i) {
    const auto nodes = std::span(nodes_).subspan(trees_[i].first_node, trees_[i].node_count);
    is_bad[i] = cost_of(nodes) > kMostGrowth * trees_[i].cost;
  }
  if (std::find(is_bad.begin(), is_bad.end(), 1) != is_bad.end()) rebuild(is_bad);
  vertices_.positions = {};
  shapes_.parts = parts_;
  shapes_.nodes = nodes_;
  shapes_.triangle_blocks = triangle_blocks_;
  shapes_.normals = vertices_.normals;
}

void DeformedParts::place_triangles() {
  for (TriangleBlock& block : triangle_blocks_)
    for (size_t lane = 0; lane < 8; ++lane) {
      if (block.primitives[lane] == kNoPrimitive) continue;
      const glm::uvec3& corners = scene_.deforming_triangles[block.primitives[lane].index()];
      for (size_t v = 0; v < 3; ++v)
        for (size_t axis = 0; axis < 3; ++axis)
          block.vertices[v][axis][lane] =
              vertices_.positions[corners[static_cast<int>(v)]][static_cast<int>(axis)];
    }
}

void DeformedParts::refit() {
  for (size_t n = nodes_.size(); n-- > 0;) {  // children stand after their parents
    VolumeNode& node = nodes_[n];
    for (size_t slot = 0; slot < 8; ++slot) {
      const ChildRef child = node.children[slot];
      if (child.kind() == ChildKind::inner) {
        set_union(node, slot, nodes_[child.first]);
      } else if (child.kind() == ChildKind::triangles) {
        Box box;
        for (uint32_t i = 0; i < child.count(); ++i)
          box = bounds_of_block(triangle_blocks_[child.first + i], box);
        set_child(node, slot, box, child);
      }
    }
  }
  for (Part& part : parts_) {
    const ChildRef& root = part.collection.root;
    Box& box = part.collection.bounds = {};
    if (root.kind() == ChildKind::inner) {
      box = bounds_of(nodes_[root.first]);
      continue;
    }
    for (uint32_t i = 0; i < root.count(); ++i) box = bounds_of_block(triangle_blocks_[root.first + i], box);
  }
}

/// The others move together: the arrays have no gaps.
void DeformedParts::rebuild(const std::vector<char>& is_bad) {
  ++builds_;
  const LargeVector<VolumeNode> old_nodes = std::exchange(nodes_, {});
  const LargeVector<TriangleBlock> old_blocks = std::exchange(triangle_blocks_, {});
  for (size_t i = 0; i < parts_.size(); ++i) {
    Part& part = parts_[i];
    DeformingPart& tree = trees_[i];
    if (is_bad[i]) {
      part = build_deformed_part(scene_, vertices_, {}, tree, {nodes_, triangle_blocks_});
      continue;
    }
    ArrayOffsets moved{};
    moved.nodes = static_cast<uint32_t>(nodes_.size()) - tree.first_node;
    moved.triangle_blocks = static_cast<uint32_t>(triangle_blocks_.size()) - part.first_triangle_block;
    const auto nodes = std::span(old_nodes).subspan(tree.first_node, tree.node_count);
    for (VolumeNode node : nodes) {
      shift(node, moved);
      nodes_.push_back(node);
    }
    const auto blocks = std::span(old_blocks).subspan(part.first_triangle_block, part.triangle_block_count);
    triangle_blocks_.insert(triangle_blocks_.end(), blocks.begin(), blocks.end());
    tree.first_node += moved.nodes;
    shift(part, moved);
  }
}

size_t deformed_bytes(const Scene& scene) {
  return scene.deforming_parts.size() * sizeof(Part) + node_count(scene) * sizeof(VolumeNode) +
         block_count(scene) * sizeof(TriangleBlock) + vertex_count(scene) * sizeof(glm::vec3);
}

}  // namespace rayfarm
