#include "common/lighting/light_sampling.h"

#include <numbers>

#include "common/lighting/environment.h"
#include "common/materials/scattering.h"
#include "common/math/portable_math.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// What a diagram that stands at `place` says of a direction (unit).
double intensity_along(const Scene& scene, uint32_t diagram, const LightPlace& place, Vec3 direction) {
  if (place.is_mirrored) {
    const Vec3 across = glm::cross(place.direction, place.zero);
    direction -= 2 * glm::dot(direction, across) * across;
  }
  return eval_intensity(scene.goniometric_diagrams[diagram], scene.goniometric_values, place.direction,
                        place.zero, direction);
}

/// A point on a primitive, in the world.
struct PrimitivePoint {
  Vec3 p{0}, normal{0};  ///< unit, outward
  double density = 0;    ///< per area
  double magnitude = 0;  ///< of the numbers that it was computed from
};

std::span<const LuminaireTriangle> triangles_of(const Scene& scene, const Light& light) {
  return scene.luminaire_triangles.subspan(light.first_triangle, light.triangle_count);
}

double area_in_object(const Scene& scene, const Light& light) {
  if (light.primitive.kind() != PrimitiveKind::sphere) return triangles_of(scene, light).back().area_through;
  const double r = scene.spheres[light.primitive.index()].radius;
  return 4 * pi * r * r;
}

PrimitivePoint point_on(std::span<const LuminaireTriangle> triangles, Vec2 u) {
  const double area = triangles.back().area_through;
  const double place = u.x * area;
  const auto chosen =
      std::upper_bound(triangles.begin(), triangles.end() - 1, place,
                       [](double value, const LuminaireTriangle& t) { return value < t.area_through; });
  const double before = chosen == triangles.begin() ? 0 : std::prev(chosen)->area_through;
  const Vec3 &a = chosen->corners[0], &b = chosen->corners[1], &c = chosen->corners[2];
  u.x = std::clamp((place - before) / (0.5 * glm::length(glm::cross(b - a, c - a))), 0.0, 1.0);
  const Vec2 weights = sample_triangle(u);
  return {a + weights.x * (b - a) + weights.y * (c - a), chosen->normal, 1 / area, chosen->magnitude};
}

PrimitivePoint point_on(const SphereRecord& sphere, const Vec2& u) {
  const Vec3 normal = sample_sphere(u);
  return {sphere.center + sphere.radius * normal, normal, 1 / (4 * pi * sphere.radius * sphere.radius),
          max_magnitude(sphere.center) + sphere.radius};
}

/// 1 - cos of the half angle under which a sphere is seen from a point outside it.
double one_minus_cosine(const SphereRecord& sphere, double distance2) {
  const double sine2 = sphere.radius * sphere.radius / distance2;
  return sine2 / (1 + std::sqrt(std::max(0.0, 1 - sine2)));
}

/// Spheres that are where they are described are sampled by the solid angle under which they are seen from
/// outside.
bool is_sampled_by_angle(const Scene& scene, const InstancePose& pose, const Light& light, const Vec3& p,
                         double& distance2) {
  if (light.primitive.kind() != PrimitiveKind::sphere || !pose.is_identity) return false;
  if (scene.materials[light.material].is_inward) return false;
  const SphereRecord& sphere = scene.spheres[light.primitive.index()];
  const Vec3 to_center = sphere.center - p;
  distance2 = glm::dot(to_center, to_center);
  return distance2 > sphere.radius * sphere.radius * (1 + 1e-9);
}

/// Chooses a direction from `p` to a sphere, `height` being 1 - cos of the half angle under which it is seen,
/// and the point that is seen there. The point's normal comes from the angles: what is left of distances that
/// nearly cancel would place it too far inside a small sphere, which would then shade itself.
PrimitivePoint point_by_angle(const SphereRecord& sphere, const Vec3& p, double distance2, double height,
                              const Vec2& u, Vec3& to_light) {
  const double distance = std::sqrt(distance2);
  const Vec3 axis = (sphere.center - p) / distance;
  to_light = Frame(axis).to_world(sample_cone(u, height));
  // Across the ray lies what is left of the way to the centre, in radii.
  const Vec3 across = (distance / sphere.radius) * (glm::dot(axis, to_light) * to_light - axis);
  const Vec3 normal = normalized(across - std::sqrt(std::max(0.0, 1 - glm::dot(across, across))) * to_light);
  return {sphere.center + sphere.radius * normal, normal, 0, max_magnitude(sphere.center) + sphere.radius};
}

