#pragma once
// For tests that compare lanes with single numbers, to the last bit, on every SIMD target.
#include <gtest/gtest.h>

#include <bit>

#include "common/hierarchy/traverser.h"

namespace rayfarm::test {

/// Calls check() on every target of this machine.
template <typename Check>
void on_every_target(Check check) {
  for (const std::string& target : simd_targets()) {
    SCOPED_TRACE(target);
    force_simd_target(target);
    check();
  }
  force_simd_target("");
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
}
inline bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

}  // namespace rayfarm::test
