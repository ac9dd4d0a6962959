#pragma once
// Finds what a ray hits. The boxes of eight children are tested at once, in float and conservatively;
// primitives are tested in double without fused operations, so that the answer is the same to the last bit on
// every SIMD target and for every hierarchy over the same primitives.
#include <string>
#include <vector>

#include "common/hierarchy/frame_state.h"
#include "common/hierarchy/hit.h"
#include "common/math/ray_packet.h"

namespace rayfarm {

/// The closest hit in (0, ray.t_max], visiting children in the order of their distance.
Hit closest_hit(const Scene& scene, const Pose& pose, const Ray& ray);

/// True if anything is hit in (0, ray.t_max).
bool any_hit(const Scene& scene, const Pose& pose, const Ray& ray);

/// The same answers for all rays of a packet at once, faster where they have nearly the same direction.
/// hits[i] is for rays[i], of which there is one at least; bit i of the result of any_hits tells that ray i
/// hits anything, of those `among` the bits given, whatever the packet's size: what lies in other lanes
/// changes nothing.
void closest_hits(const Scene& scene, const Pose& pose, const RayPacket& rays, Hit* hits);
uint32_t any_hits(const Scene& scene, const Pose& pose, const RayPacket& rays, uint32_t among);
inline uint32_t any_hits(const Scene& scene, const Pose& pose, const RayPacket& rays) {
  return any_hits(scene, pose, rays, rays.all());
}

/// The same answers from testing every primitive of every instance: what the tests compare with.
Hit closest_hit_brute_force(const Scene& scene, const Pose& pose, const Ray& ray);

/// The names of the SIMD targets that this machine can run, best first, and the choice of one of them ("" =
/// best). For tests that compare targets; not thread-safe.
std::vector<std::string> simd_targets();
void force_simd_target(const std::string& name);

}  // namespace rayfarm
