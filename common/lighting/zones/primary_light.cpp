#include "common/lighting/zones/primary_light.h"

#include <numbers>

#include "common/lighting/environment.h"
#include "common/lighting/integrators/path_step.h"
#include "common/lighting/light_choice.h"
#include "common/lighting/light_sampling.h"
#include "common/sampling/warps.h"

namespace rayfarm {

bool is_shot(const Scene& scene, const ZoneSettings& settings, const Light& light) {
  if (settings.primary != ZonePrimary::shot || light.kind != LightKind::luminaire) return false;
  const Material& material = scene.materials[light.material];
  return !(material.exponent > 0) && material.diagram == kNone;
}

ZonePoint PrimaryLight::point(const ZoneGrid& grid, uint32_t cell, uint32_t side, uint32_t sample) const {
  return sample_zone(map_, sampler_, settings_.seed, grid, cell, side,
                     id_of(grid.first_cell + uint64_t{cell}, side, sample));
}

namespace {

/// Of directions from all round.
constexpr double kSpherePdf = 0.25 / std::numbers::pi;

SampleId next(const SampleId& first, uint32_t i) {
  return {first.x, first.y, first.sample + i};
}

}  // namespace

void PrimaryLight::ask_sources(const SampleId& first, double share, RayCounts& counts, Asked& asked) const {
  if (scene_.lights.empty()) return;
  RayPacket rays;
  InlineVector<Answer, kMostPacketRays> answers;
  for (uint32_t i = 0; i < asked.points.size(); ++i) {
    const SampleId id = next(first, i);
    const Surface& surface = asked.points[i].surface;
    const uint32_t source =
        choose_light(scene_, sampler_.point(id, dimension::of_bounce(0, dimension::kLight)).x);
    const Light& light = scene_.lights[source];
    const LightSample sample =
        sample_light(scene_, map_.pose(), light, surface.p,
                     sampler_.point(id, dimension::of_bounce(0, dimension::kLightPoint)));
    const double cosine = glm::dot(surface.geometric_normal, sample.to_light);
    if (!(cosine > 0) || sample.incident == Color(0) || is_shot(scene_, settings_.zones, light)) continue;
    const double probability = choice_probability(scene_, source);
    const double weight = sample.pdf > 0 ? balance(sample.pdf * probability, cosine_pdf(cosine)) / probability
                                         : 1 / probability;
    const Vec3 origin = surface.ray_origin(sample.to_light);
    rays.push_back(origin, sample.target - origin, 1);
    answers.push_back({i, {sample.to_light, share * cosine * weight * sample.incident}});
  }
  if (rays.empty()) return;
  counts[RayKind::shadow] += rays.size;
  const uint32_t blocked = any_hits(scene_, map_.pose(), rays);
  for (size_t i = 0; i < rays.size; ++i)
    if (!(blocked >> i & 1)) {
      Answer& answer = asked.arrivals.push_back(answers[i]);
      answer.arrival.power *= left_by_media(rays[i]);
    }
}

void PrimaryLight::ask_by_chance(const SampleId& first, double share, RayCounts& counts, Asked& asked) const {
  RayPacket rays;
  for (uint32_t i = 0; i < asked.points.size(); ++i) {
    const Surface& surface = asked.points[i].surface;
    const Vec3 direction = Frame(surface.geometric_normal)
                               .to_world(sample_cosine(sampler_.point(
                                   next(first, i), dimension::of_bounce(0, dimension::kDirection))));
    rays.push_back(surface.ray_origin(direction), direction);
  }
  counts[RayKind::diffuse] += rays.size;
  std::array<Hit, kMostPacketRays> hits;
  closest_hits(scene_, map_.pose(), rays, hits.data());
  for (uint32_t i = 0; i < asked.points.size(); ++i) {
    Arrival arrival = emitted_at(
        rays[i], hits[i], cosine_pdf(glm::dot(asked.points[i].surface.geometric_normal, rays.direction(i))));
    if (arrival.power == Color(0)) continue;
    arrival.power *= share * std::numbers::pi;
    asked.arrivals.push_back({i, arrival});
  }
}

std::optional<Arrival> PrimaryLight::ask_source_in_medium(const SampleId& id, const Vec3& p,
                                                          const Color& share, RayCounts& counts) const {
  if (scene_.lights.empty()) return std::nullopt;
  const uint32_t source =
      choose_light(scene_, sampler_.point(id, dimension::of_bounce(0, dimension::kLight)).x);
  const Light& light = scene_.lights[source];
  const LightSample sample = sample_light(
      scene_, map_.pose(), light, p, sampler_.point(id, dimension::of_bounce(0, dimension::kLightPoint)));
  if (sample.incident == Color(0) || is_shot(scene_, settings_.zones, light)) return std::nullopt;
  const Ray ray{p, sample.target - p, 1};
  ++counts[RayKind::shadow];
  if (any_hit(scene_, map_.pose(), ray)) return std::nullopt;
  const double probability = choice_probability(scene_, source);
  const double weight = sample.pdf > 0 ? balance(sample.pdf * probability, kSpherePdf) : 1;
  return Arrival{sample.to_light, share * (weight / probability) * sample.incident * left_by_media(ray)};
}

std::optional<Arrival> PrimaryLight::ask_by_chance_in_medium(const SampleId& id, const Vec3& p,
                                                             const Color& share, RayCounts& counts) const {
  const Ray ray{p, sample_sphere(sampler_.point(id, dimension::of_bounce(0, dimension::kDirection)))};
  ++counts[RayKind::diffuse];
  Arrival arrival = emitted_at(ray, closest_hit(scene_, map_.pose(), ray), kSpherePdf);
  if (arrival.power == Color(0)) return std::nullopt;
  arrival.power *= share / kSpherePdf;
  return arrival;
}

/// Radiance in place of power.
Arrival PrimaryLight::emitted_at(const Ray& ray, const Hit& hit, double density) const {
  Arrival arrival{ray.direction};
  if (!hit.is_hit()) {
    arrival.power = eval_background(scene_, ray.direction) * left_by_media(ray);
    arrival.is_by_chance = scene_.head().environment == kNone;
    if (!arrival.is_by_chance)
      arrival.power *= balance(density, choice_probability(scene_, environment_source(scene_)) *
                                            environment_pdf(scene_, ray.direction));
    return arrival;
  }
  const Surface surface = eval_surface(scene_, map_.pose(), ray, hit);
  const Material& material = scene_.materials[surface.material];
  if (!is_luminaire(material)) return arrival;
  const uint32_t source = find_luminaire(scene_, hit.instance, hit.primitive);
  if (source != kNone && is_shot(scene_, settings_.zones, scene_.lights[source])) return arrival;
  arrival.power = emission_at(scene_, map_.pose(), hit.instance, material,
                              interaction_at(surface, ray.direction, material)) *
                  left_by_media({ray.origin, ray.direction, hit.t});
  arrival.is_by_chance = source == kNone;
  if (source != kNone)
    arrival.power *=
        balance(density, choice_probability(scene_, source) *
                             light_pdf(scene_, map_.pose(), scene_.lights[source], ray.origin, surface));
  return arrival;
}

}  // namespace rayfarm
