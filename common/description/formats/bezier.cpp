#include "common/description/formats/bezier.h"

namespace rayfarm {
namespace {

/// Weights of a cubic's control points at i / n: those of one end are those of the other end from there.
std::array<double, 4> cubic_weights(uint32_t i, uint32_t n) {
  const double t = static_cast<double>(i) / n, s = static_cast<double>(n - i) / n;
  return {s * s * s, 3 * (s * (s * t)), 3 * ((s * t) * t), t * t * t};
}
/// Of its derivative.
std::array<double, 4> slope_weights(double t) {
  const double s = 1 - t;
  return {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t};
}
std::array<double, 4> cubic_weights(double t) {
  const double s = 1 - t;
  return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
}

/// The same to the bit from either end.
Vec3 weigh(const std::array<double, 4>& w, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (w[0] * a + w[3] * d) + (w[1] * b + w[2] * c);
}

Vec3 at(const BezierPatch& p, const std::array<double, 4>& u, const std::array<double, 4>& v) {
  std::array<Vec3, 4> rows;
  for (size_t j = 0; j < 4; ++j) rows[j] = weigh(u, p[4 * j], p[4 * j + 1], p[4 * j + 2], p[4 * j + 3]);
  return weigh(v, rows[0], rows[1], rows[2], rows[3]);
}

/// Where an edge is drawn together to a point the derivative along it is 0: then the normal is that of a
/// place a little further in.
Vec3 normal_at(const BezierPatch& p, double u, double v) {
  for (double inward = 0; inward < 0.5; inward = inward == 0 ? 1e-4 : 8 * inward) {
    const double x = u + inward * (0.5 - u), y = v + inward * (0.5 - v);
    const Vec3 along_u = at(p, slope_weights(x), cubic_weights(y)),
               along_v = at(p, cubic_weights(x), slope_weights(y));
    const Vec3 n = glm::cross(along_u, along_v);
    if (glm::length(n) > 1e-9 * max_magnitude(along_u) * max_magnitude(along_v) && max_magnitude(n) > 0)
      return normalized(n);
  }
  return Vec3(0);
}

}  // namespace

uint32_t divisions_for(std::span<const BezierPatch> patches, double error, uint32_t most) {
  double largest = 0;  // of D_uu + 2 D_uv + D_vv
  for (const BezierPatch& p : patches) {
    double uu = 0, uv = 0, vv = 0;
    const auto point = [&p](size_t i, size_t j) { return p[4 * j + i]; };
    for (size_t j = 0; j < 4; ++j)
      for (size_t i = 0; i < 4; ++i) {
        if (i < 2) uu = std::max(uu, glm::length(point(i, j) - 2.0 * point(i + 1, j) + point(i + 2, j)));
        if (j < 2) vv = std::max(vv, glm::length(point(i, j) - 2.0 * point(i, j + 1) + point(i, j + 2)));
        if (i < 3 && j < 3)
          uv = std::max(
              uv, glm::length((point(i + 1, j + 1) - point(i + 1, j)) - (point(i, j + 1) - point(i, j))));
      }
    largest = std::max(largest, 6 * uu + 2 * 9 * uv + 6 * vv);
  }
  const double needed = std::ceil(std::sqrt(largest / (8 * error)));
  return static_cast<uint32_t>(std::clamp(needed, 1.0, static_cast<double>(most)));
}

MeshShape dice_patches(std::span<const BezierPatch> patches, uint32_t divisions, Smoothing smoothing) {
  const uint32_t n = divisions, side = n + 1;
  MeshShape mesh;
  mesh.smoothing = smoothing;
  const bool is_smooth = smoothing != Smoothing::flat;
  for (const BezierPatch& patch : patches) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (uint32_t j = 0; j <= n; ++j)
      for (uint32_t i = 0; i <= n; ++i) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        mesh.positions.emplace_back(at(patch, cubic_weights(i, n), cubic_weights(j, n)));
        mesh.uvs.emplace_back(u, v);
        if (is_smooth) mesh.normals.emplace_back(normal_at(patch, u, v));
      }
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
      const auto& p = mesh.positions;
      if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return;  // at an edge that is a point
      mesh.triangles.emplace_back(a, b, c);
      mesh.triangle_uvs.emplace_back(a, b, c);
      if (is_smooth) mesh.triangle_normals.emplace_back(a, b, c);
    };
    for (uint32_t j = 0; j < n; ++j)
      for (uint32_t i = 0; i < n; ++i) {
        const uint32_t a = first + j * side + i, b = a + 1, c = b + side, d = a + side;
        add(a, b, c);
        add(a, c, d);
      }
  }
  return mesh;
}

}  // namespace rayfarm
