// The maps of warps.h for several points at once, by the same operations. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_SAMPLING_WARPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_SAMPLING_WARPS_INL_H_
#undef RAYFARM_COMMON_SAMPLING_WARPS_INL_H_
#else
#define RAYFARM_COMMON_SAMPLING_WARPS_INL_H_
#endif

#include "common/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE Real2 sample_disk(const Real2& u) {
  using std::numbers::pi;
  const Real x = real(2) * u.x - real(1), y = real(2) * u.y - real(1);
  const Truth is_x = hn::Abs(x) > hn::Abs(y);
  const Real r = select(is_x, x, y);
  const Real part = real(pi / 4) * (select(is_x, y, x) / r);
  const RealSineCosine s = sine_cosine(select(is_x, part, real(pi / 2) - part));
  const Truth is_center = r == hn::Zero(RealTag());
  return {hn::IfThenZeroElse(is_center, r * s.cosine), hn::IfThenZeroElse(is_center, r * s.sine)};
}

HWY_INLINE Real3 sample_cosine(const Real2& u) {
  const Real2 d = sample_disk(u);
  return {d.x, d.y, hn::Sqrt(at_least_0(real(1) - d.x * d.x - d.y * d.y))};
}
HWY_INLINE Real cosine_pdf(Real cosine) {
  return at_least_0(cosine) / real(std::numbers::pi);
}

HWY_INLINE Real3 sample_cone(const Real2& u, Real one_minus_cosine) {
  const Real height = one_minus_cosine * u.x;
  const Real sine = hn::Sqrt(height * (real(2) - height));
  const RealSineCosine azimuth = sine_cosine(real(2 * std::numbers::pi) * u.y);
  return {sine * azimuth.cosine, sine * azimuth.sine, real(1) - height};
}
HWY_INLINE Real cone_pdf(Real one_minus_cosine) {
  return real(1) / (real(2 * std::numbers::pi) * one_minus_cosine);
}

HWY_INLINE Real2 sample_triangle(const Real2& u) {
  const Real root = hn::Sqrt(real(1) - u.x);
  return {(real(1) - u.y) * root, u.y * root};
}

/// Frame(n).to_world(local).
HWY_INLINE Real3 to_world(const Real3& n, const Real3& local) {
  const Real sign = hn::CopySign(real(1), n.z), a = real(-1) / (sign + n.z), b = n.x * n.y * a;
  const Real3 tangent{real(1) + sign * n.x * n.x * a, sign * b, hn::Neg(sign) * n.x},
      bitangent{b, sign + n.y * n.y * a, hn::Neg(n.y)};
  return local.x * tangent + local.y * bitangent + local.z * n;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // RAYFARM_COMMON_SAMPLING_WARPS_INL_H_
