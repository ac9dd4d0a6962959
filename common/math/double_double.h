#pragma once
// Sums and products with twice the digits of a double, the same on every machine (Dekker, "A Floating-Point
// Technique for Extending the Available Precision", 1971).
#include <cmath>

namespace rayfarm {

/// The number high + low, |low| being at most half a unit in high's last place.
struct DoubleDouble {
  double high = 0, low = 0;

  DoubleDouble(double v) : high(v) {}
  static DoubleDouble sum(double a, double b) {
    const double s = a + b, of_b = s - a;
    return {s, (a - (s - of_b)) + (b - of_b)};
  }
  static DoubleDouble product(double a, double b) {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
  }
  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble s = sum(a.high, b.high);
    return sum(s.high, s.low + (a.low + b.low));
  }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = product(a.high, b.high);
    return sum(p.high, p.low + (a.high * b.low + a.low * b.high));
  }

 private:
  DoubleDouble(double h, double l) : high(h), low(l) {}
};

}  // namespace rayfarm
