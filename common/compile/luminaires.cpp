#include "common/compile/luminaires.h"

#include <utility>

#include "common/shapes/triangulate.h"

namespace rayfarm {
namespace {

/// Polygons of more corners would take long to look through for crossings.
constexpr size_t kMostCorners = 20'000;

/// The corners where rays meet the polygon: its plane is the mean of theirs.
std::vector<Vec3> on_the_plane(const Polygon& polygon, std::span<const Vec3> points) {
  const auto axis = static_cast<int>(polygon.drop_axis);
  std::vector<Vec3> moved(points.begin(), points.end());
  for (Vec3& p : moved) p[axis] += (polygon.distance - glm::dot(polygon.normal, p)) / polygon.normal[axis];
  return moved;
}

}  // namespace

void Luminaires::add_triangles(Luminous luminous, std::span<const TriangleVertices> triangles) {
  luminous.first_triangle = static_cast<uint32_t>(triangles_.size());
  for (const TriangleVertices& t : triangles) {
    const Vec3 a(t[0]), b(t[1]), c(t[2]);
    add(a, b, c, normalized(glm::cross(b - a, c - a)), luminous);
  }
  finish(luminous);
}

void Luminaires::add_polygon(Luminous luminous, const Polygon& polygon, std::span<const Vec3> points) {
  if (points.size() > kMostCorners || crosses_itself(points, polygon.normal)) {
    count(polygons_, luminous.place);
    return;
  }
  luminous.first_triangle = static_cast<uint32_t>(triangles_.size());
  const std::vector<Vec3> corners = on_the_plane(polygon, points);
  for (const auto& [a, b, c] : triangulate(points, polygon.normal))
    add(corners[a], corners[b], corners[c], polygon.normal, luminous);
  finish(luminous);
}

void Luminaires::add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal, Luminous& luminous) {
  const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
  if (!(area > 0)) return;
  const double before = luminous.triangle_count++ == 0 ? 0 : triangles_.back().area_through;
  triangles_.push_back({{a, b, c}, normal, before + area});
}

void Luminaires::finish(const Luminous& luminous) {
  if (luminous.triangle_count == 0) return;
  const auto own = std::span(triangles_).subspan(luminous.first_triangle);
  double magnitude = 0;
  for (const LuminaireTriangle& t : own)
    for (const Vec3& corner : t.corners) magnitude = std::max(magnitude, max_magnitude(corner));
  for (LuminaireTriangle& t : own) t.magnitude = magnitude;
  luminous_.push_back(luminous);
}

std::vector<Luminous> Luminaires::take() {
  std::sort(luminous_.begin(), luminous_.end(),
            [](const Luminous& a, const Luminous& b) { return a.id.bits < b.id.bits; });
  return std::exchange(luminous_, {});
}

void Luminaires::add_notes(const SceneDescription& description, Notes& notes) const {
  const auto note = [&](const Others& others, const char* what, const char* remedy) {
    if (others.count == 0) return;
    notes.add(description.source(others.first),
              fmt::format("{} shines but is no lamp{}: rays find its light by chance alone, in `path` and "
                          "`thesis` with much noise, in the other models not at all; {}",
                          what, others.count == 1 ? "" : fmt::format(" ({} of them)", others.count), remedy));
  };
  note(quadrics_, "a cone, cylinder or quadric", "make the lamp of polygons, triangles or spheres");
  note(deforming_, "a mesh that changes its shape", "put other lamps beside it");
  note(polygons_, "a polygon that crosses itself, or has very many corners,", "cut it into several");
}

}  // namespace rayfarm
