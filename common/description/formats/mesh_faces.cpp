#include "common/description/formats/mesh_faces.h"

namespace rayfarm {

void resize_faces(MeshShape& mesh, const FacePlace& end) {
  mesh.triangles.resize(end.triangle);
  mesh.polygons.sides.resize(end.polygon);
  mesh.polygons.corners.resize(end.polygon_corner);
  if (mesh.smoothing != Smoothing::flat) {
    mesh.triangle_normals.resize(end.triangle);
    mesh.polygons.normals.resize(end.polygon_corner);
  }
  if (!mesh.uvs.empty()) {
    mesh.triangle_uvs.resize(end.triangle);
    mesh.polygons.uvs.resize(end.polygon_corner);
  }
}

void set_face(MeshShape& mesh, FacePlace& place, std::span<const FaceCorner> corners) {
  const bool is_smooth = mesh.smoothing != Smoothing::flat;
  const bool has_normals = std::all_of(corners.begin(), corners.end(),
                                       [](const FaceCorner& corner) { return corner.normal != ~0u; });
  if (corners.size() == 3) {
    const size_t i = place.triangle++;
    const FaceCorner &a = corners[0], &b = corners[1], &c = corners[2];
    mesh.triangles[i] = {a.point, b.point, c.point};
    if (is_smooth)
      mesh.triangle_normals[i] = has_normals ? glm::uvec3(a.normal, b.normal, c.normal) : glm::uvec3(~0u);
    if (!mesh.uvs.empty()) mesh.triangle_uvs[i] = {a.uv, b.uv, c.uv};
    return;
  }
  MeshPolygons& polygons = mesh.polygons;
  polygons.sides[place.polygon++] = static_cast<uint32_t>(corners.size());
  for (const FaceCorner& corner : corners) {
    const size_t i = place.polygon_corner++;
    polygons.corners[i] = corner.point;
    if (is_smooth) polygons.normals[i] = has_normals ? corner.normal : ~0u;
    if (!mesh.uvs.empty()) polygons.uvs[i] = corner.uv;
  }
}

void add_face(MeshShape& mesh, std::span<const FaceCorner> corners) {
  FacePlace place{mesh.triangles.size(), mesh.polygons.sides.size(), mesh.polygons.corners.size()};
  const bool is_triangle = corners.size() == 3;
  resize_faces(mesh, {place.triangle + is_triangle, place.polygon + !is_triangle,
                      place.polygon_corner + (is_triangle ? 0 : corners.size())});
  set_face(mesh, place, corners);
}

void check_faces(const MeshShape& mesh, const std::string& path) {
  const size_t count = mesh.triangles.size() + mesh.polygons.sides.size();
  if (count == 0)
    throw InputError({path},
                     fmt::format("the file has no faces{}",
                                 mesh.positions.empty()
                                     ? ""
                                     : ", points alone; Rayfarm renders surfaces: make one of the points "
                                       "first, as MeshLab and CloudCompare do"));
  if (count > limits::kPrimitives) throw InputError({path}, "the mesh has too many faces");
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
