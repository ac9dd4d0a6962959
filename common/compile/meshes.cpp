// Meshes: triangles and faces of more corners, over vertices that they share (thesis 2.3.3: the unique nodes
// in a linear list, a polygon a list of nodes).
#include "common/compile/corners.h"
#include "common/compile/shapes.h"
#include "common/shapes/triangulate.h"

namespace rayfarm {
namespace {

/// How often long loops ask whether to stop.
constexpr size_t kFacesPerLook = 1 << 14;

/// A face is planar if it is tilted by half a degree at most against each of the triangles that it is cut
/// into. A file's six digits tilt faces by less, down to a ten-thousandth of its coordinates in size; the
/// quadrilaterals of modellers, where surfaces are curved in two ways, are twisted by more.
constexpr double kCosineOfPlanar = 0.99996;

bool is_planar(const Vec3& normal, std::span<const TriangleVertices> triangles) {
  return std::all_of(triangles.begin(), triangles.end(), [&](const TriangleVertices& t) {
    const Vec3 a(t[0]), b(t[1]), c(t[2]);
    return glm::dot(normalized(glm::cross(b - a, c - a)), normal) >= kCosineOfPlanar;
  });
}

/// True if none of a triangle's normals is zero: files have such, and faces are flat there.
bool have_directions(const MeshShape& mesh, const glm::uvec3& normals) {
  return mesh.normals[normals.x] != glm::vec3(0) && mesh.normals[normals.y] != glm::vec3(0) &&
         mesh.normals[normals.z] != glm::vec3(0);
}

/// The vertices that the faces of one mesh use, as they enter the scene.
class SharedPoints {
 public:
  SharedPoints(std::span<const glm::vec3> positions, LargeVector<glm::vec3>& points)
      : positions_(positions), points_(points), place_of_(positions.size(), kNone) {}
  uint32_t place_of(uint32_t position) {
    uint32_t& place = place_of_[position];
    if (place == kNone) {
      place = static_cast<uint32_t>(points_.size());
      points_.push_back(positions_[position]);
    }
    return place;
  }

 private:
  std::span<const glm::vec3> positions_;
  LargeVector<glm::vec3>& points_;
  std::vector<uint32_t> place_of_;
};

}  // namespace

void ShapeCompiler::add(PartPrimitives& part, const PrimitiveDescription& p, const MeshShape& mesh) {
  const auto first_normal = static_cast<uint32_t>(arrays_.normals.size());
  make_room(arrays_.normals, mesh.normals.size());
  make_room(arrays_.triangle_shading, mesh.triangles.size());
  if (!mesh.triangles.empty()) part.begin_mesh(mesh.positions, mesh.triangles);
  bool has_all = true;
  for (const glm::vec3& n : mesh.normals) {
    arrays_.normals.emplace_back(normalized(Vec3(n)));
    has_all = has_all && n != glm::vec3(0);
  }
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i % kFacesPerLook == 0) throw_if_stopped(stop_);
    const glm::uvec3& t = mesh.triangles[i];
    TriangleShading shading{mesh.materials.empty() ? p.material : mesh.materials[i],
                            static_cast<uint32_t>(Smoothing::flat),
                            {kNone, kNone, kNone}};
    if (mesh.smoothing != Smoothing::flat && !mesh.triangle_normals.empty() &&
        mesh.triangle_normals[i].x != kNone && (has_all || have_directions(mesh, mesh.triangle_normals[i]))) {
      shading.smoothing = static_cast<uint32_t>(mesh.smoothing);
      for (size_t k = 0; k < 3; ++k)
        shading.normals[k] = first_normal + mesh.triangle_normals[i][static_cast<int>(k)];
    }
    const size_t before = arrays_.triangle_shading.size();
    const auto id =
        add_triangle({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, shading, p.place);
    if (!id) continue;
    part.add_mesh_triangle(*id, i);
    const auto position = [&t](size_t k) { return t[static_cast<int>(k)]; };
    if (!mesh.triangle_uvs.empty())
      add_corners(arrays_.triangle_uvs, 3 * before, kNoUv, mesh.uvs, 3,
                  [&](size_t k) { return mesh.triangle_uvs[i][static_cast<int>(k)]; });
    add_corners(arrays_.second_uvs, 3 * before, kNoUv, mesh.second_uvs, 3, position);
    add_corners(arrays_.triangle_colors, 3 * before, kWhiteVertex, mesh.colors, 3, position);
    if (!mesh.colors.empty()) arrays_.materials[shading.material].is_colored = 1;
  }
  if (!mesh.polygons.sides.empty()) add_polygons(part, p, mesh, first_normal, has_all);
}

