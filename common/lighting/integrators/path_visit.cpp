#include <algorithm>

#include "common/lighting/environment.h"
#include "common/lighting/integrators/path_tracer.h"
#include "common/lighting/light_choice.h"
#include "common/lighting/light_sampling.h"
#include "common/lighting/textured.h"

namespace rayfarm {

bool PathTracer::visit(size_t lane, Path& path, Ray& ray, const Hit& hit, Surface& surface) {
  if (!hit.is_hit()) {
    Color light = path.throughput * eval_background(scene_, ray.direction);
    if (path.pdf > 0 && scene_.head().environment != kNone)
      light *= balance(path.pdf, choice_probability(scene_, environment_source(scene_)) *
                                     environment_pdf(scene_, ray.direction));
    colors_[path.place] += light;
    return false;
  }
  if (path.depth == 1) ++eye_hits_;
  path.width += hit.t * path.spread;
  Material with_texture;
  PrincipledPoint point_there;
  const Material* chosen = &scene_.materials[surface.material];
  if (is_textured(*chosen)) {
    const double choice =
        chosen->kind == MaterialKind::mix ? sampler_.point(path.id, dimension::of_mix(path.depth << 8)).x : 0;
    with_texture = textured(scene_, pose_, ray, hit, path.width, choice, surface, point_there);
    chosen = &with_texture;
  }
  const Material& material = *chosen;
  if (!path.media.is_in_air()) path.throughput *= path.media.transmittance(scene_, hit.t);

  Interaction at = interaction_at(surface, ray.direction, material);
  if (material.kind == MaterialKind::principled && !context_.zones) at.principled = &point_there;
  const bool is_dielectric = has_inside(material);
  if (is_dielectric) {
    const Media::Crossing crossing = path.media.meet(scene_, surface.material, surface.is_front);
    if (!crossing.is_real) {
      path.media.cross(surface.material, surface.is_front);
      path.pdf = 0;  // no shadow ray could have come through
      ray = {surface.ray_origin(ray.direction), ray.direction};
      return ++path.depth <= settings_.max_depth;
    }
    at.index_ratio = crossing.index_ratio;
  }
  add_emission(path, ray, hit, surface, material, at);
  Lobes lobes;
  scatter(material, at, lobes);
  Lobes kept;
  if (context_.zones && ends_at_zones(path)) {
    kept = take_from_zones(path, hit, surface, at, lobes);
    if (kept.empty() && lobes.empty()) return false;
  }
  const bool is_last = path.depth >= settings_.max_depth;
  if (is_last) {
    if (kept.empty()) return false;
    lobes = Lobes();
  }
  keep_allowed(path, lobes);
  if (has_diffuse_rays(material) && kept.empty()) {
    add_direct_light(path, surface, at, lobes, lobes);
  } else {  // in one shadow ray: a step has room for one of each path
    Lobes followed, asked = kept;
    for (const Lobe& lobe : lobes) {
      asked.push_back(lobe);
      if (has_diffuse_rays(material) || is_followed(material, lobe)) followed.push_back(lobe);
    }
    add_direct_light(path, surface, at, asked, followed);
    lobes = followed;
  }
  if (is_last || lobes.empty()) return false;
  if (splits(path) && std::any_of(lobes.begin(), lobes.end(),
                                  [](const Lobe& lobe) { return lobe.spread != Lobe::Spread::perfect; })) {
    set_lane(lanes_.throughput, lane, path.throughput);  // the split rays begin with it
    turns_.push_back({lane, surface, at, lobes, is_dielectric});
    return false;
  }
  return turn(path, ray, surface, at, lobes, is_dielectric);
}

bool PathTracer::turn(Path& path, Ray& ray, const Surface& surface, const Interaction& at, const Lobes& lobes,
                      bool is_dielectric) {
  // Points are made only where they are asked for.
  const bool is_risky = path.depth >= kFirstRoulette;
  const Vec2 lobe = lobes.size() > 1 || is_risky ? point(path, dimension::kLobe) : Vec2(0);
  const ScatteredRay next = sample(lobes, at, point(path, dimension::kDirection), lobe.x);
  path.throughput *= next.weight;
  path.pdf = next.pdf;
  if (next.spread == Lobe::Spread::diffuse) path.spread = kDiffuseSpread;
  path.is_gathering |= next.spread != Lobe::Spread::perfect;
  if ((glm::dot(surface.geometric_normal, next.direction) > 0) == next.is_transmitted) return false;
  if (!survives(path, is_risky ? lobe.y : 0)) return false;
  if (is_by_medium_) [[unlikely]]
    leave(scene_, surface, next.direction, path.media);
  else if (next.is_transmitted && is_dielectric)
    path.media.cross(surface.material, surface.is_front);
  ++path.depth;
  ++(next.is_transmitted ? path.transmissions : path.reflections);
  ++(next.is_transmitted                    ? counts_[RayKind::transmitted]
     : next.spread == Lobe::Spread::diffuse ? counts_[RayKind::diffuse]
                                            : counts_[RayKind::reflected]);
  ray = {surface.ray_origin(next.direction), next.direction};
  return true;
}

Lobes PathTracer::take_from_zones(const Path& path, const Hit& hit, const Surface& surface,
                                  const Interaction& at, Lobes& lobes) {
  const ZoneGrid* const grid = context_.zones->grid_of(hit);
  if (!grid) return {};
  colors_[path.place] += path.throughput * context_.zones->radiance(pose_, *grid, hit, surface, at, lobes);
  Lobes kept, others;
  for (const Lobe& lobe : lobes) (is_kept(*grid, lobe) ? kept : others).push_back(lobe);
  lobes = others;
  return context_.zones->view() == ZoneView::direct ? kept : Lobes();
}

void PathTracer::keep_allowed(const Path& path, Lobes& lobes) const {
  const bool reflects = path.reflections < settings_.max_reflections,
             transmits = path.transmissions < settings_.max_transmissions;
  if (reflects && transmits) return;
  Lobes allowed;
  for (const Lobe& lobe : lobes)
    if (lobe.is_transmitted ? transmits : reflects) allowed.push_back(lobe);
  lobes = allowed;
}

void PathTracer::add_emission(Path& path, const Ray& ray, const Hit& hit, const Surface& surface,
                              const Material& material, const Interaction& at) {
  if (!is_luminaire(material)) return;
  Color light = path.throughput * emission_at(scene_, pose_, hit.instance, material, at);
  if (path.pdf > 0)
    if (const uint32_t source = find_luminaire(scene_, hit.instance, hit.primitive); source != kNone)
      light *= balance(path.pdf, choice_probability(scene_, source) *
                                     light_pdf(scene_, pose_, scene_.lights[source], ray.origin, surface));
  colors_[path.place] += light;
}

void PathTracer::add_direct_light(const Path& path, const Surface& surface, const Interaction& at,
                                  const Lobes& lobes, const Lobes& followed) {
  if (scene_.lights.empty()) return;
  const uint32_t source =
      scene_.lights.size() > 1 ? choose_light(scene_, point(path, dimension::kLight).x) : 0;
  const Light& light = scene_.lights[source];
  const Vec2 u = has_extent(light) ? point(path, dimension::kLightPoint) : Vec2(0);
  const LightSample sample = sample_light(scene_, pose_, light, surface.p, u);
  if (sample.incident == Color(0)) return;
  // Where smooth normals disagree with the surface, light must not come from the wrong side of it.
  if ((glm::dot(surface.geometric_normal, sample.to_light) > 0) != (glm::dot(at.normal, sample.to_light) > 0))
    return;
  const Scattered scattered = eval(lobes, at, sample.to_light);
  if (scattered.value == Color(0)) return;
  const double probability = choice_probability(scene_, source);
  // What paths may bring, too, is weighed against them; what they do not follow, shadow rays alone bring.
  const Scattered shared = &followed == &lobes ? scattered : eval(followed, at, sample.to_light);
  const double weight = sample.pdf > 0 ? balance(sample.pdf * probability, shared.pdf) : 1;
  Color color = path.throughput * shared.value * sample.incident * (weight / probability);
  if (&followed != &lobes)
    color += path.throughput * (scattered.value - shared.value) * sample.incident / probability;
  const Vec3 origin = surface.ray_origin(sample.to_light);
  if (shadows_.rays.is_full()) {  // where zones keep some lobes, a path asks for light twice
    add_unblocked(shadows_);
    shadows_.rays.clear();
  }
  if (is_by_medium_) [[unlikely]]
    leave(scene_, surface, sample.to_light, shadow_media_[path.place]);
  shadows_.push_back(origin, sample.target - origin, color, path.place);
}

bool PathTracer::survives(Path& path, double u) const {
  const double strength = max_component(path.throughput);
  if (!(strength > 0)) return false;
  if (path.depth < kFirstRoulette) return true;
  const double chance = std::min(1.0, std::sqrt(strength));
  if (u >= chance) return false;
  path.throughput /= chance;
  return true;
}

}  // namespace rayfarm
