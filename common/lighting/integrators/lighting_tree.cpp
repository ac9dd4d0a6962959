#include "common/lighting/integrators/lighting_tree.h"

#include "common/lighting/holes.h"
#include "common/lighting/lobe_rays.h"

namespace rayfarm {

SecondaryRays secondary_rays(const ClassicalSurfaces& surfaces, size_t i, const Branch& branch,
                             const RenderSettings& settings) {
  const Material& material = *surfaces.materials[i];
  const auto rays_of_lobe = [&](uint32_t wanted) { return material.exponent > 0 ? wanted : 1; };
  SecondaryRays rays;
  const Interaction at = surfaces.interaction(i);
  rays.reflect = material.reflect;
  rays.transmit = material.transmit * material.interior;
  if (material.transmit > 0) {
    rays.transmitted = refracted(at);
    const uint32_t wanted = rays_of_lobe(settings.transmitted_rays);
    if (rays.transmitted == Vec3(0))
      rays.reflect += material.transmit;
    else if (branch.transmissions < settings.max_transmissions) {
      const double share = max_component(rays.transmit);
      if (branch.weight * share / wanted >= settings.min_weight)
        rays.transmitted_rays = wanted;
      else if (share > 0)
        rays.cut_rays += wanted;
    }
  }
  const uint32_t wanted = rays_of_lobe(settings.reflected_rays);
  if (has_reflected_rays(material) && branch.reflections < settings.max_reflections) {
    if (branch.weight * rays.reflect / wanted >= settings.min_weight) {
      rays.reflected_rays = wanted;
      rays.reflected = mirrored(at);
    } else if (rays.reflect > 0) {
      rays.cut_rays += wanted;
    }
  }
  return rays;
}

void pass_holes(const FrameContext& context, const RayPacket& rays, const OfPacket<Branch>& branches,
                Hit* hits) {
  for (size_t i = 0; i < rays.size; ++i) {
    const Branch& branch = branches[i];
    hits[i] = next_solid_hit(context, rays[i],
                             {branch.id, branch.stream, branch.width, branch.spread,
                              is_by_medium(context) ? &branch.media : nullptr},
                             hits[i]);
  }
}

OfPacket<Branch>& LightingTree::plant(const FrameContext& context, std::span<const SampleId> ids,
                                      Color* colors) {
  while (Batch* const left = next_batch()) end(*left);  // of rays whose tracing ended in an exception
  forks_.clear();
  colors_ = colors;
  eye_branches_.clear();
  depths_.fill(1);
  for (size_t i = 0; i < ids.size(); ++i) {
    Branch& branch = eye_branches_.emplace_back(ids[i], i, context.width, context.spread);
    if (context.eye_media) [[unlikely]]
      branch.media = *context.eye_media;
  }
  return eye_branches_;
}

Branch& LightingTree::grow(const Branch& from, const Vec3& origin, const Vec3& direction, double share,
                           uint32_t child, Batch& batch) {
  batch.rays.push_back(origin, direction);
  Branch& branch = batch.branches.push_back(from);
  branch.weight *= share;
  branch.stream = static_cast<uint32_t>(mix_bits(uint64_t{from.stream} << 32 | child));
  return branch;
}

template <typename Cross>
void LightingTree::grow_lobe(const FrameContext& context, Receiver receiver, const Branch& from,
                             const ClassicalSurfaces& surfaces, size_t i, const OfLobe& lobe, Batch*& batch,
                             Cross cross) {
  const auto grow_one = [&](const Vec3& direction, uint32_t child, const Receiver& to) {
    if (batch->rays.is_full()) batch = &begin_batch(batch->depth);
    reach(from, batch->depth);
    Branch& branch = grow(from, surfaces.at.ray_origin(i, direction), direction, max_component(lobe.share),
                          lobe.child + child, *batch);
    branch.receiver = to;
    branch.receiver.share = lobe.share;
    cross(branch);
    if (is_by_medium(context)) [[unlikely]]
      leave(context.scene, surfaces.at[i], direction, branch.media);
  };
  if (lobe.rays == 1) return grow_one(lobe.axis, 0, receiver);
  const auto stream = static_cast<uint32_t>(mix_bits(uint64_t{from.stream} << 32 | lobe.child));
  const LobeRays rays(lobe.axis, surfaces.materials[i]->exponent, lane_of(surfaces.at.geometric_normal, i),
                      lobe.rays, context.tables.sampler.point(from.id, stream << 8 | dimension::kDirection));
  // A fork for each ray but the last adds it to what the others bring, so that their order is always the
  // same.
  for (uint32_t ray = 0; ray < lobe.rays; ++ray) {
    Receiver to = receiver;
    if (ray + 1 < lobe.rays) {
      const uint32_t fork = add_fork(receiver, Color(0));
      forks_[fork].pending = 2;
      to = {Receiver::Kind::transmitted, fork};
      receiver = {Receiver::Kind::reflected, fork};
    }
    grow_one(rays[ray], ray * kOfLobe, to);
  }
}

void LightingTree::grow_secondary(const FrameContext& context, uint32_t fork, const Branch& from,
                                  const ClassicalSurfaces& surfaces, size_t i, const SecondaryRays& rays,
                                  Batch*& transmitted, Batch*& reflected) {
  forks_[fork].pending += (rays.transmitted_rays > 0 ? 1 : 0) + (rays.reflected_rays > 0 ? 1 : 0);
  if (rays.transmitted_rays > 0) {
    const bool is_lit_through = context.tables.settings.glass_shadows != GlassShadows::blocked;
    const bool is_crossed = has_inside(*surfaces.materials[i]) && !is_by_medium(context);
    grow_lobe(context, {Receiver::Kind::transmitted, fork}, from, surfaces, i,
              {rays.transmitted_rays, rays.transmitted,
               rays.transmit / static_cast<double>(rays.transmitted_rays), kTransmitted},
              transmitted, [&](Branch& branch) {
                ++branch.transmissions;
                branch.skips_sources = branch.skips_sources && is_lit_through;
                if (is_crossed) branch.media.cross(surfaces.at.material[i], surfaces.at.is_front(i));
              });
  }
  if (rays.reflected_rays > 0)
    grow_lobe(context, {Receiver::Kind::reflected, fork}, from, surfaces, i,
              {rays.reflected_rays, rays.reflected, Color(rays.reflect / rays.reflected_rays), kReflected},
              reflected, [](Branch& branch) {
                ++branch.reflections;
                branch.skips_sources = false;
              });
}

}  // namespace rayfarm
