// Walks through the object part into the parts of instances, of single rays and of packets. Compiled once for
// each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_SCENE_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_SCENE_WALK_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_SCENE_WALK_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_SCENE_WALK_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "common/hierarchy/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Does `walk(shapes)` with the search in the part of an instance that the frame has reshaped.
template <typename Search, typename Walk>
HWY_INLINE bool walk_shapes(const Scene& scene, const Pose& pose, uint32_t instance, Search& search,
                            Walk walk) {
  const Scene& shapes = pose.shape_of(instance, scene);
  search.look_in(shapes);
  const bool is_over = walk(shapes);
  search.look_in(scene);
  return is_over;
}

/// Walks the part of an instance that the frame has reshaped.
template <typename Search>
HWY_NOINLINE bool walk_deformed(const Scene& scene, const Pose& pose, uint32_t instance,
                                const PreparedRay& world, Search& search) {
  const InstancePose& place = pose[instance];
  const PreparedRay local = place.is_identity ? world : PreparedRay(world, place.object_from_world);
  return walk_shapes(scene, pose, instance, search, [&](const Scene& shapes) HWY_ATTR {
    SingleWalker walker(local, search);
    return walk_part(shapes, instance, walker);
  });
}

template <typename Search>
HWY_NOINLINE bool walk_instances(const Scene& scene, const Pose& pose, const ChildRef& leaf,
                                 const PreparedRay& world, Search& search) {
  for (const uint32_t instance : scene.leaf_instances.subspan(leaf.first, leaf.count())) {
    const InstancePose& place = pose[instance];
    if (place.is_hidden) continue;
    if (HWY_UNLIKELY(place.is_deformed)) {
      if (walk_deformed(scene, pose, instance, world, search)) return true;
    } else if (place.is_identity) {
      SingleWalker walker(world, search);
      if (walk_part(scene, instance, walker)) return true;
    } else {
      const PreparedRay local(world, place.object_from_world);
      SingleWalker walker(local, search);
      if (walk_part(scene, instance, walker)) return true;
    }
  }
  return false;
}

/// Walks a tree of the object part's boxes.
template <typename Walker, typename VisitInstances>
HWY_INLINE bool walk_boxes(const VolumeNode* nodes, const ChildRef& root, Walker& walker,
                           VisitInstances visit_instances) {
  if (root.kind() == ChildKind::inner) return walk(nodes, root, walker, visit_instances);
  return root.kind() == ChildKind::instances && visit_instances(root, Walker::kAll);
}

/// Walks the object part, what never moves first: `visit_instances(leaf, rays)` is called for its leaves.
template <typename Walker, typename VisitInstances>
HWY_INLINE bool walk_scene(const Scene& scene, const Pose& pose, Walker& walker,
                           VisitInstances visit_instances) {
  const VolumeNode* nodes = scene.fixed_nodes.data();
  // Where there is a tree of bounding volumes, it has been walked.
  ChildRef root = HWY_LIKELY(scene.head().object_tree == kNone) ? scene.head().fixed_root : ChildRef{};
  for (bool is_last = false;; is_last = true) {
    if (walk_boxes(nodes, root, walker, visit_instances)) return true;
    if (is_last) return false;
    nodes = pose.moving_nodes();
    root = scene.head().moving_root;
  }
}

template <typename Search>
bool search_scene_objects(const Scene& scene, const Pose& pose, const PrimitiveRay& ray,
                          Search& search);  // object_walk-inl.h

template <typename Search>
HWY_INLINE bool search_for_one(const Scene& scene, const Pose& pose, const PreparedRay& ray, Search& search) {
  if (HWY_UNLIKELY(scene.head().object_tree != kNone) && search_scene_objects(scene, pose, ray, search))
    return true;
  SingleWalker walker(ray, search);
  return walk_scene(scene, pose, walker, [&](const ChildRef& leaf, auto /*rays*/) HWY_ATTR {
    return walk_instances(scene, pose, leaf, ray, search);
  });
}

