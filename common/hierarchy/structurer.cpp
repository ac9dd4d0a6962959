#include "common/hierarchy/structurer.h"

#include <algorithm>

namespace rayfarm {
namespace {

constexpr uint32_t kLanes = 8;

uint32_t block_count(size_t primitives) {
  return static_cast<uint32_t>((primitives + kLanes - 1) / kLanes);
}

ChildRef pack_triangles(std::span<const uint32_t> primitives, const PartPrimitives& part,
                        LeafArrays& arrays) {
  const auto first = static_cast<uint32_t>(arrays.triangle_blocks.size());
  for (size_t begin = 0; begin < primitives.size(); begin += kLanes) {
    TriangleBlock block;
    for (auto& vertex : block.vertices)
      for (auto& axis : vertex) axis.fill(std::numeric_limits<float>::quiet_NaN());
    block.primitives.fill(kNoPrimitive);
    for (size_t lane = 0; lane < kLanes && begin + lane < primitives.size(); ++lane) {
      const uint32_t primitive = primitives[begin + lane];
      const TriangleVertices vertices = part.triangle(primitive);
      for (size_t v = 0; v < 3; ++v)
        for (size_t axis = 0; axis < 3; ++axis)
          block.vertices[v][axis][lane] = vertices[v][static_cast<int>(axis)];
      block.primitives[lane] = part.ids[primitive];
    }
    arrays.triangle_blocks.push_back(block);
  }
  return make_child(ChildKind::triangles, first, block_count(primitives.size()));
}

ChildRef pack_spheres(std::span<const uint32_t> primitives, const PartPrimitives& part,
                      std::span<const SphereRecord> spheres, LeafArrays& arrays) {
  const auto first = static_cast<uint32_t>(arrays.sphere_blocks.size());
  for (size_t begin = 0; begin < primitives.size(); begin += kLanes) {
    SphereBlock block{};
    for (auto& axis : block.center) axis.fill(std::numeric_limits<double>::quiet_NaN());
    block.radius.fill(std::numeric_limits<double>::quiet_NaN());
    block.spheres.fill(kNone);
    for (size_t lane = 0; lane < kLanes && begin + lane < primitives.size(); ++lane) {
      const uint32_t index = part.ids[primitives[begin + lane]].index();
      for (size_t axis = 0; axis < 3; ++axis)
        block.center[axis][lane] = spheres[index].center[static_cast<int>(axis)];
      block.radius[lane] = spheres[index].radius;
      block.spheres[lane] = index;
    }
    arrays.sphere_blocks.push_back(block);
  }
  return make_child(ChildKind::spheres, first, block_count(primitives.size()));
}

}  // namespace

TriangleVertices PartPrimitives::triangle(uint32_t primitive) const {
  const uint32_t place = triangle_of_[primitive];
  if (!(place & kOfMesh)) return triangles_[place];
  const uint32_t i = place & ~kOfMesh;
  const auto mesh = std::upper_bound(meshes_.begin(), meshes_.end(), i,
                                     [](uint32_t n, const Mesh& m) { return n < m.first; }) -
                    1;
  const glm::uvec3& t = mesh->triangles[i - mesh->first];
  return {mesh->positions[t.x], mesh->positions[t.y], mesh->positions[t.z]};
}

ChildRef pack_leaf(std::span<const PrimitiveReference> references, const PartPrimitives& part,
                   std::span<const SphereRecord> spheres, LeafArrays& arrays) {
  std::array<std::vector<uint32_t>, 3> groups;  // what is tested as triangles, spheres, all others
  std::array<Box, 3> boxes;
  for (const PrimitiveReference& r : references) {
    const size_t group = part.is_triangle(r.primitive)                           ? 0
                         : part.ids[r.primitive].kind() == PrimitiveKind::sphere ? 1
                                                                                 : 2;
    groups[group].push_back(r.primitive);
    boxes[group].grow(r.box());
  }
  const auto pack = [&](size_t group) {
    if (group == 0) return pack_triangles(groups[0], part, arrays);
    if (group == 1) return pack_spheres(groups[1], part, spheres, arrays);
    const auto first = static_cast<uint32_t>(arrays.leaf_primitives.size());
    for (const uint32_t primitive : groups[2]) arrays.leaf_primitives.push_back(part.ids[primitive]);
    return make_child(ChildKind::mixed, first, static_cast<uint32_t>(groups[2].size()));
  };
  size_t kinds = 0, only = 0;
  for (size_t group = 0; group < 3; ++group)
    if (!groups[group].empty()) {
      ++kinds;
      only = group;
    }
  if (kinds == 1) return pack(only);
  const auto index = static_cast<uint32_t>(arrays.nodes.size());
  arrays.nodes.push_back(make_empty_node());
  size_t slot = 0;
  for (size_t group = 0; group < 3; ++group)
    if (!groups[group].empty()) {
      const ChildRef child = pack(group);
      set_child(arrays.nodes[index], slot++, boxes[group], child);
    }
  return make_child(ChildKind::inner, index);
}

}  // namespace rayfarm
