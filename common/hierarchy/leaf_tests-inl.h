// The two searches: for the closest hit and for any. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <optional>

#include "common/hierarchy/crossings-inl.h"
#include "common/hierarchy/hit_place.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <typename Search>
bool search_collection(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                       uint32_t instance, Search& search);  // these two: collections-inl.h
template <typename Search>
bool search_inner_collection(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                             uint32_t instance, Search& search);

/// Tests all primitives of the collection.
template <typename Search>
HWY_NOINLINE bool search_list(const Collection& c, const PrimitiveRay& ray, uint32_t instance,
                              Search& search) {
  return search.test_leaf(make_child(ChildKind::triangles, c.first_triangle_block, c.triangle_block_count),
                          ray, instance) ||
         search.test_leaf(make_child(ChildKind::spheres, c.first_sphere_block, c.sphere_block_count), ray,
                          instance) ||
         search.test_leaf(make_child(ChildKind::mixed, c.first_leaf_primitive, c.leaf_primitive_count), ray,
                          instance);
}

/// Tests leaves and keeps the closest hit.
class ClosestHit {
 public:
  static constexpr bool kNearestFirst = true;
  static constexpr bool kCounts = false;
  ClosestHit() = default;
  /// `hit.t` bounds the search.
  ClosestHit(const Scene& scene, Hit& hit) : scene_(&scene), hit_(&hit), t_far_(widened(hit.t)) {}
  /// Where the primitives stand that are tested from now on.
  void look_in(const Scene& scene) { scene_ = &scene; }
  /// Boxes behind this distance need no visit.
  float t_far() const { return t_far_; }
  static bool is_over() { return false; }
  /// Of the closest hit so far.
  HitPlace place() const { return {hit_->instance, place_}; }
  double distance() const { return hit_->t; }
  /// Of the closest hit so far: only as near as that is anything sought.
  void forget_all_but_distance() {
    const double t = hit_->t;
    *hit_ = {};
    hit_->t = t;
  }

  /// False: go on. True: the search is over (never, for a closest hit).
  HWY_INLINE bool test_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (HWY_LIKELY(leaf.kind() == ChildKind::triangles)) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        test_block(i, scene_->triangle_blocks[i].vertices, ray, instance);
    } else {
      test_other_leaf(leaf, ray, instance);
    }
    return false;
  }

  /// Tests one block of triangles.
  template <typename Number>
  HWY_INLINE bool test_block(uint32_t index, const Vertices<Number>& vertices, const PrimitiveRay& ray,
                             uint32_t instance) {
    TriangleCrossings crossings;
    take_triangles(index, cross_triangles(vertices, ray, crossings), crossings, instance);
    return false;
  }

  /// Tests one primitive.
  bool test(const PrimitivePointer& pointer, const PrimitiveRay& ray, uint32_t instance) {
    const uint32_t index = pointer.place() / 8, lane = pointer.place() % 8;
    switch (pointer.kind()) {
      case PointerKind::triangle:
        for_each_triangle_of(*scene_, pointer, [&](uint32_t block, uint32_t i) HWY_ATTR {
          TriangleCrossings crossings;
          take_triangles(block, cross_triangle(*scene_, block, i, ray, crossings), crossings, instance);
          return false;
        });
        return false;
      case PointerKind::sphere: {
        SphereCrossings crossings;
        take_spheres(index,
                     cross_spheres(scene_->sphere_blocks[index], ray, crossings, OneTag(), lane, lane + 1),
                     crossings, instance);
        return false;
      }
      case PointerKind::other:
        test_other_leaf(make_child(ChildKind::mixed, pointer.place()), ray, instance);
        return false;
    }
    return false;
  }

  /// To be called when all is searched: the hit's barycentric weights lack a common factor until then.
  HWY_INLINE void finish() {
    if (hit_->block_lane == kNone) return;
    const double sum = (hit_->u + hit_->v) + hit_->w;
    hit_->u /= sum;
    hit_->v /= sum;
    hit_->w /= sum;
  }

  static std::optional<double> intersect_one(const Scene& scene, PrimitiveId id, const PrimitiveRay& ray,
                                             double t_max) {
    if (id.kind() == PrimitiveKind::polygon) {
      const Polygon& polygon = scene.polygons[id.index()];
      return intersect(polygon, scene.points_of(polygon), ray.origin_vector(), ray.direction_vector(), t_max);
    }
    const Quadric& quadric = scene.quadrics[id.index()];
    return intersect(quadric, scene.planes_of(quadric), ray.origin_vector(), ray.direction_vector(), t_max);
  }

 private:
  HWY_NOINLINE void test_other_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (leaf.kind() == ChildKind::spheres) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
        SphereCrossings crossings;
        take_spheres(i, cross_spheres(scene_->sphere_blocks[i], ray, crossings), crossings, instance);
      }
    } else if (leaf.kind() == ChildKind::mixed) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
        const PrimitiveId id = scene_->leaf_primitives[i];
        if (id.kind() == PrimitiveKind::collection)
          search_inner_collection(*scene_, scene_->collections[id.index()], ray, instance, *this);
        else if (const auto t = intersect_one(*scene_, id, ray, hit_->t);
                 t && hit_->is_beaten_by(*t, instance, id))
          accept({*t, instance, id}, make_pointer(PointerKind::other, i));
      }
    }
  }

  HWY_INLINE void take_triangles(uint32_t block, uint32_t mask, const TriangleCrossings& crossings,
                                 uint32_t instance) {
    for (; mask; mask &= mask - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
      const double t = crossings.t(lane);
      if (!(t > 0 && t <= hit_->t)) continue;
      const PrimitiveId id = scene_->triangle_blocks[block].primitives[lane];
      if (hit_->is_beaten_by(t, instance, id))
        accept({t, instance, id, 8 * block + lane, crossings.u[lane], crossings.v[lane], crossings.w[lane]},
               make_pointer(PointerKind::triangle, 8 * block + lane));
    }
  }

  HWY_INLINE void take_spheres(uint32_t block, uint32_t mask, const SphereCrossings& crossings,
                               uint32_t instance) {
    for (; mask; mask &= mask - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
      const double t = crossings.t(lane);
      if (!(t > 0 && t <= hit_->t)) continue;
      const PrimitiveId id =
          make_primitive_id(PrimitiveKind::sphere, scene_->sphere_blocks[block].spheres[lane]);
      if (hit_->is_beaten_by(t, instance, id))
        accept({t, instance, id}, make_pointer(PointerKind::sphere, 8 * block + lane));
    }
  }

  void accept(const Hit& hit, PrimitivePointer place) {
    *hit_ = hit;
    place_ = place;
    t_far_ = widened(hit.t);
  }

  const Scene* scene_ = nullptr;
  Hit* hit_ = nullptr;
  PrimitivePointer place_{};  ///< of the hit
  float t_far_ = 0;
};

