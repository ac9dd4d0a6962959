#include "common/description/formats/mesh_faces.h"

namespace rayfarm {

void reserve_faces(std::span<const uint32_t> sides, bool has_uvs, MeshShape& mesh) {
  size_t triangles = 0, polygons = 0, corners = 0;
  for (const uint32_t n : sides) {
    triangles += n == 3;
    polygons += n > 3;
    corners += n > 3 ? n : 0;
  }
  mesh.triangles.reserve(triangles);
  mesh.materials.reserve(triangles);
  mesh.polygons.sides.reserve(polygons);
  mesh.polygons.materials.reserve(polygons);
  mesh.polygons.corners.reserve(corners);
  if (mesh.smoothing != Smoothing::flat) {
    mesh.triangle_normals.reserve(triangles);
    mesh.polygons.normals.reserve(corners);
  }
  if (has_uvs) {
    mesh.triangle_uvs.reserve(triangles);
    mesh.polygons.uvs.reserve(corners);
  }
}

void add_face(MeshShape& mesh, std::span<const FaceCorner> corners, std::optional<uint32_t> material) {
  const bool is_smooth = mesh.smoothing != Smoothing::flat;
  const bool has_normals = std::all_of(corners.begin(), corners.end(),
                                       [](const FaceCorner& corner) { return corner.normal != ~0u; });
  if (corners.size() == 3) {
    const auto [a, b, c] = std::array{corners[0], corners[1], corners[2]};
    mesh.triangles.emplace_back(a.point, b.point, c.point);
    if (is_smooth)
      mesh.triangle_normals.push_back(has_normals ? glm::uvec3(a.normal, b.normal, c.normal)
                                                  : glm::uvec3(~0u));
    if (!mesh.uvs.empty()) mesh.triangle_uvs.emplace_back(a.uv, b.uv, c.uv);
    if (material) mesh.materials.push_back(*material);
    return;
  }
  MeshPolygons& polygons = mesh.polygons;
  polygons.sides.push_back(static_cast<uint32_t>(corners.size()));
  if (material) polygons.materials.push_back(*material);
  for (const FaceCorner& corner : corners) {
    polygons.corners.push_back(corner.point);
    if (is_smooth) polygons.normals.push_back(has_normals ? corner.normal : ~0u);
    if (!mesh.uvs.empty()) polygons.uvs.push_back(corner.uv);
  }
}

void average_normals(MeshShape& mesh, const std::stop_token& stop) {
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (const glm::uvec3& t : mesh.triangles) {
    throw_if_stopped(stop);
    const Vec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    const Vec3 normal = normalized(glm::cross(b - a, c - a));
    for (int k = 0; k < 3; ++k) sums[t[k]] += normal;
  }
  const MeshPolygons& polygons = mesh.polygons;
  std::vector<Vec3> points;
  size_t begin = 0;
  for (const uint32_t sides : polygons.sides) {
    throw_if_stopped(stop);
    const auto corners = std::span(polygons.corners).subspan(begin, sides);
    points.clear();
    for (const uint32_t corner : corners) points.emplace_back(mesh.positions[corner]);
    const Vec3 normal = normalized(newell_normal(points));
    for (const uint32_t corner : corners) sums[corner] += normal;
    begin += sides;
  }
  mesh.normals.clear();
  for (const Vec3& s : sums) mesh.normals.emplace_back(normalized(s));
  mesh.triangle_normals = mesh.triangles;
  mesh.polygons.normals = mesh.polygons.corners;
}

}  // namespace rayfarm
