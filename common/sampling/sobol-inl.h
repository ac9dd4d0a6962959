// Sobol points of several samples at once: what sampler.cpp computes for one. Compiled once for each SIMD
// target.
#if defined(RAYFARM_COMMON_SAMPLING_SOBOL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_SAMPLING_SOBOL_INL_H_
#undef RAYFARM_COMMON_SAMPLING_SOBOL_INL_H_
#else
#define RAYFARM_COMMON_SAMPLING_SOBOL_INL_H_
#endif

#include "common/math/lanes-inl.h"
#include "common/sampling/sampler.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using WordTag = hn::Rebind<uint64_t, RealTag>;
using HalfWordTag = hn::Rebind<uint32_t, RealTag>;
using Words = hn::Vec<WordTag>;          ///< 64 bits a lane
using HalfWords = hn::Vec<HalfWordTag>;  ///< 32 bits a lane

HWY_INLINE Words times(Words a, uint64_t factor) {
#if HWY_TARGET == HWY_SCALAR || (HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3)
  return hn::Mul(a, hn::Set(WordTag(), factor));
#else
  const hn::Repartition<uint32_t, WordTag> halves;
  const auto low = hn::BitCast(halves, a), high = hn::BitCast(halves, hn::ShiftRight<32>(a));
  const auto b_low = hn::BitCast(halves, hn::Set(WordTag(), factor & 0xffffffffu)),
             b_high = hn::BitCast(halves, hn::Set(WordTag(), factor >> 32));
  return hn::MulEven(low, b_low) + hn::ShiftLeft<32>(hn::MulEven(low, b_high) + hn::MulEven(high, b_low));
#endif
}

/// mix_bits.
HWY_INLINE Words mixed(Words x) {
  x = x + hn::Set(WordTag(), 0x9e3779b97f4a7c15ull);
  x = times(hn::Xor(x, hn::ShiftRight<30>(x)), 0xbf58476d1ce4e5b9ull);
  x = times(hn::Xor(x, hn::ShiftRight<27>(x)), 0x94d049bb133111ebull);
  return hn::Xor(x, hn::ShiftRight<31>(x));
}

HWY_INLINE HalfWords half_words(uint32_t x) {
  return hn::Set(HalfWordTag(), x);
}

HWY_INLINE HalfWords reversed_bits(HalfWords x) {
  x = hn::Or(hn::ShiftRight<16>(x), hn::ShiftLeft<16>(x));
  x = hn::Or(hn::And(hn::ShiftRight<8>(x), half_words(0x00ff00ffu)),
             hn::ShiftLeft<8>(hn::And(x, half_words(0x00ff00ffu))));
  x = hn::Or(hn::And(hn::ShiftRight<4>(x), half_words(0x0f0f0f0fu)),
             hn::ShiftLeft<4>(hn::And(x, half_words(0x0f0f0f0fu))));
  x = hn::Or(hn::And(hn::ShiftRight<2>(x), half_words(0x33333333u)),
             hn::ShiftLeft<2>(hn::And(x, half_words(0x33333333u))));
  return hn::Or(hn::And(hn::ShiftRight<1>(x), half_words(0x55555555u)),
                hn::ShiftLeft<1>(hn::And(x, half_words(0x55555555u))));
}

HWY_INLINE HalfWords owen_scrambled_reversed(HalfWords x, HalfWords seed) {
  x = x + seed;
  x = hn::Xor(x, x * half_words(0x6c50b47cu));
  x = hn::Xor(x, x * half_words(0xb82f1e52u));
  x = hn::Xor(x, x * half_words(0xc7afe638u));
  return hn::Xor(x, x * half_words(0x8d22f6e6u));
}

HWY_INLINE HalfWords sobol_second_reversed(HalfWords index) {
  index = hn::Xor(index, hn::ShiftRight<16>(index));
  index = hn::Xor(index, hn::ShiftRight<8>(hn::And(index, half_words(0xff00ff00u))));
  index = hn::Xor(index, hn::ShiftRight<4>(hn::And(index, half_words(0xf0f0f0f0u))));
  index = hn::Xor(index, hn::ShiftRight<2>(hn::And(index, half_words(0xccccccccu))));
  return hn::Xor(index, hn::ShiftRight<1>(hn::And(index, half_words(0xaaaaaaaau))));
}

/// x / 2^32
HWY_INLINE Real in_unit_interval(HalfWords x) {
  constexpr double k2To52 = 0x1p52;  // whose last bits are x, once they are put there
  const RealTag d;
  const Words bits = hn::Or(hn::PromoteTo(WordTag(), x), hn::BitCast(WordTag(), hn::Set(d, k2To52)));
  return (hn::BitCast(d, bits) - real(k2To52)) * real(0x1p-32);
}

/// The points of samples whose pixels and numbers are given as the Sampler has them, in one dimension.
HWY_INLINE Real2 sobol_points(Words pixel_keys, HalfWords reversed_samples, uint64_t frame_and_dimension) {
  const Words keys = mixed(mixed(hn::Xor(pixel_keys, hn::Set(WordTag(), frame_and_dimension)))),
              more = mixed(keys);
  const HalfWordTag narrow;
  const HalfWords index =
      reversed_bits(owen_scrambled_reversed(reversed_samples, hn::TruncateTo(narrow, more)));
  const HalfWords x = owen_scrambled_reversed(index, hn::TruncateTo(narrow, keys)),
                  y = owen_scrambled_reversed(sobol_second_reversed(index),
                                              hn::TruncateTo(narrow, hn::ShiftRight<32>(keys)));
  return {in_unit_interval(reversed_bits(x)), in_unit_interval(reversed_bits(y))};
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // RAYFARM_COMMON_SAMPLING_SOBOL_INL_H_
