// Where the lines of rays meet primitives, in double: blocks of eight, and single ones of them. Compiled once
// for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_CROSSINGS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_CROSSINGS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_CROSSINGS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_CROSSINGS_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>

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
template <typename Number, class D = hn::CappedTag<double, std::is_same_v<Number, float> ? 4 : 8>>
HWY_INLINE uint32_t cross_triangles(const Vertices<Number>& vertices, const PrimitiveRay& ray,
                                    TriangleCrossings& crossings, D d = {}, size_t begin = 0,
                                    size_t end = 8) {
  [[maybe_unused]] const hn::Rebind<float, decltype(d)> f;
  const auto zero = hn::Zero(d);
  uint32_t mask = 0;
  for (size_t lane = begin; lane < end; lane += hn::Lanes(d)) {
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
template <class D = hn::CappedTag<double, 4>>
HWY_INLINE uint32_t cross_spheres(const SphereBlock& block, const PrimitiveRay& ray,
                                  SphereCrossings& crossings, D d = {}, size_t begin = 0, size_t end = 8) {
  uint32_t mask = 0;
  const auto dx = hn::Set(d, ray.direction[0]), dy = hn::Set(d, ray.direction[1]),
             dz = hn::Set(d, ray.direction[2]);
  const auto a = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  crossings.a = hn::GetLane(a);
  for (size_t lane = begin; lane < end; lane += hn::Lanes(d)) {
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

using OneTag = hn::CappedTag<double, 1>;

HWY_INLINE uint32_t cross_triangle(const Scene& scene, uint32_t block, uint32_t lane, const PrimitiveRay& ray,
                                   TriangleCrossings& crossings) {
  return cross_triangles(scene.triangle_blocks[block].vertices, ray, crossings, OneTag(), lane, lane + 1);
}

/// Calls visit(block, lane) for the triangles that a primitive was cut into, until it returns true.
template <typename Visit>
HWY_INLINE bool for_each_triangle_of(const Scene& scene, const PrimitivePointer& pointer, Visit visit) {
  const auto id_at = [&](uint32_t place)
                         HWY_ATTR { return scene.triangle_blocks[place / 8].primitives[place % 8]; };
  const PrimitiveId id = id_at(pointer.place());
  for (uint32_t i = pointer.place(); i / 8 < scene.triangle_blocks.size() && id_at(i) == id; ++i)
    if (visit(i / 8, i % 8)) return true;
  return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
