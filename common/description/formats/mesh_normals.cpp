#include "common/description/formats/mesh_normals.h"

#include <unordered_map>

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

/// How often long loops ask whether to stop.
constexpr size_t kCornersPerLook = 1 << 14;

/// The normals of a mesh: one for each group at each position.
class GroupNormals {
 public:
  explicit GroupNormals(size_t positions) : first_(positions, Entry()) {}

  void add(uint32_t group, std::span<const uint32_t> corners, std::span<const Vec3> points,
           std::span<uint32_t> normals) {
    if (group == 0) {
      std::fill(normals.begin(), normals.end(), ~0u);
      return;
    }
    const size_t n = corners.size();
    const Vec3 normal =
        normalized(n == 3 ? glm::cross(points[1] - points[0], points[2] - points[0]) : newell_normal(points));
    for (size_t i = 0; i < n; ++i) {
      const Vec3 a = normalized(points[(i + 1) % n] - points[i]),
                 b = normalized(points[(i + n - 1) % n] - points[i]);
      normals[i] = place_of(corners[i], group);
      sums_[normals[i]] += portable_acos(glm::dot(a, b)) * normal;
    }
  }

  LargeVector<glm::vec3> result() const {
    LargeVector<glm::vec3> normals;
    normals.reserve(sums_.size());
    for (const Vec3& sum : sums_) normals.emplace_back(normalized(sum));
    return normals;
  }

 private:
  struct Entry {
    uint32_t group = 0, place = 0;
  };

  uint32_t place_of(uint32_t position, uint32_t group) {
    Entry& first = first_[position];
    if (first.group == group) return first.place;
    const auto next = static_cast<uint32_t>(sums_.size());
    uint32_t place = next;
    if (first.group == 0)
      first = {group, next};
    else
      place = others_.try_emplace(uint64_t{group} << 32 | position, next).first->second;
    if (place == next) sums_.emplace_back(0);
    return place;
  }

  LargeVector<Entry> first_;                       ///< by position: the first group that meets there
  std::unordered_map<uint64_t, uint32_t> others_;  ///< by group and position
  LargeVector<Vec3> sums_;
};

}  // namespace

void smooth_normals(MeshShape& mesh, const SmoothingGroups& groups, const std::stop_token& stop) {
  GroupNormals normals(mesh.positions.size());
  const auto group_of = [](const LargeVector<uint32_t>& of_faces, size_t i) {
    return of_faces.empty() ? 1 : of_faces[i];
  };
  std::vector<Vec3> points;
  mesh.triangle_normals.resize(mesh.triangles.size());
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i % kCornersPerLook == 0) throw_if_stopped(stop);
    const glm::uvec3& t = mesh.triangles[i];
    const std::array<uint32_t, 3> corners{t.x, t.y, t.z};
    const std::array<Vec3, 3> corner_points{Vec3(mesh.positions[t.x]), Vec3(mesh.positions[t.y]),
                                            Vec3(mesh.positions[t.z])};
    std::array<uint32_t, 3> places{};
    normals.add(group_of(groups.triangles, i), corners, corner_points, places);
    mesh.triangle_normals[i] = {places[0], places[1], places[2]};
  }
  MeshPolygons& polygons = mesh.polygons;
  polygons.normals.resize(polygons.corners.size());
  for (size_t i = 0, begin = 0; i < polygons.sides.size(); begin += polygons.sides[i++]) {
    if (i % kCornersPerLook == 0) throw_if_stopped(stop);
    const auto corners = std::span<const uint32_t>(polygons.corners).subspan(begin, polygons.sides[i]);
    points.clear();
    for (const uint32_t corner : corners) points.emplace_back(mesh.positions[corner]);
    normals.add(group_of(groups.polygons, i), corners, points,
                std::span(polygons.normals).subspan(begin, polygons.sides[i]));
  }
  mesh.normals = normals.result();
}

}  // namespace rayfarm