void ShapeCompiler::add_polygons(PartPrimitives& part, const PrimitiveDescription& p, const MeshShape& mesh,
                                 uint32_t first_normal, bool has_all_normals) {
  const MeshPolygons& polygons = mesh.polygons;
  SharedPoints shared(mesh.positions, arrays_.mesh_points);
  std::vector<Vec3> points;
  std::vector<std::array<uint32_t, 3>> cut;  // corners of the face
  std::vector<TriangleVertices> triangles;
  size_t begin = 0;  // of the face's corners
  for (size_t i = 0; i < polygons.sides.size(); begin += polygons.sides[i++]) {
    if (i % kFacesPerLook == 0) throw_if_stopped(stop_);
    const size_t sides = polygons.sides[i];
    const auto corners = std::span(polygons.corners).subspan(begin, sides);
    points.clear();
    for (const uint32_t corner : corners) points.emplace_back(mesh.positions[corner]);
    cut_face(points, cut);
    std::erase_if(cut, [&](const std::array<uint32_t, 3>& t) {
      return max_magnitude(glm::cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]])) == 0;
    });
    triangles.clear();
    for (const auto& [a, b, c] : cut)
      triangles.push_back(
          {mesh.positions[corners[a]], mesh.positions[corners[b]], mesh.positions[corners[c]]});
    const Vec3 normal = normalized(newell_normal(points));
    if (triangles.empty() || max_magnitude(normal) == 0) {
      count(dropped_, p.place);
      continue;
    }
    const uint32_t material = polygons.materials.empty() ? p.material : polygons.materials[i];
    if (!mesh.colors.empty()) arrays_.materials[material].is_colored = 1;
    const auto normal_of = [&](size_t corner) { return first_normal + polygons.normals[begin + corner]; };
    const bool is_smooth =
        mesh.smoothing != Smoothing::flat && !polygons.normals.empty() && polygons.normals[begin] != kNone &&
        (has_all_normals || std::all_of(&polygons.normals[begin], &polygons.normals[begin] + sides,
                                        [&](uint32_t n) { return mesh.normals[n] != glm::vec3(0); }));
    const auto smoothing = static_cast<uint32_t>(is_smooth ? mesh.smoothing : Smoothing::flat);
    if (!is_planar(normal, triangles)) {
      count(folded_, p.place);
      for (size_t k = 0; k < triangles.size(); ++k) {
        TriangleShading shading{material, smoothing, {kNone, kNone, kNone}};
        for (size_t v = 0; is_smooth && v < 3; ++v) shading.normals[v] = normal_of(cut[k][v]);
        const size_t before = arrays_.triangle_shading.size();
        if (const auto id = add_triangle(triangles[k], shading, p.place))
          part.add_triangle(*id, triangles[k]);
        if (!polygons.uvs.empty())
          add_corners(arrays_.triangle_uvs, 3 * before, kNoUv, mesh.uvs, 3,
                      [&](size_t v) { return polygons.uvs[begin + cut[k][v]]; });
        add_corners(arrays_.triangle_colors, 3 * before, kWhiteVertex, mesh.colors, 3,
                    [&](size_t v) { return corners[cut[k][v]]; });
      }
      continue;
    }
    const PrimitiveId id =
        make_primitive_id(PrimitiveKind::face, static_cast<uint32_t>(arrays_.mesh_faces.size()));
    MeshFace face{static_cast<uint32_t>(arrays_.face_corners.size()), static_cast<uint32_t>(sides), kNone,
                  smoothing, material};
    if (!polygons.uvs.empty())
      add_corners(arrays_.face_uvs, face.first_corner, kNoUv, mesh.uvs, sides,
                  [&](size_t k) { return polygons.uvs[begin + k]; });
    add_corners(arrays_.face_colors, face.first_corner, kWhiteVertex, mesh.colors, sides,
                [&](size_t k) { return corners[k]; });
    for (const uint32_t corner : corners) arrays_.face_corners.push_back(shared.place_of(corner));
    if (is_smooth) {
      face.first_normal = static_cast<uint32_t>(arrays_.face_normals.size());
      for (size_t k = 0; k < sides; ++k) arrays_.face_normals.push_back(normal_of(k));
    }
    arrays_.mesh_faces.push_back(face);
    note_shading(smoothing, material, p.place);
    for (const TriangleVertices& triangle : triangles) part.add_triangle(id, triangle);
    if (is_luminous(material)) luminaires_.add_triangles({id, p.place, material}, triangles);
  }
}

}  // namespace rayfarm
