// portable_pow in lanes: the same operations in the same order as in portable_math.cpp, so the same results
// to the last bit. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_MATH_PORTABLE_POW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_MATH_PORTABLE_POW_INL_H_
#undef RAYFARM_COMMON_MATH_PORTABLE_POW_INL_H_
#else
#define RAYFARM_COMMON_MATH_PORTABLE_POW_INL_H_
#endif

#include <limits>

#include "common/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

struct RealPair {
  Real high, low;
};

/// ln(x) of normal numbers as an unevaluated sum.
HWY_INLINE RealPair split_log(Real x) {
  const RealTag d;
  const hn::RebindToUnsigned<RealTag> words;
  // Those below the normal numbers are multiplied by 2^54 first.
  const Truth is_tiny = x < real(std::numeric_limits<double>::min());
  x = select(is_tiny, x * real(18014398509481984.0), x);
  const auto bits = hn::BitCast(words, x);
  // An integer below 2^52 as a double: put into the last bits of 2^52.
  constexpr uint64_t k2To52 = 0x4330000000000000ull;
  Real exponent = hn::BitCast(d, hn::Or(hn::ShiftRight<52>(bits), hn::Set(words, k2To52))) - real(0x1p52);
  exponent = exponent - real(1023) - select(is_tiny, real(54), real(0));
  Real m = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(words, uint64_t{0x000fffffffffffff})),
                                 hn::Set(words, uint64_t{0x3ff0000000000000})));
  const Truth is_large = m > real(std::numbers::sqrt2);
  m = select(is_large, m * real(0.5), m);
  exponent = select(is_large, exponent + real(1), exponent);
  const Real f = (m - real(1)) / (m + real(1));
  const Real s = f * f;
  Real sum = real(0);
  for (size_t n = 21; n >= 3; n -= 2) sum = real(portable::kInverses[n]) + s * sum;
  const Real high = exponent * real(portable::kLn2High);
  const Real leading = real(2) * f;
  const Real total = high + leading;
  const Real rest =
      select(hn::Abs(high) >= hn::Abs(leading), leading - (total - high), high - (total - leading));
  return {total, rest + (real(2) * f * s * sum + exponent * real(portable::kLn2Low))};
}

/// 2^e of a whole number in [-1022, 1023].
HWY_INLINE Real power_of_two(Real e) {
  const RealTag d;
  const hn::RebindToUnsigned<RealTag> words;
  return hn::BitCast(d, hn::ShiftLeft<52>(hn::BitCast(words, e + real(0x1p52 + 1023))));
}

HWY_INLINE Real exp_of_sum(Real high, Real low) {
  const Real x = high + low;
  const Real k = hn::Round(x / real(std::numbers::ln2));
  const Real r = ((high - k * real(portable::kLn2High)) - k * real(portable::kLn2Low)) + low;
  Real sum = real(portable::kInverseFactorials[16]);
  for (size_t n = 16; n-- > 0;) sum = real(portable::kInverseFactorials[n]) + r * sum;
  const Real first = hn::Trunc(k * real(0.5)), second = k - first;
  Real result = sum * power_of_two(first) * power_of_two(second);
  result = select(x > real(709.78), real(std::numeric_limits<double>::infinity()), result);
  return select(x < real(-745.2), real(0), result);
}

HWY_INLINE RealPair split_number(Real v) {
  const Real c = real(134217729.0) * v;
  const Real high = c - (c - v);
  return {high, v - high};
}

/// portable_pow.
HWY_INLINE Real pow(Real base, Real exponent) {
  const Real infinity = real(std::numeric_limits<double>::infinity()), none = real(0);
  const RealPair l = split_log(base);
  const Real product = l.high * exponent;
  const RealPair a = split_number(l.high), b = split_number(exponent);
  const Real error = ((a.high * b.high - product) + a.high * b.low + a.low * b.high) + a.low * b.low;
  Real result = exp_of_sum(product, error + l.low * exponent);
  result = select(hn::Abs(product) > real(800), select(product > none, infinity, none), result);
  result = select(base > none, result, select(exponent > none, none, infinity));
  return select(hn::Or(exponent == none, base == real(1)), real(1), result);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // RAYFARM_COMMON_MATH_PORTABLE_POW_INL_H_
