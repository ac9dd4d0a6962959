#include "common/lighting/textured.h"

#include <cmath>
#include <numbers>

#include "common/lighting/face_corners.h"
#include "common/lighting/principled_surface.h"
#include "common/materials/scattering.h"
#include "common/math/spherical.h"
#include "common/shapes/bilinear_patch.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// The parameters of a point in a plane quadrilateral, corners in order: p = bilinear(u, v) (Ullner 1983).
Vec2 bilinear_parameters(const std::array<Vec2, 4>& q, const Vec2& p) {
  const auto cross = [](const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; };
  const Vec2 e = q[1] - q[0], f = q[3] - q[0], g = q[0] - q[1] + q[2] - q[3], h = p - q[0];
  // cross(h - v f, e + v g) = 0, a quadratic in v.
  const double a = cross(g, f), b = cross(e, f) + cross(h, g), c = cross(h, e);
  double v;
  if (std::abs(a) <= 1e-12 * std::abs(b)) {
    v = b != 0 ? -c / b : 0;
  } else {
    const double root = std::sqrt(std::max(0.0, b * b - 4 * a * c));
    const double s = -0.5 * (b + std::copysign(root, b));
    const double v1 = s / a, v2 = s != 0 ? c / s : v1;
    const auto off = [](double x) { return std::max({0.0, -x, x - 1}); };
    v = off(v1) < off(v2) ? v1 : v2;
  }
  const Vec2 along = e + v * g, from = h - v * f;
  const double square = glm::dot(along, along);
  return {square > 0 ? glm::dot(from, along) / square : 0, v};
}

/// `normal`: the polygon's, unit.
Vec2 polygon_parameters(std::span<const Vec3> points, const Vec3& normal, const Vec3& p) {
  const Vec3 x = normalized(points[1] - points[0]), y = glm::cross(normal, x);
  const auto flat = [&](const Vec3& q) {
    return Vec2(glm::dot(q - points[0], x), glm::dot(q - points[0], y));
  };
  if (points.size() == 4)
    return bilinear_parameters({flat(points[0]), flat(points[1]), flat(points[2]), flat(points[3])}, flat(p));
  Vec2 lo(0), hi(0);
  for (const Vec3& q : points) {
    lo = glm::min(lo, flat(q));
    hi = glm::max(hi, flat(q));
  }
  return (flat(p) - lo) / glm::max(hi - lo, Vec2(1e-300));
}

Vec2 face_parameters(const Scene& scene, const MeshFace& face, const Vec3& p) {
  const Gathered<Vec3> points = points_of(scene, face);
  const Vec3 normal = normalized(newell_normal(points.span()));
  if (scene.face_uvs.empty() || std::isnan(scene.face_uvs[face.first_corner].x))
    return polygon_parameters(points.span(), normal, p);
  Gathered<Vec2> uvs(face.corner_count);
  for (size_t i = 0; i < face.corner_count; ++i) uvs[i] = scene.face_uvs[face.first_corner + i];
  return mean_value_sum(points.span(), uvs.span(), p, normal).mean();
}

/// The weights of a triangle's second and third vertex.
Vec2 triangle_weights(const Scene& scene, const Hit& hit, const Vec3& p) {
  const std::array<Vec3, 3> v = triangle_vertices(scene, hit.block_lane);
  const Vec3 n = glm::cross(v[1] - v[0], v[2] - v[0]);
  const double square = glm::dot(n, n);
  const double b = glm::dot(glm::cross(p - v[0], v[2] - v[0]), n) / square,
               c = glm::dot(glm::cross(v[1] - v[0], p - v[0]), n) / square;
  return {b, c};
}

/// `weights` of what stands at a triangle's corners.
template <typename Value, typename Stored>
Value at_weights(const Stored* corners, const Vec2& weights) {
  const Value first(corners[0]);
  return first + weights.x * (Value(corners[1]) - first) + weights.y * (Value(corners[2]) - first);
}

/// `uvs`: of all triangles, or none at all.
Vec2 triangle_parameters(std::span<const glm::vec2> uvs, const Hit& hit, const Vec2& weights) {
  if (uvs.empty()) return weights;
  const glm::vec2* const uv = &uvs[size_t{3} * hit.primitive.index()];
  return std::isnan(uv->x) ? weights : at_weights<Vec2>(uv, weights);
}

}  // namespace

