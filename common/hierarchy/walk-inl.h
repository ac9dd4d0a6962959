// Walks through the volumes of a part, of single rays and of packets. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_WALK_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_WALK_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_WALK_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "common/hierarchy/leaf_tests-inl.h"
#include "common/hierarchy/packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kStackSize = 7 * kMostHierarchyLevels + 8;

/// One ray's walk through the hierarchy. A walker tells `walk` how far to look and which rays meet a child.
template <typename Search>
class SingleWalker {
 public:
  static constexpr bool kNearestFirst = Search::kNearestFirst;
  static constexpr bool kCounts = Search::kCounts;
  /// There is but one ray, so sets of rays need no bits.
  struct RaySet {};
  struct RaySets {
    RaySet operator[](size_t) const { return {}; }
  };
  static constexpr RaySet kAll{};
  SingleWalker(const PreparedRay& ray, Search& search) : ray_(ray), search_(search) {}
  const BoxRay& box_ray() const { return ray_; }
  float t_far() const { return search_.t_far(); }
  bool search(const Scene& scene, const Collection& collection, uint32_t instance) {
    return search_collection(scene, collection, ray_, instance, search_);
  }
  HWY_INLINE uint32_t without_missed_children(const VolumeNode&, uint32_t mask, RaySet, RaySets&) const {
    return mask;
  }
  void count(const VolumeNode& node) { search_.count(node); }
  /// True ends the walk.
  HWY_INLINE bool visit_leaf(const ChildRef& leaf, uint32_t instance, RaySet) {
    return search_.test_leaf(leaf, ray_, instance);
  }

 private:
  const PreparedRay& ray_;
  Search& search_;
};

/// The rays of a packet in one space, each with its search.
template <typename Search>
struct Bundle {
  const Scene* scene;
  Search* searches;  ///< of all rays
  uint32_t held;     ///< bits of the rays that it holds; the others are not set
  std::array<PrimitiveRay, kPacketRays> rays;
};

/// A packet's walk through the hierarchy.
template <typename Search>
class PacketWalker {
 public:
  static constexpr bool kNearestFirst = Search::kNearestFirst;
  static constexpr bool kCounts = false;
  using RaySet = uint32_t;  ///< bit i: ray i
  using RaySets = std::array<RaySet, 8>;
  static constexpr RaySet kAll = kAllRays;
  PacketWalker(const Packet& packet, const Bundle<Search>& bundle) : packet_(packet), bundle_(bundle) {
    update();
  }
  const BoxRay& box_ray() const { return packet_.bounds(); }
  float t_far() const { return t_far_; }

  /// Drops the children that no ray of `among` meets, and tells for each of the others which rays do.
  HWY_INLINE uint32_t without_missed_children(const VolumeNode& node, uint32_t mask, RaySet among,
                                              RaySets& rays) const {
    for (uint32_t rest = mask; rest; rest &= rest - 1) {
      const auto slot = static_cast<size_t>(std::countr_zero(rest));
      rays[slot] = packet_.rays_meeting(node, slot, t_fars_) & among;
      if (rays[slot] == 0) mask &= ~(1u << slot);
    }
    return mask;
  }

  HWY_INLINE bool visit_leaf(const ChildRef& leaf, uint32_t instance, RaySet rays) {
    rays &= active_;
    if (leaf.kind() == ChildKind::triangles && std::popcount(rays) > 1) {
      for (uint32_t block = leaf.first; block < leaf.first + leaf.count(); ++block) {
        HWY_ALIGN Vertices<double> vertices;
        convert(bundle_.scene->triangle_blocks[block].vertices, vertices);
        for_each_ray(rays & active_, [&](Search& search, const PrimitiveRay& ray) HWY_ATTR {
          return search.test_block(block, vertices, ray, instance);
        });
      }
    } else {
      for_each_ray(rays, [&](Search& search, const PrimitiveRay& ray)
                             HWY_ATTR { return search.test_leaf(leaf, ray, instance); });
    }
    t_far_ = *std::max_element(t_fars_.begin(), t_fars_.end());
    return active_ == 0;
  }

  /// Ray by ray.
  bool search(const Scene& scene, const Collection& collection, uint32_t instance) {
    for_each_ray(active_, [&](Search& search, const PrimitiveRay& ray) HWY_ATTR {
      return search_collection(scene, collection, ray, instance, search);
    });
    t_far_ = *std::max_element(t_fars_.begin(), t_fars_.end());
    return active_ == 0;
  }

  uint32_t active() const { return active_; }
  /// Takes over what the searches have found elsewhere.
  void update() {
    active_ = 0;
    for (size_t i = 0; i < kPacketRays; ++i) {
      const bool is_active = (bundle_.held >> i & 1) && !bundle_.searches[i].is_over();
      t_fars_[i] = is_active ? bundle_.searches[i].t_far() : -1;
      active_ |= static_cast<uint32_t>(is_active) << i;
    }
    t_far_ = *std::max_element(t_fars_.begin(), t_fars_.end());
  }

