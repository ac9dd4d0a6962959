#include "common/lighting/integrators/path_lanes.h"

#include "common/lighting/textured.h"

namespace rayfarm {

void PathLanes::clear_sets() {
  substrates = polished = conductors = dielectrics = classical = can_reflect = can_transmit = 0;
}

bool PathLanes::set_material(const Scene& scene, size_t lane, const Media& media) {
  const uint32_t number = surfaces.material[lane];
  const Material& material = scene.materials[number];
  const bool is_front = surfaces.is_front(lane);
  if (is_textured(material) || is_luminaire(material) || !has_diffuse_rays(material)) return false;
  if (material.exponent > 0 && material.kind != MaterialKind::lambertian) return false;
  const LaneSet bit = LaneSet{1} << lane;
  index_ratio[lane] = is_front ? material.index : 1 / material.index;
  const auto set_substrate = [&](const Color& color) {
    set_lane(substrate, lane, color);
    substrates |= bit;
  };
  switch (material.kind) {
    case MaterialKind::lambertian:
      set_substrate(material.color);
      break;
    case MaterialKind::classical:
      if (material.specular > 0 && !(material.reflect > 0)) return false;
      if (material.diffuse > 0) set_substrate(material.diffuse * material.color);
      if (!(material.reflect > 0) && !(material.transmit > 0)) break;
      classical |= bit;
      reflect[lane] = material.reflect;
      transmit[lane] = material.transmit;
      set_lane(through, lane, material.transmit * material.interior);
      break;
    case MaterialKind::polished:
      set_substrate(material.color);
      polished |= bit;
      index_ratio[lane] = material.index;
      break;
    case MaterialKind::conductor:
      conductors |= bit;
      set_lane(n, lane, material.n);
      set_lane(k, lane, material.k);
      break;
    case MaterialKind::dielectric: {
      const Media::Crossing crossing = media.meet(scene, number, is_front);
      if (!crossing.is_real) return false;
      dielectrics |= bit;
      index_ratio[lane] = crossing.index_ratio;
      break;
    }
    case MaterialKind::translucent:
    case MaterialKind::luminaire:
    case MaterialKind::mix:
    case MaterialKind::principled:
      return false;
  }
  return true;
}

void PathLanes::keep(LaneSet lanes) {
  rays.size = 0;
  for_each_lane(lanes, [this](size_t from) {
    const size_t to = rays.size++;
    rays.t_max[to] = std::numeric_limits<double>::infinity();
    if (from == to) return;
    for (size_t axis = 0; axis < 3; ++axis) {
      rays.origins[axis][to] = rays.origins[axis][from];
      rays.directions[axis][to] = rays.directions[axis][from];
      throughput[axis][to] = throughput[axis][from];
    }
    pdf[to] = pdf[from];
    pixel_keys[to] = pixel_keys[from];
    reversed_samples[to] = reversed_samples[from];
    places[to] = places[from];
  });
}

}  // namespace rayfarm
