#include "common/description/formats/yaml_shapes.h"

#include "common/description/formats/bezier.h"
#include "common/description/formats/mesh_faces.h"
#include "common/description/formats/solids.h"
#include "common/parallel/parallel_for.h"
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

enum class Vectors { any, not_zero };

/// Long lists are read by all cores.
template <typename List>
void read_vectors(const YamlValue& value, Vectors which, List& vectors) {
  const auto list = value.items_apart();
  if (!list) {
    for (const YamlValue& item : value.items())
      vectors.emplace_back(which == Vectors::any ? item.vector() : item.direction());
    return;
  }
  vectors.resize(list->size());
  value.take_all(*list, [&](size_t, size_t i, std::span<const double> v) {
    if (v.size() != 3) value.fail("three numbers were expected");
    const Vec3 vector(v[0], v[1], v[2]);
    if (which == Vectors::not_zero && max_magnitude(vector) == 0)
      value.fail("a zero vector was not expected");
    vectors[i] = typename List::value_type(vector);
  });
}

std::vector<Shape> read_polygon(const YamlValue& value) {
  YamlMap map(value);
  PolygonShape polygon;
  read_vectors(map.require("points"), Vectors::any, polygon.points);
  if (auto normals = map.find("normals")) read_vectors(*normals, Vectors::not_zero, polygon.normals);
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

/// What faces under a mesh's `key` may be.
struct FaceKind {
  const char* key;
  size_t least_corners, most_corners;
  const char* advice;

  bool allows(size_t corners) const { return corners >= least_corners && corners <= most_corners; }
};

void add_faces(const YamlValue& faces, const FaceKind& kind, MeshShape& mesh) {
  std::vector<FaceCorner> corners;
  for (const YamlValue& face : faces.items()) {
    corners.clear();
    for (const YamlValue& corner : face.items()) {
      const auto point =
          static_cast<uint32_t>(corner.whole_number_in(0, static_cast<int>(mesh.positions.size()) - 1));
      corners.push_back({point, mesh.normals.empty() ? ~0u : point});
    }
    if (!kind.allows(corners.size())) face.fail(kind.advice);
    add_face(mesh, corners);
  }
}

/// The same of a long list: its pieces are read, and then set into the mesh, by all cores.
void add_faces_apart(const YamlValue& faces, const NumberList& list, const FaceKind& kind, MeshShape& mesh) {
  struct Piece {
    LargeVector<uint32_t> sides, corners;
    FacePlace begin;
  };
  std::vector<Piece> pieces(list.piece_count());
  const auto end_of_points = static_cast<double>(mesh.positions.size());
  faces.take_all(list, [&](size_t i, size_t, std::span<const double> numbers) {
    if (!kind.allows(numbers.size())) faces.fail(kind.advice);
    pieces[i].sides.push_back(static_cast<uint32_t>(numbers.size()));
    for (const double number : numbers) {
      if (!(number >= 0 && number < end_of_points && number == std::floor(number)))
        faces.fail("an index into `points` was expected");
      pieces[i].corners.push_back(static_cast<uint32_t>(number));
    }
  });
  FacePlace end;
  for (Piece& piece : pieces) {
    piece.begin = end;
    for (const uint32_t sides : piece.sides) {
      end.triangle += sides == 3;
      end.polygon += sides > 3;
      end.polygon_corner += sides > 3 ? sides : 0;
    }
  }
  resize_faces(mesh, end);
  parallel_for(pieces.size(), [&](size_t i) {
    throw_if_stopped(faces.stop());
    FacePlace place = pieces[i].begin;
    std::vector<FaceCorner> corners;
    size_t first = 0;
    for (const uint32_t sides : pieces[i].sides) {
      corners.clear();
      for (const uint32_t point : std::span(pieces[i].corners).subspan(first, sides))
        corners.push_back({point, mesh.normals.empty() ? ~0u : point});
      set_face(mesh, place, corners);
      first += sides;
    }
    pieces[i] = {};
  });
}

std::vector<Shape> read_mesh_of(const YamlValue& value, const FaceKind& kind) {
  YamlMap map(value);
  MeshShape mesh;
  const YamlValue points = map.require("points");
  read_vectors(points, Vectors::any, mesh.positions);
  if (mesh.positions.empty()) points.fail("a mesh needs points");
  const YamlValue faces = map.require(kind.key);
  if (auto normals = map.find("normals")) {
    read_vectors(*normals, Vectors::not_zero, mesh.normals);
    if (mesh.normals.size() != mesh.positions.size())
      value.fail(
          fmt::format("the mesh has {} points but {} normals", mesh.positions.size(), mesh.normals.size()));
  }
  const bool has_normals = !mesh.normals.empty();
  mesh.smoothing = read_smoothing(map, has_normals ? Smoothing::phong : Smoothing::flat);
  map.finish();
  if (const auto list = faces.items_apart()) {
    add_faces_apart(faces, *list, kind, mesh);
  } else {
    add_faces(faces, kind, mesh);
  }
  if (mesh.smoothing != Smoothing::flat && !has_normals) average_normals(mesh, value.stop());
  return {std::move(mesh)};
}

std::vector<Shape> read_triangles(const YamlValue& value) {
  return read_mesh_of(value, {.key = "triangles",
                              .least_corners = 3,
                              .most_corners = 3,
                              .advice = "a triangle is three indices into `points`, counted from 0"});
}

std::vector<Shape> read_polygons(const YamlValue& value) {
  return read_mesh_of(value, {.key = "faces",
                              .least_corners = 3,
                              .most_corners = limits::kPolygonPoints,
                              .advice = "a face is three or more indices into `points`, counted from 0"});
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

/// Four corners in a plane are a polygon.
std::vector<Shape> read_patch(const YamlValue& value) {
  YamlMap map(value);
  const YamlValue list = map.require("points");
  std::vector<Vec3> points;
  read_vectors(list, Vectors::any, points);
  map.finish();
  if (points.size() != 4) list.fail(fmt::format("a patch has 4 corners, not {}", points.size()));
  const PatchCorners corners{points[0], points[1], points[2], points[3]};
  if (!is_planar(corners)) return {PatchShape{corners}};
  return {PolygonShape{points, {}, Smoothing::flat}};
}

/// More parts would make a mesh of two million triangles of one patch.
constexpr uint32_t kMostDivisions = 1000;
/// Of the diagonal about the patches: a quarter of a pixel where they fill a picture 1000 pixels wide.
constexpr double kUsualBezierError = 1.0 / 4000;

std::vector<Shape> read_bezier(const YamlValue& value) {
  YamlMap map(value);
  std::vector<Vec3> points;
  read_vectors(map.require("points"), Vectors::any, points);
  const YamlValue list = map.require("patches");
  std::vector<BezierPatch> patches;
  Box bounds;
  for (const YamlValue& item : list.items()) {
    const std::vector<YamlValue> indices = item.items();
    BezierPatch patch;
    if (indices.size() != patch.size())
      item.fail(fmt::format("a patch is 16 indices into `points`, counted from 0, not {}", indices.size()));
    for (size_t i = 0; i < patch.size(); ++i) {
      patch[i] =
          points[static_cast<size_t>(indices[i].whole_number_in(0, static_cast<int>(points.size()) - 1))];
      bounds.grow(patch[i]);
    }
    patches.push_back(patch);
  }
  if (patches.empty()) list.fail("there is no patch");
  const double diagonal = glm::length(bounds.extent());
  if (!(diagonal > 0)) list.fail("all points are one");
  const auto error = map.find("error"), count = map.find("divisions");
  if (error && count) count->fail("give either `divisions` or the `error` that they follow from");
  const double most_error = error ? error->number_in(1e-300, 1e15) : kUsualBezierError * diagonal;
  const uint32_t divisions = count ? static_cast<uint32_t>(count->whole_number_in(1, kMostDivisions))
                                   : divisions_for(patches, most_error, kMostDivisions + 1);
  if (divisions > kMostDivisions)
    value.fail(fmt::format("an error of {:g} needs patches cut into more than {} parts a side; allow more",
                           most_error, kMostDivisions));
  if (patches.size() * 2 * divisions * divisions > limits::kBezierTriangles)
    value.fail(
        fmt::format("{} patches cut into {} parts a side make more than {} triangles; allow a larger `error`",
                    patches.size(), divisions, limits::kBezierTriangles));
  const Smoothing smoothing = read_smoothing(map, Smoothing::phong);
  map.finish();
  return {dice_patches(patches, divisions, smoothing)};
}

}  // namespace

std::span<const YamlShape> yaml_shapes() {
  static constexpr YamlShape kShapes[] = {
      {"sphere", read_sphere},       {"polygon", read_polygon},   {"box", read_box},
      {"cylinder", read_cylinder},   {"cone", read_cone},         {"quadric", read_quadric},
      {"triangles", read_triangles}, {"polygons", read_polygons}, {"lathe", read_lathe},
      {"extrude", read_extrude},     {"patch", read_patch},       {"bezier", read_bezier}};
  return kShapes;
}

Smoothing read_smoothing(YamlMap& map, Smoothing fallback) {
  if (auto v = map.find("smooth"))
    return static_cast<Smoothing>(v->choice({"flat", "phong", "center", "gouraud"}));
  return fallback;
}

}  // namespace rayfarm
