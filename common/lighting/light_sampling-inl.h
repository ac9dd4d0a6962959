// What a source sends to several points at once, by the operations of light_sampling.cpp. Compiled once for
// each SIMD target.
#if defined(RAYFARM_COMMON_LIGHTING_LIGHT_SAMPLING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_LIGHTING_LIGHT_SAMPLING_INL_H_
#undef RAYFARM_COMMON_LIGHTING_LIGHT_SAMPLING_INL_H_
#else
#define RAYFARM_COMMON_LIGHTING_LIGHT_SAMPLING_INL_H_
#endif

#include "common/lighting/light_sampling.h"
#include "common/sampling/warps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// LightSamples, a lane each.
struct RealLightSample {
  Real3 to_light, target, incident;
  Real pdf;
};

/// Where the point that was chosen on a luminaire ends a shadow ray.
HWY_INLINE Real3 target_off(const Real3& point, const Real3& normal, Real magnitude, const Real3& p) {
  const Real largest = hn::Max(magnitude, hn::Max(max_magnitude(point), max_magnitude(p)));
  return point + (real(rounding_bound(1)) * largest) * normal;
}

/// A sphere by the angle under which it is seen. Returns the lanes that are outside it.
HWY_INLINE Truth sample_sphere_light(const SphereRecord& sphere, const Color& emission, const Real3& p,
                                     const Real2& u, RealLightSample& sample) {
  const RealTag d;
  const Real3 center = all(sphere.center);
  const Real radius = real(sphere.radius);
  const Real3 to_center = center - p;
  const Real distance2 = dot(to_center, to_center);
  const Truth is_outside = distance2 > real(sphere.radius * sphere.radius * (1 + 1e-9));
  const Real sine2 = real(sphere.radius * sphere.radius) / distance2;
  const Real height = sine2 / (real(1) + hn::Sqrt(at_least_0(real(1) - sine2)));
  const Real distance = hn::Sqrt(distance2);
  const Real3 axis = to_center / distance;
  sample.to_light = to_world(axis, sample_cone(u, height));
  const Real3 across = (distance / radius) * (dot(axis, sample.to_light) * sample.to_light - axis);
  const Real3 normal =
      normalized(across - hn::Sqrt(at_least_0(real(1) - dot(across, across))) * sample.to_light);
  sample.pdf = cone_pdf(height);
  sample.target = target_off(center + radius * normal, normal,
                             real(rayfarm::max_magnitude(sphere.center) + sphere.radius), p);
  const Truth is_seen = hn::And(dot(normal, sample.to_light) < hn::Zero(d), sample.pdf > hn::Zero(d));
  const Real3 incident = all(emission) / sample.pdf;
  sample.incident = select(is_seen, incident, all(hn::Zero(d)));
  return is_outside;
}

/// Triangles by their area; they are in the world's space.
HWY_INLINE void sample_triangle_light(std::span<const LuminaireTriangle> triangles, bool is_inward,
                                      const Color& emission, const Real3& p, const Real2& u,
                                      RealLightSample& sample) {
  const RealTag d;
  const double area = triangles.back().area_through;
  const Real place = u.x * real(area);
  const auto area_of = [](const LuminaireTriangle& t) {
    return 0.5 * glm::length(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]));
  };
  const LuminaireTriangle& first = triangles.front();
  Real3 a = all(first.corners[0]), b = all(first.corners[1]), c = all(first.corners[2]),
        normal = all(first.normal);
  Real before = real(0), own_area = real(area_of(first)), magnitude = real(first.magnitude);
  for (size_t i = 1; i < triangles.size(); ++i) {
    const LuminaireTriangle& t = triangles[i];
    const Real through = real(triangles[i - 1].area_through);
    const Truth is_here = place >= through;
    a = select(is_here, all(t.corners[0]), a);
    b = select(is_here, all(t.corners[1]), b);
    c = select(is_here, all(t.corners[2]), c);
    normal = select(is_here, all(t.normal), normal);
    before = select(is_here, through, before);
    own_area = select(is_here, real(area_of(t)), own_area);
    magnitude = select(is_here, real(t.magnitude), magnitude);
  }
  const Real part = (place - before) / own_area;
  const Real clamped = select(part > real(1), real(1), select(part < real(0), real(0), part));
  const Real2 weights = sample_triangle({clamped, u.y});
  const Real3 point = a + weights.x * (b - a) + weights.y * (c - a);
  if (is_inward) normal = -normal;
  const Real3 to_light = point - p;
  const Real square = dot(to_light, to_light);
  sample.to_light = normalized(to_light);
  const Real cosine = dot(normal, sample.to_light);
  sample.pdf = real(1 / area) * square / hn::Neg(cosine);
  sample.target = target_off(point, normal, magnitude, p);
  const Truth is_facing = cosine<hn::Zero(d), has_density = sample.pdf> hn::Zero(d);
  const Truth is_seen = hn::And(is_facing, has_density);
  const Real3 incident = all(emission) / sample.pdf;
  sample.incident = select(is_seen, incident, all(hn::Zero(d)));
}

/// As sample_light, for the lanes that are returned: none where the source is of a kind that is sampled one
/// point at a time.
HWY_INLINE uint32_t sample_light_in_lanes(const Scene& scene, const Pose& pose, const Light& light,
                                          const Real3& p, const Real2& u, RealLightSample& sample) {
  constexpr size_t kMostTriangles = 8;
  using std::numbers::pi;
  if (light.diagram != kNone) return 0;
  switch (light.kind) {
    case LightKind::distant: {
      const LightPlace& place = pose[light];
      sample.to_light = all(-place.direction);
      sample.target = p + real(scene.head().far_away) * sample.to_light;
      sample.incident = all(pi * light.color);
      sample.pdf = real(0);
      return kAllLanes;
    }
    case LightKind::point:
    case LightKind::bulb: {
      sample.target = all(pose[light].position);
      const Real3 to_light = sample.target - p;
      sample.to_light = normalized(to_light);
      sample.incident =
          light.kind == LightKind::point ? all(pi * light.color) : all(light.color) / dot(to_light, to_light);
      sample.pdf = real(0);
      return kAllLanes;
    }
    case LightKind::luminaire: {
      const Material& material = scene.materials[light.material];
      if (!pose[light.instance].is_identity || material.diagram != kNone || material.exponent > 0) return 0;
      if (light.primitive.kind() == PrimitiveKind::sphere) {
        if (material.is_inward) return 0;
        return bits_of(
            sample_sphere_light(scene.spheres[light.primitive.index()], material.emission, p, u, sample));
      }
      if (light.triangle_count > kMostTriangles) return 0;
      sample_triangle_light(scene.luminaire_triangles.subspan(light.first_triangle, light.triangle_count),
                            material.is_inward != 0, material.emission, p, u, sample);
      return kAllLanes;
    }
    case LightKind::spot:
    case LightKind::environment:
      return 0;
  }
  return 0;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // RAYFARM_COMMON_LIGHTING_LIGHT_SAMPLING_INL_H_