/// Tests leaves until anything is hit.
class AnyHit {
 public:
  static constexpr bool kNearestFirst = false;  // the sorting would cost more than it saves
  static constexpr bool kCounts = false;
  AnyHit() = default;
  AnyHit(const Scene& scene, double t_max) : scene_(&scene), t_max_(t_max), t_far_(widened(t_max)) {}
  void look_in(const Scene& scene) { scene_ = &scene; }
  float t_far() const { return t_far_; }
  bool is_over() const { return is_over_; }
  /// Of what was hit.
  HitPlace place() const { return is_over_ ? place_ : HitPlace{}; }
  static void forget_all_but_distance() {}

  /// True: the search is over.
  HWY_INLINE bool test_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (HWY_LIKELY(leaf.kind() == ChildKind::triangles)) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (test_block(i, scene_->triangle_blocks[i].vertices, ray, instance)) return true;
      return false;
    }
    return is_over_ = test_other_leaf(leaf, ray, instance);
  }

  bool test(const PrimitivePointer& pointer, const PrimitiveRay& ray, uint32_t instance) {
    const uint32_t index = pointer.place() / 8, lane = pointer.place() % 8;
    switch (pointer.kind()) {
      case PointerKind::triangle:
        return is_over_ = for_each_triangle_of(*scene_, pointer, [&](uint32_t block, uint32_t i) HWY_ATTR {
                 TriangleCrossings crossings;
                 return is_any_before_t_max(cross_triangle(*scene_, block, i, ray, crossings), crossings,
                                            PointerKind::triangle, block, instance);
               });
      case PointerKind::sphere: {
        SphereCrossings crossings;
        return is_over_ = is_any_before_t_max(
                   cross_spheres(scene_->sphere_blocks[index], ray, crossings, OneTag(), lane, lane + 1),
                   crossings, PointerKind::sphere, index, instance);
      }
      case PointerKind::other:
        return is_over_ = test_other_leaf(make_child(ChildKind::mixed, pointer.place()), ray, instance);
    }
    return false;
  }

  template <typename Number>
  HWY_INLINE bool test_block(uint32_t index, const Vertices<Number>& vertices, const PrimitiveRay& ray,
                             uint32_t instance) {
    TriangleCrossings crossings;
    return is_over_ = is_any_before_t_max(cross_triangles(vertices, ray, crossings), crossings,
                                          PointerKind::triangle, index, instance);
  }

 private:
  HWY_NOINLINE bool test_other_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (leaf.kind() == ChildKind::spheres) {
      SphereCrossings crossings;
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (is_any_before_t_max(cross_spheres(scene_->sphere_blocks[i], ray, crossings), crossings,
                                PointerKind::sphere, i, instance))
          return true;
    } else if (leaf.kind() == ChildKind::mixed) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
        const PrimitiveId id = scene_->leaf_primitives[i];
        if (id.kind() == PrimitiveKind::collection) {
          if (search_inner_collection(*scene_, scene_->collections[id.index()], ray, instance, *this))
            return true;
        } else if (const auto found = ClosestHit::intersect_one(*scene_, id, ray, t_max_);
                   found && *found < t_max_) {
          place_ = {instance, make_pointer(PointerKind::other, i)};
          return true;
        }
      }
    }
    return false;
  }
  /// Of what a ray and a block of this kind have in common.
  template <typename Crossings>
  HWY_INLINE bool is_any_before_t_max(uint32_t mask, const Crossings& crossings, PointerKind kind,
                                      uint32_t block, uint32_t instance) {
    for (; mask; mask &= mask - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
      const double t = crossings.t(lane);
      if (!(t > 0 && t < t_max_)) continue;
      place_ = {instance, make_pointer(kind, 8 * block + lane)};
      return true;
    }
    return false;
  }
  const Scene* scene_ = nullptr;
  double t_max_ = 0;
  HitPlace place_;  ///< where it is over
  float t_far_ = 0;
  bool is_over_ = false;
};

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
