// Numbers of several rays at once, a lane each, and the functions of vector.h and portable_math.h on them.
// The same operations in the same order as there, so that a lane's result is the scalar one to the last bit.
// Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_MATH_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_MATH_LANES_INL_H_
#undef RAYFARM_COMMON_MATH_LANES_INL_H_
#else
#define RAYFARM_COMMON_MATH_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include "common/math/portable_constants.h"
#include "common/math/vector.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// As many lanes as a vector has, at most the eight rays of a packet: those take one, two or four vectors.
using RealTag = hn::CappedTag<double, 8>;
using Real = hn::Vec<RealTag>;
using Truth = hn::Mask<RealTag>;
constexpr size_t kLanes = hn::MaxLanes(RealTag());
/// A number of each of a packet's eight rays, in memory.
using RealLanes = double[8];

HWY_INLINE Real real(double x) {
  return hn::Set(RealTag(), x);
}
HWY_INLINE uint32_t bits_of(Truth truth) {
  uint8_t bits[8];
  hn::StoreMaskBits(RealTag(), truth, bits);
  return bits[0];
}
constexpr uint32_t kAllLanes = (1u << kLanes) - 1;
/// Of the bits of a packet's rays those of the vector whose first lane is given.
constexpr uint32_t lanes_from(uint32_t bits, size_t lane) {
  return bits >> lane & kAllLanes;
}
/// Of bits as bits_of gives them.
HWY_INLINE Truth truth_of(uint32_t bits) {
  const auto bytes = static_cast<uint64_t>(bits);
  return hn::LoadMaskBits(RealTag(), reinterpret_cast<const uint8_t*>(&bytes));
}
HWY_INLINE Real select(Truth which, Real yes, Real no) {
  return hn::IfThenElse(which, yes, no);
}
/// std::max(0.0, x), which is 0 for no number.
HWY_INLINE Real at_least_0(Real x) {
  return hn::IfThenElseZero(x > hn::Zero(RealTag()), x);
}

struct Real2 {
  Real x, y;
};
/// Copied a component at a time: as one piece of memory it would not stay in registers.
struct Real3 {
  Real x, y, z;
  Real3() = default;
  HWY_INLINE Real3(Real x_, Real y_, Real z_) : x(x_), y(y_), z(z_) {}
  HWY_INLINE Real3(const Real3& v) : x(v.x), y(v.y), z(v.z) {}
  HWY_INLINE Real3& operator=(const Real3& v) {
    x = v.x;
    y = v.y;
    z = v.z;
    return *this;
  }
};
HWY_INLINE Real3 operator+(const Real3& a, const Real3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Real3 operator-(const Real3& a, const Real3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Real3 operator-(const Real3& a) {
  return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}
HWY_INLINE Real3 operator*(const Real3& a, const Real3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
HWY_INLINE Real3 operator*(Real a, const Real3& b) {
  return {a * b.x, a * b.y, a * b.z};
}
HWY_INLINE Real3 operator/(const Real3& a, Real b) {
  return {a.x / b, a.y / b, a.z / b};
}
HWY_INLINE Real3 all(Real x) {
  return {x, x, x};
}
HWY_INLINE Real3 all(const Vec3& v) {
  return {real(v.x), real(v.y), real(v.z)};
}
HWY_INLINE Real3 select(Truth which, const Real3& yes, const Real3& no) {
  return {select(which, yes.x, no.x), select(which, yes.y, no.y), select(which, yes.z, no.z)};
}
HWY_INLINE Real dot(const Real3& a, const Real3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Real3 cross(const Real3& a, const Real3& b) {
  return {a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y};
}
HWY_INLINE Real max_magnitude(const Real3& v) {
  return hn::Max(hn::Max(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
}
/// Those from `lane` on.
HWY_INLINE Real3 load3(const RealLanes* axes, size_t lane) {
  const RealTag d;
  return {hn::Load(d, axes[0] + lane), hn::Load(d, axes[1] + lane), hn::Load(d, axes[2] + lane)};
}
HWY_INLINE void store3(const Real3& v, RealLanes* axes, size_t lane) {
  const RealTag d;
  hn::Store(v.x, d, axes[0] + lane);
  hn::Store(v.y, d, axes[1] + lane);
  hn::Store(v.z, d, axes[2] + lane);
}

/// The scalar function, a lane after the other: for what hardly ever happens.
HWY_NOINLINE inline void normalize_one_by_one(RealLanes* axes) {
  for (size_t i = 0; i < kLanes; ++i) {
    const Vec3 v = normalized(Vec3(axes[0][i], axes[1][i], axes[2][i]));
    for (int axis = 0; axis < 3; ++axis) axes[axis][i] = v[axis];
  }
}

HWY_INLINE Real3 normalized(const Real3& v) {
  const Real square = dot(v, v);
  const Truth is_safe = hn::And(square > real(1e-280), square < real(1e280));
  if (HWY_LIKELY(hn::AllTrue(RealTag(), is_safe))) return (real(1) / hn::Sqrt(square)) * v;
  HWY_ALIGN RealLanes axes[3];
  store3(v, axes, 0);
  normalize_one_by_one(axes);
  return load3(axes, 0);
}

struct RealSineCosine {
  Real sine, cosine;
};
HWY_INLINE RealSineCosine sine_cosine(Real radians) {
  const Real k = hn::Round(radians / real(std::numbers::pi / 2));
  const Real angle = (radians - k * real(portable::kHalfPiHigh)) - k * real(portable::kHalfPiLow);
  const Real s = angle * angle;
  Real sine = real(portable::kInverseFactorials[17]), cosine = real(portable::kInverseFactorials[18]);
  for (size_t n = 15; n >= 3; n -= 2) sine = real(portable::kInverseFactorials[n]) - s * sine;
  for (size_t n = 16; n >= 4; n -= 2) cosine = real(portable::kInverseFactorials[n]) - s * cosine;
  sine = angle - angle * s * sine;
  cosine = real(1) - s * (real(0.5) - s * cosine);
  const Real quadrant = k - real(4) * hn::Floor(k * real(0.25));  // 0 to 3
  const Truth is_odd = hn::Or(quadrant == real(1), quadrant == real(3));
  const Real if_odd = select(is_odd, cosine, sine), other = select(is_odd, sine, cosine);
  return {select(quadrant > real(1.5), hn::Neg(if_odd), if_odd),
          select(hn::Or(quadrant == real(1), quadrant == real(2)), hn::Neg(other), other)};
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // RAYFARM_COMMON_MATH_LANES_INL_H_
