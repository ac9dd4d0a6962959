#include "common/lighting/integrators/lighting_tree.h"

namespace rayfarm {

SecondaryRays secondary_rays(const ClassicalSurface& surface, const Branch& branch,
                             const RenderSettings& settings) {
  const Material& material = *surface.material;
  SecondaryRays rays;
  const Interaction at = surface.interaction();
  rays.reflect = material.reflect;
  rays.transmit = material.transmit;
  if (material.transmit > 0) {
    rays.transmitted = refracted(at);
    if (rays.transmitted == Vec3(0))
      rays.reflect += material.transmit;
    else
      rays.is_transmitted = branch.transmissions < settings.max_transmissions &&
                            branch.weight * material.transmit >= settings.min_weight;
  }
  rays.is_reflected =
      branch.reflections < settings.max_reflections && branch.weight * rays.reflect >= settings.min_weight;
  if (rays.is_reflected) rays.reflected = mirrored(at);
  return rays;
}

void LightingTree::plant(std::span<const Ray> rays, std::span<const SampleId> ids, double spread,
                         Color* colors) {
  while (Batch* const left = next_batch()) end(*left);  // of rays whose tracing ended in an exception
  forks_.clear();
  colors_ = colors;
  Batch& batch = begin_batch(1);
  for (size_t i = 0; i < rays.size(); ++i) {
    batch.rays.push_back(rays[i]);
    Branch& branch = batch.branches.emplace_back();
    branch.receiver.place = static_cast<uint32_t>(i);
    branch.id = ids[i];
    branch.spread = spread;
  }
}

Branch& LightingTree::grow(const Branch& from, const Surface& surface, const Vec3& direction, double share,
                           uint32_t child, Batch& batch) {
  batch.rays.push_back({surface.ray_origin(direction), direction});
  Branch& branch = batch.branches.push_back(from);
  branch.weight *= share;
  ++(child == kTransmitted ? branch.transmissions : branch.reflections);
  branch.stream = static_cast<uint32_t>(mix_bits(uint64_t{from.stream} << 32 | child));
  return branch;
}

void LightingTree::grow_secondary(uint32_t fork, const Branch& from, const Surface& surface,
                                  const SecondaryRays& rays, Batch& transmitted, Batch& reflected) {
  if (rays.is_transmitted) {
    grow(from, surface, rays.transmitted, rays.transmit, kTransmitted, transmitted).receiver = {
        Receiver::Kind::transmitted, fork, 0, rays.transmit};
    ++forks_[fork].pending;
  }
  if (rays.is_reflected) {
    grow(from, surface, rays.reflected, rays.reflect, kReflected, reflected).receiver = {
        Receiver::Kind::reflected, fork, 0, rays.reflect};
    ++forks_[fork].pending;
  }
}

}  // namespace rayfarm
