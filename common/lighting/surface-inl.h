// Surface::ray_origin for several rays at once. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_LIGHTING_SURFACE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_LIGHTING_SURFACE_INL_H_
#undef RAYFARM_COMMON_LIGHTING_SURFACE_INL_H_
#else
#define RAYFARM_COMMON_LIGHTING_SURFACE_INL_H_
#endif

#include "common/lighting/surface.h"
#include "common/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Where rays in `direction` start.
HWY_INLINE Real3 ray_origin(const Real3& p, const Real3& geometric_normal, Real offset,
                            const Real3& direction) {
  const Truth is_outside = dot(geometric_normal, direction) >= hn::Zero(RealTag());
  return p + select(is_outside, offset, hn::Neg(offset)) * geometric_normal;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
