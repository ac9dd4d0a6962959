#include "common/description/formats/yaml_shapes.h"

#include "common/description/formats/mesh_faces.h"
#include "common/description/formats/solids.h"
#include "common/shapes/triangulate.h"

namespace rayfarm {
namespace {

std::vector<Shape> read_sphere(const YamlValue& value) {
  YamlMap map(value);
  SphereShape sphere;
  sphere.center = map.require("center").vector();
  sphere.radius = map.require("radius").number();
  map.finish();
  return {sphere};
}

std::vector<Shape> read_cylinder(const YamlValue& value) {
  YamlMap map(value);
  ConeShape cone;
  cone.base = map.require("base").vector();
  cone.apex = map.require("top").vector();
  cone.base_radius = cone.apex_radius = map.require("radius").number();
  map.finish();
  return {cone};
}

std::vector<Shape> read_cone(const YamlValue& value) {
  YamlMap map(value);
  ConeShape cone;
  cone.base = map.require("base").vector();
  cone.apex = map.require("apex").vector();
  cone.base_radius = map.require("base_radius").number();
  cone.apex_radius = 0;
  if (auto v = map.find("apex_radius")) cone.apex_radius = v->number();
  map.finish();
  return {cone};
}

std::vector<Shape> read_quadric(const YamlValue& value) {
  YamlMap map(value);
  QuadricShape quadric;
  const YamlValue coefficients = map.require("coefficients");
  const std::vector<double> c = coefficients.numbers();
  if (c.size() != 10)
    coefficients.fail("a quadric has 10 coefficients: x², y², z², 2xy, 2xz, 2yz, 2x, 2y, 2z, 1");
  std::copy(c.begin(), c.end(), quadric.coefficients.begin());
  if (auto planes = map.find("planes"))
    for (const YamlValue& plane : planes->items()) {
      const std::vector<double> p = plane.numbers();
      if (p.size() != 4) plane.fail("a plane is [nx, ny, nz, d] and keeps the points with n·p <= d");
      quadric.planes.emplace_back(p[0], p[1], p[2], p[3]);
    }
  map.finish();
  return {quadric};
}

std::vector<Shape> read_polygon(const YamlValue& value) {
  YamlMap map(value);
  PolygonShape polygon;
  for (const YamlValue& p : map.require("points").items()) polygon.points.push_back(p.vector());
  if (auto normals = map.find("normals"))
    for (const YamlValue& n : normals->items()) polygon.normals.push_back(n.direction());
  if (!polygon.normals.empty() && polygon.normals.size() != polygon.points.size())
    value.fail(fmt::format("the polygon has {} points but {} normals", polygon.points.size(),
                           polygon.normals.size()));
  const bool is_asked = map.has("smooth");
  polygon.smoothing = read_smoothing(map, Smoothing::phong);
  if (is_asked && polygon.smoothing != Smoothing::flat && polygon.normals.empty())
    map.require("smooth").fail("a polygon is smooth by its normals: give `normals`, one for each point");
  map.finish();
  return {polygon};
}

std::vector<Shape> read_box(const YamlValue& value) {
  YamlMap map(value);
  const Vec3 lo = map.require("min").vector(), hi = map.require("max").vector();
  map.finish();
  if (!(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z))
    value.fail("each coordinate of `min` must be below that of `max`");
  const auto corner = [&](int i) {
    return Vec3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
  };
  static constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<Shape> sides;
  for (const auto& face : kFaces) {
    PolygonShape polygon;
    for (const int i : face) polygon.points.push_back(corner(i));
    sides.emplace_back(polygon);
  }
  return sides;
}

/// A mesh's faces stand under `key`; each has `least_corners` at least, `most_corners` at most.
std::vector<Shape> read_faces(const YamlValue& value, const char* key, size_t least_corners,
                              size_t most_corners, const char* advice) {
  YamlMap map(value);
  MeshShape mesh;
  const YamlValue points = map.require("points");
  for (const YamlValue& p : points.items()) mesh.positions.emplace_back(p.vector());
  if (mesh.positions.empty()) points.fail("a mesh needs points");
  const YamlValue faces = map.require(key);
  if (auto normals = map.find("normals")) {
    for (const YamlValue& n : normals->items()) mesh.normals.emplace_back(n.direction());
    if (mesh.normals.size() != mesh.positions.size())
      value.fail(
          fmt::format("the mesh has {} points but {} normals", mesh.positions.size(), mesh.normals.size()));
  }
  const bool has_normals = !mesh.normals.empty();
  mesh.smoothing = read_smoothing(map, has_normals ? Smoothing::phong : Smoothing::flat);
  map.finish();
  std::vector<FaceCorner> corners;
  for (const YamlValue& face : faces.items()) {
    corners.clear();
    for (const YamlValue& corner : face.items()) {
      const auto point =
          static_cast<uint32_t>(corner.whole_number_in(0, static_cast<int>(mesh.positions.size()) - 1));
      corners.push_back({point, has_normals ? point : ~0u});
    }
    if (corners.size() < least_corners || corners.size() > most_corners) face.fail(advice);
    add_face(mesh, corners);
  }
  if (mesh.smoothing != Smoothing::flat && !has_normals) average_normals(mesh, value.stop());
  return {std::move(mesh)};
}

std::vector<Shape> read_triangles(const YamlValue& value) {
  return read_faces(value, "triangles", 3, 3, "a triangle is three indices into `points`, counted from 0");
}

std::vector<Shape> read_polygons(const YamlValue& value) {
  return read_faces(value, "faces", 3, limits::kPolygonPoints,
                    "a face is three or more indices into `points`, counted from 0");
}

/// Corners of a solid's outline, of two coordinates each; more would take long to look through for crossings.
constexpr size_t kMostOutlineCorners = 20'000;

std::vector<Vec2> read_outline(const YamlValue& value, const char* advice) {
  std::vector<Vec2> outline;
  for (const YamlValue& item : value.items()) {
    const std::vector<double> p = item.numbers();
    if (p.size() != 2) item.fail(advice);
    if (!outline.empty() && outline.back() == Vec2(p[0], p[1])) item.fail("two points in a row are the same");
    outline.emplace_back(p[0], p[1]);
    if (outline.size() > kMostOutlineCorners)
      item.fail(fmt::format("at most {} points can stand here", kMostOutlineCorners));
  }
  return outline;
}

void check_outline(const YamlValue& value, std::span<const Vec2> loop) {
  std::vector<Vec3> points;
  for (const Vec2& p : loop) points.emplace_back(p, 0);
  if (crosses_itself(points, Vec3(0, 0, 1)))
    value.fail(fmt::format("{} crosses itself; make several of it", value.what()));
  if (loop.size() < 3 || twice_area(loop) == 0) value.fail(fmt::format("{} encloses nothing", value.what()));
}

std::vector<Shape> read_lathe(const YamlValue& value) {
  YamlMap map(value);
  const YamlValue outline = map.require("profile");
  const std::vector<Vec2> profile =
      read_outline(outline, "a point of a profile is [r, y]: its distance from the y axis, and its height");
  if (profile.size() < 2) outline.fail("a profile needs at least 2 points");
  for (const Vec2& p : profile)
    if (p.x < 0) outline.fail(fmt::format("a distance from the axis can't be below 0, as {:g} is", p.x));
  check_outline(outline, loop_of_profile(profile));
  const YamlValue steps = map.require("sides");
  const auto sides = static_cast<uint32_t>(steps.whole_number_in(3, 1'000'000));
  if (sides * (profile.size() - 1) > limits::kSolidFaces)
    steps.fail(fmt::format("a lathe can have at most {} faces", limits::kSolidFaces));
  const Smoothing smoothing = read_smoothing(map, Smoothing::phong);
  double crease = 30;
  if (auto v = map.find("crease")) {
    if (smoothing == Smoothing::flat)
      v->fail("`crease` belongs to a smooth lathe; leave it out of a flat one");
    crease = v->number_in(0, 179);
  }
  map.finish();
  return {make_lathe(profile, sides, smoothing, crease)};
}

std::vector<Shape> read_extrude(const YamlValue& value) {
  YamlMap map(value);
  const YamlValue outline = map.require("polygon");
  const std::vector<Vec2> polygon = read_outline(outline, "a point of the polygon is [x, z]");
  if (polygon.size() >= 2 && polygon.front() == polygon.back())
    outline.fail("the last point is the first again; leave it out, polygons are closed");
  check_outline(outline, polygon);
  const YamlValue height = map.require("height");
  if (!(height.number() > 0)) height.fail("the height must be above 0");
  map.finish();
  return {make_prism(polygon, height.number())};
}

}  // namespace

std::span<const YamlShape> yaml_shapes() {
  static constexpr YamlShape kShapes[] = {
      {"sphere", read_sphere},       {"polygon", read_polygon},   {"box", read_box},
      {"cylinder", read_cylinder},   {"cone", read_cone},         {"quadric", read_quadric},
      {"triangles", read_triangles}, {"polygons", read_polygons}, {"lathe", read_lathe},
      {"extrude", read_extrude}};
  return kShapes;
}

Smoothing read_smoothing(YamlMap& map, Smoothing fallback) {
  if (auto v = map.find("smooth"))
    return static_cast<Smoothing>(v->choice({"flat", "phong", "center", "gouraud"}));
  return fallback;
}

}  // namespace rayfarm
