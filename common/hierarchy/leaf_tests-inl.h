// Primitives against rays, in double, and the two searches: for the closest hit and for any. Compiled once
// for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_LEAF_TESTS_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <optional>

#include "common/hierarchy/rays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A block's vertices: [vertex][axis][lane].
template <typename Number>
using Vertices = std::array<std::array<std::array<Number, 8>, 3>, 3>;

HWY_INLINE void convert(const Vertices<float>& from, Vertices<double>& to) {
  const DoubleTag d;
  const hn::Rebind<float, DoubleTag> f;
  for (size_t vertex = 0; vertex < 3; ++vertex)
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t lane = 0; lane < 8; lane += hn::Lanes(d))
        hn::Store(hn::PromoteTo(d, hn::Load(f, &from[vertex][axis][lane])), d, &to[vertex][axis][lane]);
}

/// What a ray and a block's triangles have in common, where the ray's line meets them.
struct TriangleCrossings {
  HWY_ALIGN double u[8], v[8], w[8];  ///< barycentric weights times a common factor
  HWY_ALIGN double scaled_t[8];       ///< the distance times the same

  /// Infinite or NaN where the triangle is seen edge-on.
  double t(size_t lane) const { return scaled_t[lane] / (u[lane] + v[lane] + w[lane]); }
};

/// Bits of the lanes in which the ray's line meets a triangle. The distances are divided one by one, as they
/// are asked for: seldom more than one triangle is met, and eight quotients take three times as long as one.
/// The vertices may have been converted before, for several rays. One ray's test is over sooner in halves: it
/// waits for results more than for a free unit.
template <typename Number>
HWY_INLINE uint32_t cross_triangles(const Vertices<Number>& vertices, const PrimitiveRay& ray,
                                    TriangleCrossings& crossings) {
  const hn::CappedTag<double, std::is_same_v<Number, float> ? 4 : 8> d;
  [[maybe_unused]] const hn::Rebind<float, decltype(d)> f;
  const auto zero = hn::Zero(d);
  uint32_t mask = 0;
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    const auto coordinate = [&](size_t vertex, size_t axis) HWY_ATTR {
      const Number* const numbers = &vertices[vertex][axis][lane];
      if constexpr (std::is_same_v<Number, float>)
        return hn::Sub(hn::PromoteTo(d, hn::Load(f, numbers)), hn::Set(d, ray.origin[axis]));
      else
        return hn::Sub(hn::Load(d, numbers), hn::Set(d, ray.origin[axis]));
    };
    const auto az = coordinate(0, ray.kz), bz = coordinate(1, ray.kz), cz = coordinate(2, ray.kz);
    const auto sx = hn::Set(d, ray.shear_x), sy = hn::Set(d, ray.shear_y);
    const auto ax = hn::Sub(coordinate(0, ray.kx), hn::Mul(sx, az));
    const auto ay = hn::Sub(coordinate(0, ray.ky), hn::Mul(sy, az));
    const auto bx = hn::Sub(coordinate(1, ray.kx), hn::Mul(sx, bz));
    const auto by = hn::Sub(coordinate(1, ray.ky), hn::Mul(sy, bz));
    const auto cx = hn::Sub(coordinate(2, ray.kx), hn::Mul(sx, cz));
    const auto cy = hn::Sub(coordinate(2, ray.ky), hn::Mul(sy, cz));
    // An edge's two triangles compute the same products, so no ray slips between them.
    const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    // Where one is NaN, so is t.
    const auto none_negative = hn::Ge(hn::Min(hn::Min(u, v), w), zero);
    const auto none_positive = hn::Le(hn::Max(hn::Max(u, v), w), zero);
    const auto inside = hn::Or(none_negative, none_positive);
    if (hn::AllFalse(d, inside)) continue;
    const auto scaled_t =
        hn::Mul(hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz)), hn::Set(d, ray.shear_z));
    hn::Store(u, d, crossings.u + lane);
    hn::Store(v, d, crossings.v + lane);
    hn::Store(w, d, crossings.w + lane);
    hn::Store(scaled_t, d, crossings.scaled_t + lane);
    mask |= bits_of(d, inside) << lane;
  }
  return mask;
}

/// Where a ray's line enters spheres: roots of the quadratic equation of t.
struct SphereCrossings {
  double a;
  HWY_ALIGN double b[8], c[8], discriminant[8];

  /// The smallest t > 0, if there is one.
  double t(size_t lane) const {
    const bool is_approaching = b[lane] < 0;
    const double root = std::sqrt(discriminant[lane] * a);
    const double q = (is_approaching ? root : -root) - b[lane];
    const double first = is_approaching ? c[lane] / q : q / a;
    return first > 0 ? first : is_approaching ? q / a : c[lane] / q;
  }
};

