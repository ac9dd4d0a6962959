#include "common/math/orientation.h"

#include <array>

namespace rayfarm {
namespace {

int sign(double v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

/// A sum of doubles without rounding: parts that don't overlap, the smallest first.
class ExactSum {
 public:
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign_of_sum() const {
    for (size_t i = count_; i > 0; --i)
      if (parts_[i - 1] != 0) return sign(parts_[i - 1]);
    return 0;
  }

 private:
  void add(double v) {
    for (size_t i = 0; i < count_; ++i) {
      const double sum = v + parts_[i];
      const double of_part = sum - v;
      parts_[i] = (v - (sum - of_part)) + (parts_[i] - of_part);
      v = sum;
    }
    parts_[count_++] = v;
  }
  std::array<double, 12> parts_{};
  size_t count_ = 0;
};

}  // namespace

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  constexpr double kBound = 3.3306690738754716e-16;  // Shewchuk's (3 + 16 ε) ε
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double difference = left - right;
  if (std::abs(difference) > kBound * (std::abs(left) + std::abs(right))) return sign(difference);
  ExactSum sum;
  sum.add_product(a.x, b.y);
  sum.add_product(-a.y, b.x);
  sum.add_product(b.x, c.y);
  sum.add_product(-b.y, c.x);
  sum.add_product(c.x, a.y);
  sum.add_product(-c.y, a.x);
  return sum.sign_of_sum();
}

}  // namespace rayfarm
