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
  const HalfFloatTag f;
  for (size_t vertex = 0; vertex < 3; ++vertex)
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t lane = 0; lane < 8; lane += hn::Lanes(d))
        hn::Store(hn::PromoteTo(d, hn::Load(f, &from[vertex][axis][lane])), d, &to[vertex][axis][lane]);
}

/// Bits of the lanes in which the ray meets a triangle at 0 < t <= t_max, with t and the barycentric weights
/// times a common factor. The vertices may have been converted before, for several rays.
template <typename Number>
HWY_INLINE uint32_t test_triangles(const Vertices<Number>& vertices, const PrimitiveRay& ray, double t_max,
                                   double* HWY_RESTRICT out_t, double* HWY_RESTRICT out_u,
                                   double* HWY_RESTRICT out_v, double* HWY_RESTRICT out_w) {
  const DoubleTag d;
  [[maybe_unused]] const HalfFloatTag f;
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
    const auto none_negative = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Ge(w, zero));
    const auto none_positive = hn::And(hn::And(hn::Le(u, zero), hn::Le(v, zero)), hn::Le(w, zero));
    const auto inside = hn::Or(none_negative, none_positive);
    if (hn::AllFalse(d, inside)) continue;
    const auto determinant = hn::Add(hn::Add(u, v), w);
    const auto scaled_t =
        hn::Mul(hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz)), hn::Set(d, ray.shear_z));
    const auto t = hn::Div(scaled_t, determinant);
    const auto in_range = hn::And(hn::Gt(t, zero), hn::Le(t, hn::Set(d, t_max)));
    const auto accepted = hn::And(hn::And(inside, in_range), hn::Ne(determinant, zero));
    if (hn::AllFalse(d, accepted)) continue;
    hn::Store(t, d, out_t + lane);
    hn::Store(u, d, out_u + lane);
    hn::Store(v, d, out_v + lane);
    hn::Store(w, d, out_w + lane);
    mask |= bits_of(d, accepted) << lane;
  }
  return mask;
}

/// Bits of the lanes in which the ray meets a sphere at 0 < t <= t_max, with the smallest such t.
HWY_INLINE uint32_t test_spheres(const SphereBlock& block, const PrimitiveRay& ray, double t_max,
                                 double* HWY_RESTRICT out_t) {
  const DoubleTag d;
  const auto zero = hn::Zero(d);
  uint32_t mask = 0;
  const auto dx = hn::Set(d, ray.direction[0]), dy = hn::Set(d, ray.direction[1]),
             dz = hn::Set(d, ray.direction[2]);
  const auto a = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
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
    const auto meets = hn::Ge(discriminant, zero);
    if (hn::AllFalse(d, meets)) continue;
    const auto root = hn::Sqrt(hn::Mul(hn::Max(discriminant, zero), a));
    const auto c = hn::Sub(hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz)), r2);
    const auto approaching = hn::Lt(b, zero);
    const auto q = hn::Sub(hn::IfThenElse(approaching, root, hn::Neg(root)), b);
    const auto c_over_q = hn::Div(c, q), q_over_a = hn::Div(q, a);
    const auto first = hn::IfThenElse(approaching, c_over_q, q_over_a);
    const auto second = hn::IfThenElse(approaching, q_over_a, c_over_q);
    const auto t = hn::IfThenElse(hn::Gt(first, zero), first, second);
    const auto accepted = hn::And(meets, hn::And(hn::Gt(t, zero), hn::Le(t, hn::Set(d, t_max))));
    if (hn::AllFalse(d, accepted)) continue;
    hn::Store(t, d, out_t + lane);
    mask |= bits_of(d, accepted) << lane;
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
    HWY_ALIGN double t[8], u[8], v[8], w[8];
    for (uint32_t mask = test_triangles(vertices, ray, hit_->t, t, u, v, w); mask; mask &= mask - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
      const PrimitiveId id = scene_->triangle_blocks[index].primitives[lane];
      if (hit_->is_beaten_by(t[lane], instance, id)) {
        const double determinant = (u[lane] + v[lane]) + w[lane];
        accept({t[lane], instance, id, 8 * index + lane, u[lane] / determinant, v[lane] / determinant,
                w[lane] / determinant});
      }
    }
    return false;
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
        HWY_ALIGN double t[8];
        for (uint32_t mask = test_spheres(block, ray, hit_->t, t); mask; mask &= mask - 1) {
          const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
          const PrimitiveId id = make_primitive_id(PrimitiveKind::sphere, block.spheres[lane]);
          if (hit_->is_beaten_by(t[lane], instance, id)) accept({t[lane], instance, id});
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
    HWY_ALIGN double t[8], u[8], v[8], w[8];
    return is_over_ = before_t_max(test_triangles(vertices, ray, t_max_, t, u, v, w), t);
  }

 private:
  HWY_NOINLINE bool test_other_leaf(const ChildRef& leaf, const PrimitiveRay& ray) const {
    if (leaf.kind() == ChildKind::spheres) {
      HWY_ALIGN double t[8];
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (before_t_max(test_spheres(scene_->sphere_blocks[i], ray, t_max_, t), t)) return true;
    } else if (leaf.kind() == ChildKind::mixed) {
      for (const PrimitiveId id : scene_->leaf_primitives.subspan(leaf.first, leaf.count()))
        if (const auto found = ClosestHit::intersect_one(*scene_, id, ray, t_max_); found && *found < t_max_)
          return true;
    }
    return false;
  }
  bool before_t_max(uint32_t mask, const double* t) const {
    for (; mask; mask &= mask - 1)
      if (t[std::countr_zero(mask)] < t_max_) return true;
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