/// Bits of the lanes in which the ray's line meets a sphere. Roots are taken one by one, as they are asked
/// for, like triangles' distances.
HWY_INLINE uint32_t cross_spheres(const SphereBlock& block, const PrimitiveRay& ray,
                                  SphereCrossings& crossings) {
  const hn::CappedTag<double, 4> d;
  uint32_t mask = 0;
  const auto dx = hn::Set(d, ray.direction[0]), dy = hn::Set(d, ray.direction[1]),
             dz = hn::Set(d, ray.direction[2]);
  const auto a = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  crossings.a = hn::GetLane(a);
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    const auto ox = hn::Sub(hn::Set(d, ray.origin[0]), hn::Load(d, &block.center[0][lane]));
    const auto oy = hn::Sub(hn::Set(d, ray.origin[1]), hn::Load(d, &block.center[1][lane]));
    const auto oz = hn::Sub(hn::Set(d, ray.origin[2]), hn::Load(d, &block.center[2][lane]));
    const auto r = hn::Load(d, &block.radius[lane]);
    const auto r2 = hn::Mul(r, r);
    const auto b = hn::Add(hn::Add(hn::Mul(ox, dx), hn::Mul(oy, dy)), hn::Mul(oz, dz));
    // The discriminant from the distance between centre and line, which loses no digits for far, small
    // spheres (Haines, Günther, Akenine-Möller, "Precision improvements for ray/sphere intersection", 2019).
    const auto closest = hn::Div(b, a);
    const auto px = hn::Sub(ox, hn::Mul(closest, dx));
    const auto py = hn::Sub(oy, hn::Mul(closest, dy));
    const auto pz = hn::Sub(oz, hn::Mul(closest, dz));
    const auto discriminant =
        hn::Sub(r2, hn::Add(hn::Add(hn::Mul(px, px), hn::Mul(py, py)), hn::Mul(pz, pz)));
    const auto meets = hn::Ge(discriminant, hn::Zero(d));
    if (hn::AllFalse(d, meets)) continue;
    hn::Store(b, d, crossings.b + lane);
    hn::Store(hn::Sub(hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz)), r2), d,
              crossings.c + lane);
    hn::Store(discriminant, d, crossings.discriminant + lane);
    mask |= bits_of(d, meets) << lane;
  }
  return mask;
}

/// Tests leaves and keeps the closest hit.
class ClosestHit {
 public:
  static constexpr bool kNearestFirst = true;
  static constexpr bool kCounts = false;
  ClosestHit() = default;
  /// `hit.t` bounds the search.
  ClosestHit(const Scene& scene, Hit& hit) : scene_(&scene), hit_(&hit), t_far_(widened(hit.t)) {}
  /// Boxes behind this distance need no visit.
  float t_far() const { return t_far_; }
  static bool is_over() { return false; }

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
    for (uint32_t mask = cross_triangles(vertices, ray, crossings); mask; mask &= mask - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
      const double t = crossings.t(lane);
      if (!(t > 0 && t <= hit_->t)) continue;
      const PrimitiveId id = scene_->triangle_blocks[index].primitives[lane];
      if (hit_->is_beaten_by(t, instance, id))
        accept({t, instance, id, 8 * index + lane, crossings.u[lane], crossings.v[lane], crossings.w[lane]});
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
        const SphereBlock& block = scene_->sphere_blocks[i];
        SphereCrossings crossings;
        for (uint32_t mask = cross_spheres(block, ray, crossings); mask; mask &= mask - 1) {
          const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
          const double t = crossings.t(lane);
          if (!(t > 0 && t <= hit_->t)) continue;
          const PrimitiveId id = make_primitive_id(PrimitiveKind::sphere, block.spheres[lane]);
          if (hit_->is_beaten_by(t, instance, id)) accept({t, instance, id});
        }
      }
    } else if (leaf.kind() == ChildKind::mixed) {
      for (const PrimitiveId id : scene_->leaf_primitives.subspan(leaf.first, leaf.count()))
        if (const auto t = intersect_one(*scene_, id, ray, hit_->t);
            t && hit_->is_beaten_by(*t, instance, id))
          accept({*t, instance, id});
    }
  }

  void accept(const Hit& hit) {
    *hit_ = hit;
    t_far_ = widened(hit.t);
  }

  const Scene* scene_ = nullptr;
  Hit* hit_ = nullptr;
  float t_far_ = 0;
};

/// Tests leaves until anything is hit.
class AnyHit {
 public:
  static constexpr bool kNearestFirst = false;  // the sorting would cost more than it saves
  static constexpr bool kCounts = false;
  AnyHit() = default;
  AnyHit(const Scene& scene, double t_max) : scene_(&scene), t_max_(t_max), t_far_(widened(t_max)) {}
  float t_far() const { return t_far_; }
  bool is_over() const { return is_over_; }

  HWY_INLINE bool test_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (HWY_LIKELY(leaf.kind() == ChildKind::triangles)) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (test_block(i, scene_->triangle_blocks[i].vertices, ray, instance)) return true;
      return false;
    }
    return is_over_ = test_other_leaf(leaf, ray);
  }

  template <typename Number>
  HWY_INLINE bool test_block(uint32_t /*index*/, const Vertices<Number>& vertices, const PrimitiveRay& ray,
                             uint32_t /*instance*/) {
    TriangleCrossings crossings;
    return is_over_ = is_any_before_t_max(cross_triangles(vertices, ray, crossings), crossings);
  }

 private:
  HWY_NOINLINE bool test_other_leaf(const ChildRef& leaf, const PrimitiveRay& ray) const {
    if (leaf.kind() == ChildKind::spheres) {
      SphereCrossings crossings;
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (is_any_before_t_max(cross_spheres(scene_->sphere_blocks[i], ray, crossings), crossings))
          return true;
    } else if (leaf.kind() == ChildKind::mixed) {
      for (const PrimitiveId id : scene_->leaf_primitives.subspan(leaf.first, leaf.count()))
        if (const auto found = ClosestHit::intersect_one(*scene_, id, ray, t_max_); found && *found < t_max_)
          return true;
    }
    return false;
  }
  template <typename Crossings>
  HWY_INLINE bool is_any_before_t_max(uint32_t mask, const Crossings& crossings) const {
    for (; mask; mask &= mask - 1) {
      const double t = crossings.t(static_cast<size_t>(std::countr_zero(mask)));
      if (t > 0 && t < t_max_) return true;
    }
    return false;
  }
  const Scene* scene_ = nullptr;
  double t_max_ = 0;
  float t_far_ = 0;
  bool is_over_ = false;
};

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