 private:
  /// `test(search, ray)` tells that the ray's search is over.
  template <typename Test>
  HWY_INLINE void for_each_ray(uint32_t rays, Test test) {
    for (; rays; rays &= rays - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(rays));
      const bool is_over = test(bundle_.searches[i], bundle_.rays[i]);
      active_ &= ~(static_cast<uint32_t>(is_over) << i);
      t_fars_[i] = is_over ? -1 : bundle_.searches[i].t_far();
    }
  }

  const Packet& packet_;
  const Bundle<Search>& bundle_;
  uint32_t active_;  ///< the bits of the rays whose searches are not over
  float t_far_;
  HWY_ALIGN Packet::Lanes t_fars_;
};

/// Walks a tree of volume nodes; if the search asks for it, nearest child first and nothing that lies behind
/// the closest hit so far. `visit_leaf(child, rays)` returns true to end the walk.
template <typename Walker, typename VisitLeaf>
HWY_INLINE bool walk(const VolumeNode* HWY_RESTRICT nodes, ChildRef root, Walker& walker,
                     VisitLeaf visit_leaf) {
  struct Entry {
    uint64_t child;  ///< a ChildRef
    float t;
    [[no_unique_address]] typename Walker::RaySet rays;
  };
  Entry stack[kStackSize];  // not initialised: clearing it would cost more than many a walk
  Entry* top = stack;
  uint64_t current = std::bit_cast<uint64_t>(root);
  typename Walker::RaySet rays = Walker::kAll;
  typename Walker::RaySets rays_of;
  const auto child_of = [](const VolumeNode& node, size_t slot)
                            HWY_ATTR { return std::bit_cast<uint64_t>(node.children[slot]); };
  const BoxTest test_boxes(walker.box_ray());
  while (true) {
    while (std::bit_cast<ChildRef>(current).kind() == ChildKind::inner) {
      const VolumeNode& node = nodes[std::bit_cast<ChildRef>(current).first];
      if constexpr (Walker::kCounts) walker.count(node);
      HWY_ALIGN float entry[8];
      uint32_t mask =
          walker.without_missed_children(node, test_boxes(node, walker.t_far(), entry), rays, rays_of);
      if (mask == 0) goto next;
      const auto first = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      current = child_of(node, first);
      rays = rays_of[first];
      if (mask == 0) continue;
      const auto entry_of = [&](size_t slot) HWY_ATTR {
        return Entry{child_of(node, slot), entry[slot], rays_of[slot]};
      };
      if constexpr (!Walker::kNearestFirst) {
        for (; mask; mask &= mask - 1) *top++ = entry_of(static_cast<size_t>(std::countr_zero(mask)));
        continue;
      }
      // Of two, the farther waits.
      const auto second = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      if (mask == 0) {
        if (entry[first] <= entry[second]) {
          *top++ = entry_of(second);
        } else {
          *top++ = entry_of(first);
          current = child_of(node, second);
          rays = rays_of[second];
        }
        continue;
      }
      // More are sorted on the stack, the nearest on top.
      Entry* const base = top;
      *top++ = entry_of(first);
      const auto insert = [&](size_t slot) HWY_ATTR {
        Entry* place = top++;
        for (; place > base && place[-1].t < entry[slot]; --place) *place = place[-1];
        *place = entry_of(slot);
      };
      insert(second);
      for (; mask; mask &= mask - 1) insert(static_cast<size_t>(std::countr_zero(mask)));
      --top;
      current = top->child;
      rays = top->rays;
    }
    if (visit_leaf(std::bit_cast<ChildRef>(current), rays)) return true;
  next:
    do {
      if (top == stack) return false;
      --top;
    } while (Walker::kNearestFirst && top->t > walker.t_far());
    current = top->child;
    rays = top->rays;
  }
}

template <typename Walker>
HWY_INLINE bool walk_volumes(const Scene& scene, const Collection& collection, uint32_t instance,
                             Walker& walker) {
  return walk(
      scene.nodes.data(), collection.root, walker,
      [&](const ChildRef& leaf, typename Walker::RaySet rays) HWY_ATTR
      __attribute__((always_inline)) { return walker.visit_leaf(leaf, instance, rays); });
}

/// Walks an instance's part by the structure that it has. The walker is in the part's space.
template <typename Walker>
HWY_INLINE bool walk_part(const Scene& scene, uint32_t instance, Walker& walker) {
  const Collection& collection = scene.parts[scene.instances[instance].part].collection;
  if (HWY_LIKELY(collection.structure == Structure::volumes))
    return walk_volumes(scene, collection, instance, walker);
  return walker.search(scene, collection, instance);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // RAYFARM_COMMON_HIERARCHY_WALK_INL_H_
