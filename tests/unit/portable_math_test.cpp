#include "common/math/portable_math.h"

#include <cmath>

#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

void expect_close(double ours, long double exact, double relative) {
  EXPECT_LE(std::abs(static_cast<long double>(ours) - exact),
            static_cast<long double>(relative) * std::abs(exact) + 1e-300L)
      << "exact " << static_cast<double>(exact);
}

TEST(PortableMath, AgreesWithLongDouble) {
  std::mt19937 random(1);
  for (int i = 0; i < 100000; ++i) {
    const double angle = test::uniform(random, -100, 100);
    EXPECT_NEAR(portable_sin(angle), static_cast<double>(std::sin(static_cast<long double>(angle))), 5e-16);
    EXPECT_NEAR(portable_cos(angle), static_cast<double>(std::cos(static_cast<long double>(angle))), 5e-16);
    const double x = test::uniform(random, -1, 1);
    EXPECT_NEAR(portable_acos(x), static_cast<double>(std::acos(static_cast<long double>(x))), 2e-15);
    const double e = test::uniform(random, -700, 700);
    expect_close(portable_exp(e), std::exp(static_cast<long double>(e)), 1e-15);
    const double positive = std::exp(test::uniform(random, -600, 600));
    expect_close(portable_log(positive), std::log(static_cast<long double>(positive)), 1e-15);
    const double base = test::uniform(random, 0, 2), exponent = test::uniform(random, 0, 90);
    const long double power = std::pow(static_cast<long double>(base), static_cast<long double>(exponent));
    if (power > 1e-30L && power < 1e30L) expect_close(portable_pow(base, exponent), power, 1e-13);
  }
}

TEST(PortableMath, EdgesOfTheDomain) {
  EXPECT_EQ(portable_pow(0, 3), 0);
  EXPECT_EQ(portable_pow(0, 0), 1);
  EXPECT_EQ(portable_pow(1, 1e5), 1);
  EXPECT_EQ(portable_pow(0.5, 100000), 0);
  EXPECT_EQ(portable_exp(-1000), 0);
  EXPECT_TRUE(std::isinf(portable_exp(1000)));
  EXPECT_DOUBLE_EQ(portable_acos(-1), M_PI);
  EXPECT_DOUBLE_EQ(portable_acos(2), 0);
}

}  // namespace
}  // namespace rayfarm
