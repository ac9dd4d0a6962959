// Whole searches of rays, with what threads remember of those before (RayMemory), if the scene asks for it.
// Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_REMEMBERED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_REMEMBERED_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_REMEMBERED_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_REMEMBERED_INL_H_
#endif

#include <hwy/highway.h>

#include "common/hierarchy/collections-inl.h"
#include "common/hierarchy/ray_memory.h"
#include "common/hierarchy/scene_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// Tests one primitive with a ray in the world. True: the search is over.
template <typename Search>
HWY_NOINLINE bool test_place(const Scene& scene, const Pose& pose, const HitPlace& place,
                             const PreparedRay& ray, Search& search) {
  const InstancePose& instance = pose[place.instance];
  if (instance.is_hidden) return false;
  const auto test = [&]() HWY_ATTR {
    if (instance.is_identity) return search.test(place.place, ray, place.instance);
    return search.test(place.place, PreparedRay(ray, instance.object_from_world), place.instance);
  };
  if (HWY_LIKELY(!instance.is_deformed)) return test();
  return walk_shapes(scene, pose, place.instance, search, [&](const Scene& shapes) HWY_ATTR {
    // What is remembered of another frame may not be there.
    return place.place.place() / 8 < shapes.triangle_blocks.size() && test();
  });
}

/// Searches the part of an instance that never moves.
template <typename Search>
HWY_NOINLINE bool search_whole(const Scene& scene, const Pose& pose, uint32_t instance,
                               const PreparedRay& ray, Search& search) {
  const InstancePose& place = pose[instance];
  const PreparedRay local = place.is_identity ? ray : PreparedRay(ray, place.object_from_world);
  SingleWalker walker(local, search);
  return walk_part(scene, instance, walker);
}

/// Searches what moves.
template <typename Search>
HWY_NOINLINE bool search_moving(const Scene& scene, const Pose& pose, const PreparedRay& ray,
                                Search& search) {
  SingleWalker walker(ray, search);
  return walk_boxes(pose.moving_nodes(), scene.head().moving_root, walker,
                    [&](const ChildRef& leaf, auto /*rays*/)
                        HWY_ATTR { return walk_instances(scene, pose, leaf, ray, search); });
}

/// True if the ray was searched: it begins where candidates are known for it. What moves is no candidate.
template <typename Search>
HWY_NOINLINE bool search_candidates(const Scene& scene, const Pose& pose, const PreparedRay& ray,
                                    RayCoherence& coherence, Search& search) {
  bool is_new;
  const RayCoherence::List* const list = coherence.find(ray.origin_vector(), ray.direction_vector(), is_new);
  if constexpr (Search::kCounts) {
    if (is_new) search.count_list();
  }
  if (!list) return false;
  if constexpr (Search::kCounts) search.count_coherent_ray();
  const double length = glm::length(ray.direction_vector());
  for (const RayCoherence::Listed& listed : *list) {
    if (listed.least_distance > search.t_far() * length) break;
    if constexpr (Search::kCounts) search.count_candidate();
    const Candidate& candidate = coherence[listed.candidate];
    if (candidate.is_whole ? search_whole(scene, pose, candidate.place.instance, ray, search)
                           : test_place(scene, pose, candidate.place, ray, search))
      return true;
  }
  search_moving(scene, pose, ray, search);
  return true;
}

/// What is remembered for rays of the search's kind.
template <typename Search>
HWY_INLINE HitPlace& last_of(RayMemory& memory) {
  return Search::kNearestFirst ? memory.closest : memory.occluder;
}

/// Before a ray is searched in the scene's way; true: it needs no such search any more.
template <typename Search>
HWY_NOINLINE bool begin_search(const Scene& scene, const Pose& pose, const PreparedRay& ray,
                               RayMemory& memory, Search& search) {
  const HitPlace& last = last_of<Search>(memory);
  if (scene.head().has_last_hit != 0 && last.instance != kNone) {
    if constexpr (Search::kCounts) search.count_last_hit_test();
    test_place(scene, pose, last, ray, search);
    if (search.is_over()) return true;
    // What is hit first is found again, and only looked for as far as this: so the answer is the same to the
    // last bit, whatever was tested before.
    search.forget_all_but_distance();
  }
  return memory.coherence && search_candidates(scene, pose, ray, *memory.coherence, search);
}

/// When the ray is searched.
template <typename Search>
HWY_NOINLINE void end_search(const Scene& scene, const Vec3& origin, const Vec3& direction, RayMemory& memory,
                             Search& search) {
  const HitPlace place = search.place();
  if (place.instance == kNone) return;
  if constexpr (Search::kNearestFirst) {
    if (memory.coherence) memory.coherence->note_hit(place, origin, origin + search.distance() * direction);
  }
  if constexpr (Search::kCounts) {
    if (scene.head().has_last_hit != 0 && last_of<Search>(memory) == place) search.count_last_hit();
  }
  last_of<Search>(memory) = place;
}

/// One ray in the whole scene, with what this thread remembers.
template <typename Search>
HWY_NOINLINE void search_remembering(const Scene& scene, const Pose& pose, const PreparedRay& ray,
                                     Search& search) {
  RayMemory& memory = RayMemory::of_this_thread(scene);
  if (!begin_search(scene, pose, ray, memory, search)) search_for_one(scene, pose, ray, search);
  end_search(scene, ray.origin_vector(), ray.direction_vector(), memory, search);
}

/// One ray in the whole scene.
template <typename Search>
HWY_INLINE void search_scene(const Scene& scene, const Pose& pose, const PreparedRay& ray, Search& search) {
  if (HWY_UNLIKELY(scene.tracing != nullptr)) {
    search_remembering(scene, pose, ray, search);
    return;
  }
  search_for_one(scene, pose, ray, search);
}

/// Those `among` a packet's rays in the whole scene, with what this thread remembers.
template <typename Search>
HWY_NOINLINE void search_remembering(const Scene& scene, const Pose& pose, const RayPacket& rays,
                                     uint32_t among, Search* searches) {
  RayMemory& memory = RayMemory::of_this_thread(scene);
  uint32_t open = among;
  for_each_lane(among, [&](size_t i) HWY_ATTR {
    if (begin_search(scene, pose, PreparedRay(rays, i), memory, searches[i])) open &= ~(1u << i);
  });
  search_for_packet(scene, pose, rays, open, searches);
  for_each_lane(among, [&](size_t i) HWY_ATTR {
    end_search(scene, rays.origin(i), rays.direction(i), memory, searches[i]);
  });
}

/// Those `among` a packet's rays in the whole scene.
template <typename Search>
HWY_INLINE void search_scene(const Scene& scene, const Pose& pose, const RayPacket& rays, uint32_t among,
                             Search* searches) {
  if (HWY_UNLIKELY(scene.tracing != nullptr)) {
    search_remembering(scene, pose, rays, among, searches);
    return;
  }
  search_for_packet(scene, pose, rays, among, searches);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