LightSample sample_luminaire(const Scene& scene, const Pose& pose, const Light& light, const Vec3& p,
                             const Vec2& u) {
  const InstancePose& place = pose[light.instance];
  const Material& material = scene.materials[light.material];
  LightSample result;
  PrimitivePoint point;
  double distance2;
  if (is_sampled_by_angle(scene, place, light, p, distance2)) {
    const SphereRecord& sphere = scene.spheres[light.primitive.index()];
    const double height = one_minus_cosine(sphere, distance2);
    point = point_by_angle(sphere, p, distance2, height, u, result.to_light);
    result.pdf = cone_pdf(height);
  } else {
    point = light.primitive.kind() == PrimitiveKind::sphere
                ? point_on(scene.spheres[light.primitive.index()], u)
                : point_on(triangles_of(scene, light), u);
    if (!place.is_identity) {
      point.density /= area_scale(place, point.normal);
      point.p = place.world_from_object.point(point.p);
      point.normal = normalized(place.object_from_world.normal_by_inverse(point.normal));
      point.magnitude = magnitude_in_world(place, point.magnitude);
    }
    if (material.is_inward) point.normal = -point.normal;
    const Vec3 to_light = point.p - p;
    const double square = glm::dot(to_light, to_light);
    result.to_light = normalized(to_light);
    result.pdf = point.density * square / -glm::dot(point.normal, result.to_light);
  }
  if (!(glm::dot(point.normal, result.to_light) < 0) || !(result.pdf > 0)) return {};
  const double magnitude = std::max({point.magnitude, max_magnitude(point.p), max_magnitude(p)});
  result.target = point.p + rounding_bound(magnitude) * point.normal;
  result.incident = emission_at(scene, pose, light.instance, material,
                                {-result.to_light, point.normal, !material.is_inward, 1}) /
                    result.pdf;
  return result;
}

}  // namespace

LightSample sample_light(const Scene& scene, const Pose& pose, const Light& light, const Vec3& p,
                         const Vec2& u) {
  if (light.kind == LightKind::luminaire) return sample_luminaire(scene, pose, light, p, u);
  if (light.kind == LightKind::environment) {
    LightSample result = sample_environment(scene, u);
    result.target = p + scene.head().far_away * result.to_light;
    return result;
  }
  LightSample result;
  const LightPlace& place = pose[light];
  if (light.kind == LightKind::distant) {
    result.to_light = -place.direction;
    result.target = p + scene.head().far_away * result.to_light;
    result.incident = pi * light.color;
    return result;
  }
  const Vec3 to_light = place.position - p;
  result.to_light = normalized(to_light);
  result.target = place.position;
  result.incident =
      light.kind == LightKind::point ? pi * light.color : light.color / glm::dot(to_light, to_light);
  if (light.diagram != kNone)
    result.incident *= intensity_along(scene, light.diagram, place, -result.to_light);
  if (light.kind == LightKind::spot) {
    const double cosine = -glm::dot(place.direction, result.to_light);
    if (light.cosine_full > light.cosine_none)
      result.incident *= smooth_step(light.cosine_none, light.cosine_full, cosine);
    else if (cosine < light.cosine_full)
      result.incident = Color(0);
  }
  return result;
}

Color emission_at(const Scene& scene, const Pose& pose, uint32_t instance, const Material& material,
                  const Interaction& at) {
  const Color emission = emitted(material, at);
  if (material.diagram == kNone) return emission;
  const InstancePose& place = pose[instance];
  const Vec3 direction =
      place.is_identity ? at.to_viewer : normalized(place.object_from_world.vector(at.to_viewer));
  return eval_intensity(scene.goniometric_diagrams[material.diagram], scene.goniometric_values,
                        material.diagram_axis, material.diagram_zero, direction) *
         emission;
}

double light_pdf(const Scene& scene, const Pose& pose, const Light& light, const Vec3& origin,
                 const Surface& surface) {
  const InstancePose& place = pose[light.instance];
  double distance2;
  if (is_sampled_by_angle(scene, place, light, origin, distance2))
    return cone_pdf(one_minus_cosine(scene.spheres[light.primitive.index()], distance2));
  double area = area_in_object(scene, light);
  if (!place.is_identity) {
    const Vec3 local = normalized(glm::transpose(place.world_from_object.linear) * surface.geometric_normal);
    area *= area_scale(place, local);
  }
  const Vec3 to_light = surface.p - origin;
  const double square = glm::dot(to_light, to_light);
  const double cosine = std::abs(glm::dot(surface.geometric_normal, normalized(to_light)));
  return cosine > 0 ? square / (cosine * area) : 0;
}

double luminaire_area(const Scene& scene, const Light& light) {
  const InstancePose& place = scene.poses[light.instance];
  const double area = area_in_object(scene, light);
  if (place.is_identity) return area;
  if (light.primitive.kind() == PrimitiveKind::sphere)  // near enough: it only guides the choice
    return area / portable_pow(std::abs(glm::determinant(place.object_from_world.linear)), 2.0 / 3);
  return area * area_scale(place, triangles_of(scene, light).front().normal);
}

uint32_t find_luminaire(const Scene& scene, uint32_t instance, PrimitiveId primitive) {
  const auto key = [](const Light& light) { return std::pair(light.instance, light.primitive.bits); };
  const auto begin = scene.lights.begin() + scene.head().first_luminaire;
  const auto found =
      std::lower_bound(begin, scene.lights.end(), std::pair(instance, primitive.bits),
                       [&](const Light& light, const auto& wanted) { return key(light) < wanted; });
  if (found == scene.lights.end() || key(*found) != std::pair(instance, primitive.bits)) return kNone;
  return static_cast<uint32_t>(found - scene.lights.begin());
}

}  // namespace rayfarm
