#include "common/compile/shapes.h"

#include <cmath>

#include "common/errors/input_error.h"
#include "common/materials/scattering.h"

namespace rayfarm {
namespace {

/// The triangles of a small convex polygon, which are tested eight at a time; empty if it has to be tested as
/// it is. Triangles are stored in float: a polygon whose corners that would move by a visible part of its
/// size stays whole.
std::vector<TriangleVertices> triangle_fan(std::span<const Vec3> points, const Vec3& normal) {
  constexpr size_t kMostPoints = 8;
  constexpr double kMostMove = 2e-7;  // of the polygon's size
  const size_t n = points.size();
  if (n > kMostPoints) return {};
  Box box;
  for (const Vec3& p : points) box.grow(p);
  const double most = kMostMove * max_component(box.extent());
  for (size_t i = 0; i < n; ++i) {
    const Vec3 &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (!(glm::dot(glm::cross(b - a, c - b), normal) > 0)) return {};
    if (max_magnitude(Vec3(glm::vec3(a)) - a) > most) return {};
  }
  std::vector<TriangleVertices> fan;
  for (size_t i = 1; i + 1 < n; ++i) {
    fan.push_back({glm::vec3(points[0]), glm::vec3(points[i]), glm::vec3(points[i + 1])});
    const Vec3 a(fan.back()[0]), b(fan.back()[1]), c(fan.back()[2]);
    if (max_magnitude(glm::cross(b - a, c - a)) == 0) return {};
  }
  return fan;
}

/// Moves points onto the plane, along the axis by which rays see the polygon, if they stand off by more than
/// rounding: rays meet the plane, so bounds have to be of what lies in it.
void flatten(const Polygon& polygon, std::span<Vec3> points) {
  constexpr double kRounding = 1e-13;  // of a coordinate
  const auto axis = static_cast<int>(polygon.drop_axis);
  for (Vec3& p : points) {
    const double off = glm::dot(polygon.normal, p) - polygon.distance;
    if (std::abs(off) > kRounding * max_magnitude(p)) p[axis] -= off / polygon.normal[axis];
  }
}

}  // namespace

void ShapeCompiler::note_shading(uint32_t smoothing, uint32_t material, const Place& place) {
  if (smoothing != static_cast<uint32_t>(Smoothing::gouraud)) return;
  const Material& m = arrays_.materials[material];
  const bool has_map = m.kind == MaterialKind::principled &&
                       arrays_.principled[m.principled][PrincipledInput::normal].texture != kNone;
  if (m.bump != kNone || has_map) count(bumped_, place);
}

bool ShapeCompiler::is_luminous(uint32_t material) const {
  return is_luminaire(arrays_.materials[material]) && !arrays_.materials[material].is_no_lamp;
}

void ShapeCompiler::count(Others& others, const Place& place) {
  if (others.count++ == 0) others.first = place;
}

std::optional<PrimitiveId> ShapeCompiler::add_triangle(const TriangleVertices& v,
                                                       const TriangleShading& shading, const Place& place) {
  const Vec3 a(v[0]), b(v[1]), c(v[2]);
  if (max_magnitude(glm::cross(b - a, c - a)) == 0) {
    count(dropped_, place);
    return std::nullopt;
  }
  const PrimitiveId id =
      make_primitive_id(PrimitiveKind::triangle, static_cast<uint32_t>(arrays_.triangle_shading.size()));
  arrays_.triangle_shading.push_back(shading);
  note_shading(shading.smoothing, shading.material, place);
  if (is_luminous(shading.material))
    luminaires_.add_triangles({id, place, shading.material}, std::span(&v, 1));
  return id;
}

void ShapeCompiler::add(PartPrimitives& part, const PrimitiveDescription& p, const SphereShape& sphere) {
  const PrimitiveId id =
      make_primitive_id(PrimitiveKind::sphere, static_cast<uint32_t>(arrays_.spheres.size()));
  part.add(id);
  arrays_.spheres.push_back({sphere.center, sphere.radius, p.material, 0});
  if (is_luminous(p.material)) luminaires_.add_sphere({id, p.place, p.material});
}

void ShapeCompiler::add_quadric(PartPrimitives& part, const PrimitiveDescription& p, Quadric quadric,
                                std::span<const Vec4> planes) {
  const std::optional<Box> bounds = quadric_bounds(quadric, planes);
  if (!bounds)
    throw InputError(
        description_.source(p.place),
        "the quadric reaches to infinity; add planes ([nx, ny, nz, d] keeps n·p <= d) that bound it");
  if (bounds->is_empty())
    throw InputError(description_.source(p.place),
                     "nothing is left of the quadric: it has no real points between its planes");
  quadric.bounds = *bounds;
  store_quadric(part, p, quadric, planes);
}

void ShapeCompiler::store_quadric(PartPrimitives& part, const PrimitiveDescription& p, Quadric quadric,
                                  std::span<const Vec4> planes) {
  quadric.first_plane = static_cast<uint32_t>(arrays_.quadric_planes.size());
  quadric.plane_count = static_cast<uint32_t>(planes.size());
  quadric.material = p.material;
  arrays_.quadric_planes.insert(arrays_.quadric_planes.end(), planes.begin(), planes.end());
  part.add(make_primitive_id(PrimitiveKind::quadric, static_cast<uint32_t>(arrays_.quadrics.size())));
  arrays_.quadrics.push_back(quadric);
  if (is_luminous(p.material)) luminaires_.add_quadric(p.place);
}

void ShapeCompiler::add(PartPrimitives& part, const PrimitiveDescription& p, const ConeShape& cone) {
  std::array<Vec4, 2> planes;
  const Quadric quadric = make_cone(cone.base, cone.base_radius, cone.apex, cone.apex_radius, planes);
  add_quadric(part, p, quadric, planes);
}

void ShapeCompiler::add(PartPrimitives& part, const PrimitiveDescription& p, const QuadricShape& shape) {
  const Quadric about_origin = make_quadric(shape.coefficients, Vec3(0));
  const std::optional<Box> bounds = quadric_bounds(about_origin, shape.planes);
  const Vec3 center = bounds && !bounds->is_empty() ? bounds->center() : Vec3(0);
  add_quadric(part, p, make_quadric(shape.coefficients, center), shape.planes);
}

void ShapeCompiler::add(PartPrimitives& part, const PrimitiveDescription& p, const PatchShape& shape) {
  std::array<Vec4, 4> planes;
  const Quadric quadric = make_patch(shape.corners, planes);
  store_quadric(part, p, quadric, planes);
}

void ShapeCompiler::add(PartPrimitives& part, const PrimitiveDescription& p, const PolygonShape& shape) {
  const auto smoothing = static_cast<uint32_t>(shape.normals.empty() ? Smoothing::flat : shape.smoothing);
  if (shape.points.size() == 3) {  // triangles have a faster test and less to store
    TriangleShading shading{p.material, smoothing, {kNone, kNone, kNone}};
    if (!shape.normals.empty() && shape.smoothing != Smoothing::flat)
      for (size_t i = 0; i < 3; ++i) {
        shading.normals[i] = static_cast<uint32_t>(arrays_.normals.size());
        arrays_.normals.emplace_back(normalized(shape.normals[i]));
      }
    const TriangleVertices v{glm::vec3(shape.points[0]), glm::vec3(shape.points[1]),
                             glm::vec3(shape.points[2])};
    if (const auto id = add_triangle(v, shading, p.place)) part.add_triangle(*id, v);
    return;
  }
  Polygon polygon;
  polygon.normal = normalized(newell_normal(shape.points));
  if (max_magnitude(polygon.normal) == 0) {
    count(dropped_, p.place);
    return;
  }
  Vec3 center(0);
  for (const Vec3& q : shape.points) center += q;
  center /= static_cast<double>(shape.points.size());
  polygon.distance = glm::dot(polygon.normal, center);
  polygon.first_point = static_cast<uint32_t>(arrays_.polygon_points.size());
  polygon.point_count = static_cast<uint32_t>(shape.points.size());
  polygon.smoothing = smoothing;
  polygon.material = p.material;
  polygon.drop_axis = largest_axis(polygon.normal);
  arrays_.polygon_points.insert(arrays_.polygon_points.end(), shape.points.begin(), shape.points.end());
  if (smoothing != static_cast<uint32_t>(Smoothing::flat)) {
    polygon.first_normal = static_cast<uint32_t>(arrays_.polygon_normals.size());
    for (const Vec3& normal : shape.normals) arrays_.polygon_normals.push_back(normalized(normal));
  }
  const PrimitiveId id =
      make_primitive_id(PrimitiveKind::polygon, static_cast<uint32_t>(arrays_.polygons.size()));
  arrays_.polygons.push_back(polygon);
  note_shading(smoothing, p.material, p.place);
  const std::vector<TriangleVertices> fan = triangle_fan(shape.points, polygon.normal);
  for (const TriangleVertices& triangle : fan) part.add_triangle(id, triangle);
  if (fan.empty()) {
    flatten(polygon, std::span(arrays_.polygon_points).subspan(polygon.first_point));
    part.add(id);
  }
  if (!is_luminous(p.material)) return;
  const Luminous luminous{id, p.place, p.material};
  if (fan.empty())
    luminaires_.add_polygon(luminous, polygon,
                            std::span(arrays_.polygon_points).subspan(polygon.first_point));
  else
    luminaires_.add_triangles(luminous, fan);
}

void ShapeCompiler::add_notes(Notes& notes) const {
  if (dropped_.count > 0) {
    const bool is_one = dropped_.count == 1;
    notes.add(description_.source(dropped_.first),
              fmt::format("{} polygon{} or triangle{} without area, or whose parts cancel each other, "
                          "{} left out; cut what crosses itself into several",
                          dropped_.count, is_one ? "" : "s", is_one ? "" : "s", is_one ? "is" : "are"));
  }
  if (folded_.count > 0)
    notes.add(description_.source(folded_.first),
              fmt::format("{} face{} of meshes {} not planar: triangles stand for {}, each shaded by itself",
                          folded_.count, folded_.count == 1 ? "" : "s", folded_.count == 1 ? "is" : "are",
                          folded_.count == 1 ? "it" : "them"));
  if (bumped_.count > 0)
    notes.add(description_.source(bumped_.first),
              "`smooth: gouraud` takes its light from the corners, where no bump map tilts the normals: "
              "bumps show in mirrored and refracted light alone, and in `path`; `smooth: phong` shows them");
}

}  // namespace rayfarm
