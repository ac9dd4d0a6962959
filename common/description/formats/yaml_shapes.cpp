#include "common/description/formats/yaml_shapes.h"

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
  polygon.smoothing = read_smoothing(map, Smoothing::phong);
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

std::vector<Shape> read_triangles(const YamlValue& value) {
  YamlMap map(value);
  MeshShape mesh;
  for (const YamlValue& p : map.require("points").items()) mesh.positions.emplace_back(p.vector());
  for (const YamlValue& t : map.require("triangles").items()) {
    const std::vector<YamlValue> corners = t.items();
    if (corners.size() != 3) t.fail("a triangle is three indices into `points`, counted from 0");
    glm::uvec3 indices;
    for (int k = 0; k < 3; ++k)
      indices[k] = static_cast<uint32_t>(
          corners[static_cast<size_t>(k)].whole_number_in(0, static_cast<int>(mesh.positions.size()) - 1));
    mesh.triangles.push_back(indices);
  }
  if (auto normals = map.find("normals")) {
    for (const YamlValue& n : normals->items()) mesh.normals.emplace_back(n.direction());
    if (mesh.normals.size() != mesh.positions.size())
      value.fail(
          fmt::format("the mesh has {} points but {} normals", mesh.positions.size(), mesh.normals.size()));
    mesh.triangle_normals = mesh.triangles;
  }
  mesh.smoothing = read_smoothing(map, mesh.normals.empty() ? Smoothing::flat : Smoothing::phong);
  map.finish();
  return {std::move(mesh)};
}

}  // namespace

std::span<const YamlShape> yaml_shapes() {
  static constexpr YamlShape kShapes[] = {
      {"sphere", read_sphere},      {"polygon", read_polygon}, {"box", read_box},
      {"cylinder", read_cylinder},  {"cone", read_cone},       {"quadric", read_quadric},
      {"triangles", read_triangles}};
  return kShapes;
}

Smoothing read_smoothing(YamlMap& map, Smoothing fallback) {
  if (auto v = map.find("smooth")) return static_cast<Smoothing>(v->choice({"flat", "phong", "center"}));
  return fallback;
}

}  // namespace rayfarm
