// Directions and Fresnel's equations of several interactions at once, by the operations of scattering.h and
// fresnel.h. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_MATERIALS_SCATTERING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_MATERIALS_SCATTERING_INL_H_
#undef RAYFARM_COMMON_MATERIALS_SCATTERING_INL_H_
#else
#define RAYFARM_COMMON_MATERIALS_SCATTERING_INL_H_
#endif

#include "common/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE Real luminance(const Real3& c) {
  return real(0.2126) * c.x + real(0.7152) * c.y + real(0.0722) * c.z;
}

HWY_INLINE Real3 mirrored(const Real3& to_viewer, const Real3& normal) {
  return normalized(real(2) * dot(to_viewer, normal) * normal - to_viewer);
}
/// `is_total` gets where all is reflected; the direction there means nothing.
HWY_INLINE Real3 refracted(const Real3& to_viewer, const Real3& normal, Real index_ratio, Truth& is_total) {
  const Real cosine = dot(to_viewer, normal), eta = real(1) / index_ratio;
  const Real behind2 = real(1) - eta * eta * (real(1) - cosine * cosine);
  is_total = behind2 < hn::Zero(RealTag());
  return normalized((eta * cosine - hn::Sqrt(at_least_0(behind2))) * normal - eta * to_viewer);
}

HWY_INLINE Real fresnel_dielectric(Real cosine, Real eta) {
  const Real sine2 = (real(1) - cosine * cosine) / (eta * eta);
  const Real behind = hn::Sqrt(at_least_0(real(1) - sine2));
  const Real parallel = (eta * cosine - behind) / (eta * cosine + behind);
  const Real perpendicular = (cosine - eta * behind) / (cosine + eta * behind);
  return select(sine2 >= real(1), real(1), real(0.5) * (parallel * parallel + perpendicular * perpendicular));
}

HWY_INLINE Real fresnel_conductor(Real cosine, Real n, Real k) {
  const Real cosine2 = cosine * cosine, sine2 = real(1) - cosine2;
  const Real t = n * n - k * k - sine2;
  const Real a2_plus_b2 = hn::Sqrt(t * t + real(4) * n * n * k * k);
  const Real a = hn::Sqrt(at_least_0(real(0.5) * (a2_plus_b2 + t)));
  const Real cross = real(2) * a * cosine;
  const Real perpendicular = (a2_plus_b2 + cosine2 - cross) / (a2_plus_b2 + cosine2 + cross);
  const Real parallel = perpendicular * (cosine2 * a2_plus_b2 + sine2 * sine2 - cross * sine2) /
                        (cosine2 * a2_plus_b2 + sine2 * sine2 + cross * sine2);
  return real(0.5) * (parallel + perpendicular);
}
HWY_INLINE Real3 fresnel_conductor(Real cosine, const Real3& n, const Real3& k) {
  return {fresnel_conductor(cosine, n.x, k.x), fresnel_conductor(cosine, n.y, k.y),
          fresnel_conductor(cosine, n.z, k.z)};
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // RAYFARM_COMMON_MATERIALS_SCATTERING_INL_H_