/// Walks the part of an instance, which stands in `world.scene`, with a bundle. Returns those of `rays` whose
/// searches are not known to be over.
template <typename Search>
HWY_INLINE uint32_t walk_instance(uint32_t instance, const InstancePose& place, const Bundle<Search>& world,
                                  const RayPacket& world_rays, const Packet& world_packet, uint32_t rays) {
  const Scene& scene = *world.scene;
  if (place.is_identity) {
    PacketWalker<Search> walker(world_packet, world);
    walk_part(scene, instance, walker);
    return rays;
  }
  for (uint32_t rest = rays; rest; rest &= rest - 1) {
    const auto i = static_cast<size_t>(std::countr_zero(rest));
    if (world.searches[i].is_over()) rays &= ~(1u << i);
  }
  if (rays == 0) return 0;
  RayPacket local_rays;
  copy_wanted_in_object(world_rays, place.object_from_world, rays, local_rays);
  if (!are_packet(local_rays, rays)) {
    for (uint32_t rest = rays; rest; rest &= rest - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(rest));
      const PreparedRay ray(local_rays, i);
      SingleWalker walker(ray, world.searches[i]);
      walk_part(scene, instance, walker);
    }
    return rays;
  }
  Bundle<Search> local;
  local.scene = &scene;
  local.searches = world.searches;
  local.held = rays;
  Packet packet;
  packet.join(local_rays, rays, local.rays.data());
  PacketWalker<Search> walker(packet, local);
  walk_part(scene, instance, walker);
  return rays;
}

/// The same where the frame has reshaped the part.
template <typename Search>
HWY_NOINLINE uint32_t walk_deformed(const Scene& scene, const Pose& pose, uint32_t instance,
                                    const Bundle<Search>& world, const RayPacket& world_rays,
                                    const Packet& world_packet, uint32_t rays) {
  Bundle<Search> in_shapes = world;
  in_shapes.scene = &pose.shape_of(instance, scene);
  const auto look_in = [&](const Scene& there) HWY_ATTR {
    for (uint32_t rest = world.held; rest; rest &= rest - 1)
      world.searches[static_cast<size_t>(std::countr_zero(rest))].look_in(there);
  };
  look_in(*in_shapes.scene);
  rays = walk_instance(instance, pose[instance], in_shapes, world_rays, world_packet, rays);
  look_in(scene);
  return rays;
}

/// Walks the parts of a leaf of the object part with a bundle; `rays`: those that meet it, which alone are
/// moved into the space of an instance. All lanes of `world_rays` are set.
template <typename Search>
HWY_NOINLINE void walk_instances(const Scene& scene, const Pose& pose, const ChildRef& leaf,
                                 const Bundle<Search>& world, const RayPacket& world_rays,
                                 const Packet& world_packet, uint32_t rays) {
  for (const uint32_t instance : scene.leaf_instances.subspan(leaf.first, leaf.count())) {
    const InstancePose& place = pose[instance];
    if (place.is_hidden) continue;
    rays = HWY_UNLIKELY(place.is_deformed)
               ? walk_deformed(scene, pose, instance, world, world_rays, world_packet, rays)
               : walk_instance(instance, place, world, world_rays, world_packet, rays);
    if (rays == 0) return;
  }
}

/// For the rays that are `among` these bits.
template <typename Search>
HWY_INLINE void search_for_packet(const Scene& scene, const Pose& pose, const RayPacket& rays, uint32_t among,
                                  Search* searches) {
  if (HWY_UNLIKELY(scene.head().object_tree != kNone) || !are_packet(rays, among)) {
    for (; among; among &= among - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(among));
      search_for_one(scene, pose, PreparedRay(rays, i), searches[i]);
    }
    return;
  }
  RayPacket filled_up;
  if (among != kAllRays) copy_wanted(rays, among, filled_up);
  const RayPacket& all = among == kAllRays ? rays : filled_up;
  Bundle<Search> bundle;
  bundle.scene = &scene;
  bundle.searches = searches;
  bundle.held = among;
  Packet packet;
  packet.join(all, among, bundle.rays.data());
  PacketWalker<Search> walker(packet, bundle);
  walk_scene(scene, pose, walker, [&](const ChildRef& leaf, uint32_t leaf_rays) HWY_ATTR {
    walk_instances(scene, pose, leaf, bundle, all, packet, leaf_rays & walker.active());
    walker.update();
    return walker.active() == 0;
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
