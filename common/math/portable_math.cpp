#include "common/math/portable_math.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "common/math/portable_constants.h"

namespace rayfarm {
namespace {

using namespace portable;

double taylor_sin(double x) {  // |x| <= pi/4; the first omitted term is below 2e-18
  const double s = x * x;
  double sum = kInverseFactorials[17];
  for (size_t n = 15; n >= 3; n -= 2) sum = kInverseFactorials[n] - s * sum;
  return x - x * s * sum;
}

double taylor_cos(double x) {
  const double s = x * x;
  double sum = kInverseFactorials[18];
  for (size_t n = 16; n >= 4; n -= 2) sum = kInverseFactorials[n] - s * sum;
  return 1.0 - s * (0.5 - s * sum);
}

struct ReducedAngle {
  double angle;  // in [-pi/4, pi/4]
  int quadrant;
};

ReducedAngle reduce(double radians) {
  const double k = std::nearbyint(radians / (std::numbers::pi / 2));
  const double angle = (radians - k * kHalfPiHigh) - k * kHalfPiLow;
  return {angle, static_cast<int>(static_cast<int64_t>(k) & 3)};
}

double quadrant_sin(double angle, int quadrant) {
  switch (quadrant & 3) {
    case 0:
      return taylor_sin(angle);
    case 1:
      return taylor_cos(angle);
    case 2:
      return -taylor_sin(angle);
    default:
      return -taylor_cos(angle);
  }
}

double portable_atan(double x) {  // x >= 0
  if (x > 1) return std::numbers::pi / 2 - portable_atan(1 / x);
  // Halve the angle three times: tan(a/2) = t / (1 + sqrt(1 + t^2)). Then |x| < 0.1 and 9 terms suffice.
  double factor = 1;
  for (int i = 0; i < 3; ++i) {
    x = x / (1 + std::sqrt(1 + x * x));
    factor *= 2;
  }
  const double s = x * x;
  double sum = 0;
  for (size_t n = 10; n-- > 0;) sum = kInverses[2 * n + 1] - s * sum;
  return factor * x * sum;
}

// ln(x) as an unevaluated sum of two doubles, so that pow keeps its digits for large exponents.
struct Logarithm {
  double high, low;
};

Logarithm split_log(double x) {
  int exponent = 0;
  if (x < std::numeric_limits<double>::min()) {
    x *= 18014398509481984.0;  // 2^54: subnormal numbers become normal
    exponent = -54;
  }
  const auto bits = std::bit_cast<uint64_t>(x);
  exponent += static_cast<int>(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffULL) | 0x3ff0000000000000ULL);
  if (m > std::numbers::sqrt2) {
    m *= 0.5;
    ++exponent;
  }
  // ln m = 2 atanh((m-1)/(m+1)), |f| <= 0.1716; the series is exact to 1e-19 after the term f^21.
  const double f = (m - 1) / (m + 1);
  const double s = f * f;
  double sum = 0;
  for (size_t n = 21; n >= 3; n -= 2) sum = kInverses[n] + s * sum;
  const double high = exponent * kLn2High;
  const double leading = 2 * f;
  const double total = high + leading;
  const double rest =
      std::abs(high) >= std::abs(leading) ? leading - (total - high) : high - (total - leading);
  return {total, rest + (2 * f * s * sum + exponent * kLn2Low)};
}

double exp_of_sum(double high, double low) {
  const double x = high + low;
  if (x > 709.78) return std::numeric_limits<double>::infinity();
  if (x < -745.2) return 0;
  const double k = std::nearbyint(x / std::numbers::ln2);
  const double r = ((high - k * kLn2High) - k * kLn2Low) + low;  // |r| <= 0.35
  double sum = kInverseFactorials[16];
  for (size_t n = 16; n-- > 0;) sum = kInverseFactorials[n] + r * sum;
  // Two factors, so that subnormal results round once.
  const int first = static_cast<int>(k) / 2, second = static_cast<int>(k) - first;
  const auto power_of_two = [](int e) {
    return std::bit_cast<double>(static_cast<uint64_t>(e + 1023) << 52);
  };
  return sum * power_of_two(first) * power_of_two(second);
}

}  // namespace

double portable_sin(double radians) {
  const ReducedAngle r = reduce(radians);
  return quadrant_sin(r.angle, r.quadrant);
}

double portable_cos(double radians) {
  const ReducedAngle r = reduce(radians);
  return quadrant_sin(r.angle, r.quadrant + 1);
}

SineCosine portable_sine_cosine(double radians) {
  const ReducedAngle r = reduce(radians);
  const double s = taylor_sin(r.angle), c = taylor_cos(r.angle);
  switch (r.quadrant) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double portable_tan(double radians) {
  return portable_sin(radians) / portable_cos(radians);
}

double portable_acos(double x) {
  x = std::clamp(x, -1.0, 1.0);
  if (x == -1) return std::numbers::pi;
  // The half-angle form keeps its digits near both ends.
  return 2 * portable_atan(std::sqrt((1 - x) / (1 + x)));
}

double portable_exp(double x) {
  return exp_of_sum(x, 0);
}

double portable_log(double x) {
  const Logarithm l = split_log(x);
  return l.high + l.low;
}

double portable_exp2(double x) {
  const double whole = std::floor(x);
  return std::ldexp(portable_pow(2, x - whole), static_cast<int>(whole));
}

double portable_pow(double base, double exponent) {
  if (exponent == 0 || base == 1) return 1;
  if (!(base > 0)) return exponent > 0 ? 0 : std::numeric_limits<double>::infinity();
  const Logarithm l = split_log(base);
  const double product = l.high * exponent;
  if (std::abs(product) > 800) return product > 0 ? std::numeric_limits<double>::infinity() : 0;
  // The rounding error of the product by Dekker's splitting, so that the exponent's digits are not lost.
  const auto split = [](double v) {
    const double c = 134217729.0 * v;
    const double high = c - (c - v);
    return std::pair{high, v - high};
  };
  const auto [ah, al] = split(l.high);
  const auto [bh, bl] = split(exponent);
  const double error = ((ah * bh - product) + ah * bl + al * bh) + al * bl;
  return exp_of_sum(product, error + l.low * exponent);
}

}  // namespace rayfarm
