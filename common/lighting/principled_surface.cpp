#include "common/lighting/principled_surface.h"

#include "common/lighting/textured.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

Vec2 transformed(const PrincipledSource& source, const Vec2& uv) {
  const Vec3 at(uv, 1);
  return {glm::dot(source.u_row, at), glm::dot(source.v_row, at)};
}
Vec2 transformed_step(const PrincipledSource& source, const Vec2& duv) {
  const Vec3 step(duv, 0);
  return {glm::dot(source.u_row, step), glm::dot(source.v_row, step)};
}

Color texture_color(const Scene& scene, const PrincipledSource& source, const SurfacePatch& patch) {
  const PatchCoordinates& set = patch.sets[source.uv_set];
  const double stretch =
      std::max(glm::length(transformed_step(source, {1, 0})), glm::length(transformed_step(source, {0, 1})));
  return eval_texture(scene.textures[source.texture], scene.texels,
                      {patch.p, transformed(source, set.uv), patch.width, stretch * set.width});
}

double scalar(const Scene& scene, const PrincipledSource& source, const SurfacePatch& patch) {
  return std::clamp(eval_source(scene, source, patch).x, 0.0, 1.0);
}

/// The normal that a map gives, on the viewer's side. The axes of its (u, v) lie along the surface.
Vec3 mapped_normal(const Scene& scene, const PrincipledSource& source, const SurfacePatch& patch,
                   const Surface& surface) {
  const PatchCoordinates& set = patch.sets[source.uv_set];
  const Vec2 x = transformed_step(source, set.duv_x), y = transformed_step(source, set.duv_y);
  const double area = x.x * y.y - x.y * y.x;
  if (!(std::abs(area) > 0)) return surface.shading_normal;
  const Vec3 outward = surface.is_front ? surface.shading_normal : -surface.shading_normal;
  const Vec3 along_u = (y.y * patch.tangent - x.y * patch.bitangent) / area,
             along_v = (x.x * patch.bitangent - y.x * patch.tangent) / area;
  const Vec3 u = normalized(along_u - glm::dot(along_u, outward) * outward);
  Vec3 v = glm::cross(outward, u);
  if (glm::dot(v, along_v) < 0) v = -v;
  const Color c = texture_color(scene, source, patch);
  const Vec3 lean =
      normalized(Vec3(source.factor.x * (2 * c.x - 1), source.factor.x * (2 * c.y - 1), 2 * c.z - 1));
  const Vec3 n = normalized(lean.x * u + lean.y * v + lean.z * outward);
  return surface.is_front ? n : -n;
}

}  // namespace

SurfacePatch patch_at(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit, double width,
                      const Surface& surface) {
  const InstancePose& place = pose[hit.instance];
  const Scene& shapes = pose.shape_of(hit.instance, scene);
  const Vec3 p_world = ray.origin + hit.t * ray.direction;
  const Vec3 p = place.in_object(p_world);
  const Frame frame(surface.geometric_normal);
  SurfacePatch patch;
  patch.tangent = frame.tangent;
  patch.bitangent = frame.bitangent;
  // Steps along the surface, in the object's space: to measure how fast patterns change there.
  patch.step = std::max(width, 1e-4 * std::max(max_magnitude(p_world), hit.t));
  const auto along = [&](const Vec3& world) {
    return patch.step * (place.is_identity ? world : place.object_from_world.vector(world));
  };
  patch.dp_x = along(frame.tangent);
  patch.dp_y = along(frame.bitangent);
  const double per_step = width / patch.step;
  patch.p = p;
  patch.width = per_step * std::max(glm::length(patch.dp_x), glm::length(patch.dp_y));
  const auto coordinates = [&](auto parameters) {
    const Vec2 uv = parameters(shapes, hit, p);
    const auto wrapped = [](const Vec2& d) { return d - glm::round(d); };  // longitude jumps from 1 to 0
    const Vec2 duv_x = wrapped(parameters(shapes, hit, p + patch.dp_x) - uv),
               duv_y = wrapped(parameters(shapes, hit, p + patch.dp_y) - uv);
    return PatchCoordinates{uv, duv_x, duv_y, per_step * std::max(glm::length(duv_x), glm::length(duv_y))};
  };
  patch.sets[0] = coordinates(surface_parameters);
  patch.sets[1] = scene.second_uvs.empty() ? patch.sets[0] : coordinates(second_parameters);
  patch.color = vertex_color(shapes, hit, p);
  return patch;
}

Color eval_source(const Scene& scene, const PrincipledSource& source, const SurfacePatch& patch) {
  if (source.texture == kNone) return source.factor;
  const Color c = texture_color(scene, source, patch);
  switch (source.channel) {
    case TextureChannel::luminance:
      return source.factor * luminance(c);
    case TextureChannel::red:
      return source.factor * c.x;
    case TextureChannel::green:
      return source.factor * c.y;
    case TextureChannel::blue:
      return source.factor * c.z;
    case TextureChannel::color:
      break;
  }
  return source.factor * c;
}

PrincipledPoint eval_principled_point(const Scene& scene, const Material& material,
                                      const SurfacePatch& patch) {
  const PrincipledMaterial& m = scene.principled[material.principled];
  const auto in_channels = [&](const Color& rgb) {
    return glm::max(scene.head().channels_from_rgb * rgb, Color(0));
  };
  const auto color = [&](PrincipledInput input) { return in_channels(eval_source(scene, m[input], patch)); };
  PrincipledPoint p =
      principled_point(m, material, [&](PrincipledInput input) { return scalar(scene, m[input], patch); });
  // What is not textured keeps its digits: the pass's colours are the material's.
  const bool is_plain = m[PrincipledInput::base_color].texture == kNone;
  p.base = is_plain ? material.color : material.color * color(PrincipledInput::base_color);
  if (material.is_colored) p.base *= in_channels(Color(patch.color));
  p.base = glm::min(p.base, Color(1));
  p.specular_color = color(PrincipledInput::specular_color);
  return p;
}

Material principled_at(const Scene& scene, const Material& material, const SurfacePatch& patch,
                       const Vec3& ray_direction, Surface& surface, PrincipledPoint& point) {
  const PrincipledMaterial& m = scene.principled[material.principled];
  point = eval_principled_point(scene, material, patch);
  Material result = material;
  if (m.has_coefficients)
    result.color = point.base;
  else
    set_nearest_coefficients(point, result);
  if (const PrincipledSource& emission = m[PrincipledInput::emission]; emission.texture != kNone)
    result.emission *=
        glm::max(scene.head().channels_from_rgb * eval_source(scene, emission, patch), Color(0));
  if (material.is_unlit) result.emission = point.base;
  const Vec3 unmapped = surface.shading_normal;
  if (const PrincipledSource& normal = m[PrincipledInput::normal]; normal.texture != kNone)
    if (const Vec3 n = mapped_normal(scene, normal, patch, surface); glm::dot(n, ray_direction) < 0)
      surface.shading_normal = n;
  if (const PrincipledSource& normal = m[PrincipledInput::clearcoat_normal]; normal.texture != kNone) {
    Surface coat = surface;
    coat.shading_normal = unmapped;
    point.coat_normal = mapped_normal(scene, normal, patch, coat);
  } else if (surface.shading_normal != unmapped) {
    point.coat_normal = unmapped;  // a coat fills the hollows
  }
  return result;
}

}  // namespace rayfarm
