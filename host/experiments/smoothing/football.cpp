#include "host/experiments/smoothing/football.h"

#include "common/description/formats/mesh_faces.h"

namespace rayfarm {
namespace {

/// Sorts places of points so that they run counter-clockwise seen from outside of the ball.
void sort_around(std::vector<uint32_t>& places, std::span<const Vec3> points) {
  Vec3 axis(0);
  for (const uint32_t i : places) axis += points[i];
  const Vec3 x = points[places[0]] - axis * (glm::dot(points[places[0]], axis) / glm::dot(axis, axis));
  const Vec3 y = glm::cross(normalized(axis), x);
  const auto angle = [&](uint32_t i) {  // rises from 0 to 4 round the circle
    const double across = glm::dot(points[i], x), up = glm::dot(points[i], y);
    const double share = across / (std::abs(across) + std::abs(up));
    return up >= 0 ? 1 - share : 3 + share;
  };
  std::sort(places.begin(), places.end(), [&](uint32_t a, uint32_t b) { return angle(a) < angle(b); });
}

}  // namespace

MeshShape make_football(Smoothing smoothing) {
  const double golden = 0.5 * (1 + std::sqrt(5.0));
  std::vector<Vec3> icosahedron;
  for (const double one : {-1.0, 1.0})
    for (const double phi : {-golden, golden})
      for (const Vec3& p : {Vec3(0, one, phi), Vec3(one, phi, 0), Vec3(phi, 0, one)})
        icosahedron.push_back(p);
  const size_t n = icosahedron.size();
  const auto are_neighbors = [&](size_t a, size_t b) {
    return a != b && glm::length(icosahedron[a] - icosahedron[b]) < 2.1;
  };
  // Each edge is cut at its thirds; a point belongs to the end that it is nearer to.
  MeshShape mesh;
  mesh.smoothing = smoothing;
  std::vector<Vec3> points;
  std::vector<uint32_t> place(n * n, ~0u);  // of the point on the way from a to b
  for (size_t a = 0; a < n; ++a)
    for (size_t b = 0; b < n; ++b)
      if (are_neighbors(a, b)) {
        place[a * n + b] = static_cast<uint32_t>(points.size());
        points.push_back(normalized(2.0 * icosahedron[a] + icosahedron[b]));
        mesh.positions.emplace_back(points.back());
      }
  const auto add = [&](std::vector<uint32_t> places) {
    sort_around(places, points);
    std::vector<FaceCorner> corners;
    for (const uint32_t i : places) corners.push_back({i});
    add_face(mesh, corners);
  };
  for (size_t a = 0; a < n; ++a) {
    std::vector<uint32_t> pentagon;
    for (size_t b = 0; b < n; ++b)
      if (are_neighbors(a, b)) pentagon.push_back(place[a * n + b]);
    add(pentagon);
    for (size_t b = a + 1; b < n; ++b)
      for (size_t c = b + 1; c < n; ++c)
        if (are_neighbors(a, b) && are_neighbors(b, c) && are_neighbors(c, a))
          add({place[a * n + b], place[b * n + a], place[b * n + c], place[c * n + b], place[c * n + a],
               place[a * n + c]});
  }
  if (smoothing != Smoothing::flat) average_normals(mesh, {});
  return mesh;
}

}  // namespace rayfarm
