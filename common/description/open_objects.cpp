#include "common/description/open_objects.h"

#include <algorithm>
#include <numeric>

namespace rayfarm {
namespace {

/// The edges of polygons that may enclose something, by the places of their ends.
class Edges {
 public:
  void add_point(const Vec3& p) { points_.push_back(p); }
  /// The points added since the last polygon are the next one's corners.
  void end_polygon() { ends_.push_back(points_.size()); }

  /// Each edge is passed as often in one direction as in the other.
  bool are_closed() const {
    const std::vector<uint32_t> ids = number_places();
    std::vector<std::array<uint32_t, 2>> there, back;
    for (size_t begin = 0, k = 0; k < ends_.size(); begin = ends_[k++])
      for (size_t i = begin; i < ends_[k]; ++i) {
        const uint32_t a = ids[i], b = ids[i + 1 < ends_[k] ? i + 1 : begin];
        if (a < b)
          there.push_back({a, b});
        else if (b < a)
          back.push_back({b, a});
      }
    std::sort(there.begin(), there.end());
    std::sort(back.begin(), back.end());
    return there == back;
  }

 private:
  /// Of each point, the same for those at the same place.
  std::vector<uint32_t> number_places() const {
    std::vector<uint32_t> order(points_.size()), ids(points_.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t i) { return std::array{points_[i].x, points_[i].y, points_[i].z}; };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (size_t i = 0, id = 0; i < order.size(); ++i) {
      if (i > 0 && key(order[i]) != key(order[i - 1])) ++id;
      ids[order[i]] = static_cast<uint32_t>(id);
    }
    return ids;
  }

  std::vector<Vec3> points_;
  std::vector<size_t> ends_;
};

bool is_closed(const MeshShape& mesh) {
  Edges edges;
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int k = 0; k < 3; ++k) edges.add_point(Vec3(mesh.positions[triangle[k]]));
    edges.end_polygon();
  }
  size_t corner = 0;
  for (const uint32_t sides : mesh.polygons.sides) {
    for (uint32_t k = 0; k < sides; ++k)
      edges.add_point(Vec3(mesh.positions[mesh.polygons.corners[corner++]]));
    edges.end_polygon();
  }
  return edges.are_closed();
}

bool is_open(const SceneDescription& scene, const ObjectDescription& object) {
  Edges polygons;
  for (const PrimitiveDescription& primitive : object.primitives) {
    const Material& material = scene.materials[primitive.material];
    if (material.kind == MaterialKind::translucent || material.kind == MaterialKind::mix ||
        material.is_pierced)
      continue;
    if (const auto* polygon = std::get_if<PolygonShape>(&primitive.shape)) {
      for (const Vec3& p : polygon->points) polygons.add_point(p);
      polygons.end_polygon();
    } else if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape)) {
      if (!is_closed(*mesh)) return true;
    } else if (const auto* quadric = std::get_if<QuadricShape>(&primitive.shape)) {
      if (!quadric->planes.empty()) return true;
    } else if (std::holds_alternative<ConeShape>(primitive.shape) ||
               std::holds_alternative<PatchShape>(primitive.shape)) {
      return true;
    }
  }
  return !polygons.are_closed();
}

}  // namespace

std::vector<uint32_t> find_open_objects(const SceneDescription& scene) {
  std::vector<uint32_t> found;
  for (uint32_t i = 0; i < scene.objects.size(); ++i)
    if (is_open(scene, scene.objects[i])) found.push_back(i);
  return found;
}

}  // namespace rayfarm
