#include "common/lighting/zones/power_rays.h"

#include "common/lighting/textured.h"
#include "common/sampling/warps.h"

namespace rayfarm {

Lobes followed_lobes(const ZoneGrid* grid, const Material& material, const Interaction& at,
                     const Lobes& lobes) {
  Lobes followed;
  for (const Lobe& lobe : lobes) {
    if (grid && is_kept(*grid, lobe)) continue;
    const bool is_allowed =
        lobe.is_transmitted ||
        (lobe.spread == Lobe::Spread::diffuse ? has_diffuse_rays(material) : has_reflected_rays(material));
    if (!is_allowed || lobe.attenuation == Color(0)) continue;
    Lobe& power = followed.push_back(lobe);
    if (lobe.is_transmitted && has_inside(material)) power.attenuation *= at.index_ratio * at.index_ratio;
  }
  return followed;
}

void PowerTracer::send(const PowerRay& ray) {
  tally_.sent += ray.power;
  while (rays_.is_full()) step();
  rays_.push_back(ray);
  ++counts_[RayKind::diffuse];
}

void PowerTracer::finish() {
  while (!rays_.empty()) step();
}

void PowerTracer::step() {
  RayPacket packet;
  for (size_t i = 0; i < rays_.size(); ++i) packet.push_back(rays_[i].ray.origin, rays_[i].ray.direction);
  std::array<Hit, kMostPacketRays> hits;
  closest_hits(scene_, map_.pose(), packet, hits.data());
  InlineVector<PowerRay, kMostPacketRays> left;
  for (size_t i = 0; i < rays_.size(); ++i)
    if (meet(rays_[i], hits[i])) left.push_back(rays_[i]);
  rays_ = left;
}

void PowerTracer::cross_media(PowerRay& ray, double t) {
  const Ray way{ray.ray.origin, ray.ray.direction, t};
  for (const MediumSegment& segment : media_along(scene_, way)) {
    const ParticipatingMedium& medium = scene_.media[segment.medium];
    const auto lose = [&](double t0, double t1) {
      const Color depth = density_along(scene_, way, {segment.medium, t0, t1}) * medium.extinction();
      const Power before = ray.power;
      ray.power = scaled(ray.power, attenuation(depth));
      Power lost = before;
      lost -= ray.power;
      tally_.absorbed += lost;
      return lost;
    };
    const MediumGrid* const grid = media_.find(segment.medium);
    if (!grid) {
      lose(segment.t0, segment.t1);
      continue;
    }
    GridWalk piece(way, segment.t0, segment.t1, medium.box.lo, grid->step, grid->count);
    while (piece.next() && !ray.power.is_zero()) {
      const Power kept = scaled(lose(piece.t0(), piece.t1()), albedo_of(medium));
      if (!kept.is_zero()) keep_in_medium(ray, *grid, grid->index(piece.cell()), kept);
    }
  }
}

void PowerTracer::keep_in_medium(const PowerRay& ray, const MediumGrid& grid, uint64_t cell,
                                 const Power& power) {
  const uint64_t first = map_.slot_count() + grid.slot(cell);
  const auto keep = [&](uint64_t slot, const Power& part) {
    tally_.kept[slot] += part;
    tally_.absorbed -= part;
    if (ray.is_direct) tally_.direct[slot] += part;
  };
  if (grid.directions.rows == 0) {
    keep(first, power);
    return;
  }
  // Each cell that a ray crosses has numbers of its own; one direction of each will do, since there are many.
  const auto u = random_pair(settings_.seed, sampler_.frame(), ray.id,
                             dimension::of_mix(static_cast<uint32_t>(mix_bits(cell) >> 41)));
  const Vec3 local = sample_henyey_greenstein({u[0], u[1]}, scene_.media[grid.medium].asymmetry);
  keep(first + grid.directions.cell(Frame(normalized(ray.ray.direction)).to_world(local)), power);
}

bool PowerTracer::meet(PowerRay& ray, const Hit& hit) {
  if (!scene_.media.empty()) cross_media(ray, hit.t);
  if (!hit.is_hit()) {
    tally_.escaped += ray.power;
    return false;
  }
  Surface surface = eval_surface(scene_, map_.pose(), ray.ray, hit);
  Power left = ray.power;
  if (!ray.media.is_in_air()) left = scaled(left, ray.media.transmittance(scene_, hit.t));
  tally_.absorbed += ray.power;  // what goes on or is kept is taken off again
  const uint32_t stream = ray.depth;
  Material with_texture;
  const Material* material = &scene_.materials[surface.material];
  if (is_textured(*material)) {
    const double choice =
        material->kind == MaterialKind::mix ? sampler_.point(ray.id, dimension::of_mix(stream << 8)).x : 0;
    with_texture = textured(scene_, map_.pose(), ray.ray, hit, map_.size() / 4, choice, surface);
    material = &with_texture;
  }
  Interaction at = interaction_at(surface, ray.ray.direction, *material);
  if (has_inside(*material)) {
    const Media::Crossing crossing = ray.media.meet(scene_, surface.material, surface.is_front);
    if (!crossing.is_real) {
      ray.media.cross(surface.material, surface.is_front);
      if (++ray.depth > settings_.max_depth) return false;
      ray.ray = {surface.ray_origin(ray.ray.direction), ray.ray.direction};
      ray.power = left;
      tally_.absorbed -= left;
      return true;
    }
    at.index_ratio = crossing.index_ratio;
  }
  Lobes lobes;
  scatter(*material, at, lobes);
  const ZoneGrid* const grid = map_.grid_of(hit);
  if (grid && grid->store.is_any()) {
    const InstancePose& place = map_.pose()[hit.instance];
    const Vec3 p_object = place.in_object(surface.p);
    const uint32_t cell = map_.cell_at(*grid, map_.place_of(*grid, hit, p_object));
    KeptParts parts;
    find_kept(
        *grid, cell, colors_(*grid, cell), surface, at, lobes,
        grid->store.direction_cells > 0 ? map_.tangent(place, *grid, p_object) : Vec3(0),
        [&](uint32_t i) {
          return sampler_.point({ray.id.x, ray.id.y, 16 * ray.id.sample + i},
                                dimension::of_bounce(stream, dimension::kLightPoint));
        },
        parts);
    const Material& whole = scene_.materials[grid->material];
    if (!(map_.area(*grid, cell) > 0)) parts.clear();  // rounding led past a rim
    for (const KeptPart& part : parts) {
      const bool is_sent = part.slot == grid->slot(cell, 0) || part.slot == grid->slot(cell, 1)
                               ? has_diffuse_rays(whole)
                               : has_reflected_rays(whole);
      // What comes straight from sources is kept by all.
      if (!is_sent && !ray.is_direct) continue;
      const Power kept = scaled(left, part.fraction);
      tally_.kept[part.slot] += kept;
      if (ray.is_direct) tally_.direct[part.slot] += kept;
      tally_.absorbed -= kept;
    }
  }
  const Lobes followed = followed_lobes(grid, *material, at, lobes);
  if (followed.empty() || ray.depth >= settings_.max_depth) return false;
  return follow(ray, surface, at, *material, followed, left);
}

bool PowerTracer::follow(PowerRay& ray, const Surface& surface, const Interaction& at,
                         const Material& material, const Lobes& followed, Power& left) {
  const Vec2 u = sampler_.point(ray.id, dimension::of_bounce(ray.depth, dimension::kDirection));
  const double choice =
      followed.size() > 1 ? sampler_.point(ray.id, dimension::of_bounce(ray.depth, dimension::kLobe)).x : 0;
  const ScatteredRay next = sample(followed, at, u, choice);
  if (next.weight == Color(0) ||
      (glm::dot(surface.geometric_normal, next.direction) > 0) == next.is_transmitted)
    return false;
  left = scaled(left, next.weight);
  if (left.is_zero()) return false;
  if (next.is_transmitted && has_inside(material)) ray.media.cross(surface.material, surface.is_front);
  ++counts_[next.is_transmitted ? RayKind::transmitted : RayKind::reflected];
  ++ray.depth;
  ray.is_direct = false;
  ray.ray = {surface.ray_origin(next.direction), next.direction};
  ray.power = left;
  tally_.absorbed -= left;
  return true;
}

}  // namespace rayfarm