Vec2 surface_parameters(const Scene& scene, const Hit& hit, const Vec3& p) {
  const uint32_t index = hit.primitive.index();
  switch (hit.primitive.kind()) {
    case PrimitiveKind::triangle:
      return triangle_parameters(scene.triangle_uvs, hit, triangle_weights(scene, hit, p));
    case PrimitiveKind::sphere: {
      const Vec3 d = (p - scene.spheres[index].center) / scene.spheres[index].radius;
      return {longitude(d.x, d.z), 1 - portable_acos(d.y) / pi};
    }
    case PrimitiveKind::polygon:
      return polygon_parameters(scene.points_of(scene.polygons[index]), scene.polygons[index].normal, p);
    case PrimitiveKind::face:
      return face_parameters(scene, scene.mesh_faces[index], p);
    case PrimitiveKind::quadric:
    case PrimitiveKind::collection:  // of no hit
      break;
  }
  if (scene.quadrics[index].is_patch) return patch_parameters(scene.planes_of(scene.quadrics[index]), p);
  const Box& box = scene.quadrics[index].bounds;
  const Vec3 d = p - box.center();
  return {longitude(d.x, d.z), (p.y - box.lo.y) / std::max(box.hi.y - box.lo.y, 1e-300)};
}

Vec2 second_parameters(const Scene& scene, const Hit& hit, const Vec3& p) {
  if (hit.primitive.kind() != PrimitiveKind::triangle || scene.second_uvs.empty() ||
      std::isnan(scene.second_uvs[size_t{3} * hit.primitive.index()].x))
    return surface_parameters(scene, hit, p);
  return triangle_parameters(scene.second_uvs, hit, triangle_weights(scene, hit, p));
}

Vec4 vertex_color(const Scene& scene, const Hit& hit, const Vec3& p) {
  const uint32_t index = hit.primitive.index();
  Vec4 color(65535);
  if (hit.primitive.kind() == PrimitiveKind::triangle && !scene.triangle_colors.empty()) {
    color = at_weights<Vec4>(&scene.triangle_colors[size_t{3} * index], triangle_weights(scene, hit, p));
  } else if (hit.primitive.kind() == PrimitiveKind::face && !scene.face_colors.empty()) {
    const MeshFace& face = scene.mesh_faces[index];
    const Gathered<Vec3> points = points_of(scene, face);
    Gathered<Vec4> colors(face.corner_count);
    for (size_t i = 0; i < face.corner_count; ++i) colors[i] = Vec4(scene.face_colors[face.first_corner + i]);
    color = mean_value_sum(points.span(), colors.span(), p, normalized(newell_normal(points.span()))).mean();
  }
  return glm::clamp(color / 65535.0, 0.0, 1.0);
}

Material textured(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit, double width,
                  double choice, Surface& surface, PrincipledPoint& point) {
  const Material& declared = scene.materials[surface.material];
  if (declared.kind == MaterialKind::principled && !declared.is_colored &&
      !scene.principled[declared.principled].has_textures)
    return principled_at(scene, declared, {}, ray.direction, surface, point);
  const SurfacePatch patch = patch_at(scene, pose, ray, hit, width, surface);
  while (scene.materials[surface.material].kind == MaterialKind::mix) {
    const Material& mix = scene.materials[surface.material];
    const double second =
        std::clamp(luminance(eval_texture(scene.textures[mix.texture], scene.texels, patch.at())), 0.0, 1.0);
    const bool is_second = choice < second;
    surface.material = mix.parts[is_second ? 1 : 0];
    // What is left of the choice chooses within a part that is a mix itself.
    choice = is_second ? choice / second : (choice - second) / (1 - second);
  }
  const Material& material = scene.materials[surface.material];
  if (material.kind == MaterialKind::principled)
    return principled_at(scene, material, patch, ray.direction, surface, point);
  Material result = material;
  if (material.is_colored)
    result.color *= glm::max(scene.head().channels_from_rgb * Color(patch.color), Color(0));
  if (material.texture != kNone)
    result.color *= glm::max(scene.head().channels_from_rgb *
                                 eval_texture(scene.textures[material.texture], scene.texels, patch.at()),
                             Color(0));
  if (material.bump != kNone) {
    const auto height = [&](const Vec3& point_on_it, const Vec2& parameters) {
      TexturePoint there = patch.at();
      there.p = point_on_it;
      there.uv = parameters;
      return material.bump_height *
             luminance(eval_texture(scene.textures[material.bump], scene.texels, there));
    };
    const auto& [uv, duv_x, duv_y, width_uv] = patch.sets[0];
    const Vec3& p = patch.p;
    const double here = height(p, uv);
    const double slope_x = (height(p + patch.dp_x, uv + duv_x) - here) / patch.step,
                 slope_y = (height(p + patch.dp_y, uv + duv_y) - here) / patch.step;
    // On the inside of a surface hills are valleys (Blinn 1978).
    const double side = surface.is_front ? 1 : -1;
    const Vec3 n =
        normalized(surface.shading_normal - side * (slope_x * patch.tangent + slope_y * patch.bitangent));
    if (glm::dot(n, ray.direction) < 0) surface.shading_normal = n;
  }
  return result;
}

}  // namespace rayfarm
