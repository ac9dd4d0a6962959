// Which faces of a mesh are one smooth surface, by the angles at which they meet.
#include <bit>
#include <numeric>

#include "common/description/formats/mesh_normals.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

constexpr size_t kFacesPerLook = 1 << 14;

/// Sets of faces; each is named by one of them.
class FaceSets {
 public:
  explicit FaceSets(size_t faces) : parent_(faces) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t find(uint32_t face) {
    while (parent_[face] != face) face = parent_[face] = parent_[parent_[face]];
    return face;
  }
  /// The smaller name stays, so that names do not depend on the order.
  void join(uint32_t a, uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  LargeVector<uint32_t> parent_;
};

/// The first face at each edge.
class EdgeFaces {
 public:
  explicit EdgeFaces(size_t edges) : edges_(std::bit_ceil(2 * edges + 2), kNoEdge), faces_(edges_.size()) {}

  /// The face that was there before, or nothing.
  std::optional<uint32_t> add(uint32_t a, uint32_t b, uint32_t face) {
    const uint64_t edge = uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    const size_t mask = edges_.size() - 1;
    uint64_t hash = edge * 0x9e3779b97f4a7c15;
    hash ^= hash >> 32;
    size_t slot = hash & mask;
    while (edges_[slot] != kNoEdge) {
      if (edges_[slot] == edge) return faces_[slot];
      slot = (slot + 1) & mask;
    }
    edges_[slot] = edge;
    faces_[slot] = face;
    return std::nullopt;
  }

 private:
  static constexpr uint64_t kNoEdge = ~uint64_t{0};
  LargeVector<uint64_t> edges_;  ///< an open hash table, half full at most
  LargeVector<uint32_t> faces_;
};

}  // namespace

SmoothingGroups groups_by_crease(const MeshShape& mesh, double degrees, const std::stop_token& stop) {
  const size_t triangles = mesh.triangles.size(), count = triangles + mesh.polygons.sides.size();
  constexpr double kRadians = 3.14159265358979323846 / 180;
  const auto least_cosine = static_cast<float>(portable_cos(degrees * kRadians));
  FaceSets sets(count);
  EdgeFaces edges(3 * triangles + mesh.polygons.corners.size());
  LargeVector<glm::vec3> normals(count);
  std::vector<Vec3> points;
  size_t begin = 0;
  for (size_t i = 0; i < count; ++i) {
    if (i % kFacesPerLook == 0) throw_if_stopped(stop);
    std::span<const uint32_t> corners;
    if (i < triangles) {
      corners = std::span(&mesh.triangles[i].x, 3);
    } else {
      corners = std::span(mesh.polygons.corners).subspan(begin, mesh.polygons.sides[i - triangles]);
      begin += corners.size();
    }
    points.clear();
    for (const uint32_t corner : corners) points.emplace_back(mesh.positions[corner]);
    normals[i] = glm::vec3(normalized(newell_normal(points)));
    const auto face = static_cast<uint32_t>(i);
    for (size_t k = 0; k < corners.size(); ++k) {
      const std::optional<uint32_t> other = edges.add(corners[k], corners[(k + 1) % corners.size()], face);
      if (other && glm::dot(normals[i], normals[*other]) >= least_cosine) sets.join(face, *other);
    }
  }
  SmoothingGroups groups;
  groups.triangles.resize(triangles);
  groups.polygons.resize(count - triangles);
  for (size_t i = 0; i < count; ++i)
    (i < triangles ? groups.triangles[i] : groups.polygons[i - triangles]) =
        sets.find(static_cast<uint32_t>(i)) + 1;  // 0 is flat
  return groups;
}

void add_asked_normals(MeshShape& mesh, const MeshRequest& request, const std::stop_token& stop) {
  const bool is_flat =
      request.is_smoothing_asked_for ? request.smoothing == Smoothing::flat : request.crease == 0;
  if (is_flat) return;
  mesh.smoothing = request.is_smoothing_asked_for ? request.smoothing : Smoothing::phong;
  smooth_normals(mesh, request.crease > 0 ? groups_by_crease(mesh, request.crease, stop) : SmoothingGroups(),
                 stop);
}

}  // namespace rayfarm
