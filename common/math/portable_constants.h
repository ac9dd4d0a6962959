#pragma once
// The numbers that portable_math.h works with, one at a time or in lanes.
#include <array>
#include <cstddef>

namespace rayfarm::portable {

// pi/2 in two parts: the first has so few bits that its product with a small integer is exact.
inline constexpr double kHalfPiHigh = 1.57079632673412561417e+00;
inline constexpr double kHalfPiLow = 6.07710050650619224932e-11;

// ln 2 in two parts, as pi/2.
inline constexpr double kLn2High = 6.93147180369123816490e-01;
inline constexpr double kLn2Low = 1.90821492927058770002e-10;

/// 1 / n! for n up to 18.
inline constexpr std::array<double, 19> kInverseFactorials = [] {
  std::array<double, 19> table{};
  double factorial = 1;
  for (int n = 0; n < 19; ++n) {
    if (n > 0) factorial *= n;
    table[static_cast<size_t>(n)] = 1 / factorial;
  }
  return table;
}();

/// 1 / n for n up to 21.
inline constexpr std::array<double, 22> kInverses = [] {
  std::array<double, 22> table{};
  for (size_t n = 1; n < table.size(); ++n) table[n] = 1.0 / static_cast<double>(n);
  return table;
}();

}  // namespace rayfarm::portable
