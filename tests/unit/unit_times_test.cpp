// Unit times of Equation 4.5 from measured rays.
#include "host/experiments/hierarchies/unit_times.h"

#include <gtest/gtest.h>

#include <vector>

namespace rayfarm {
namespace {

// Thesis, 4.3.3: T_N .245, T_P .303 and T_O 2.75 ms for the object/volume hierarchy: its rows of Image 1 in
// Table 4.7.
TEST(UnitTimes, AreThoseThatRaysWereMadeOf) {
  std::vector<RayCosts> rays;
  for (const auto& [volumes, primitives] : {std::pair{24.7, 54.9}, {36.9, 43.2}, {55.1, 33.6}, {1.0, 4.92}})
    rays.push_back({volumes, primitives, volumes * 0.245 + primitives * 0.303 + 2.75});
  const UnitTimes times = fit_unit_times(rays);
  EXPECT_NEAR(times.step_ns, 0.245, 1e-9);
  EXPECT_NEAR(times.test_ns, 0.303, 1e-9);
  EXPECT_NEAR(times.overhead_ns, 2.75, 1e-9);
  EXPECT_LT(largest_error(rays, times), 1e-9);
  rays[0].ns *= 1.5;
  EXPECT_NEAR(largest_error(rays, times), 1.0 / 3, 1e-9);
}

TEST(UnitTimes, AreFoundInWhateverUnitsTimesAndCountsCome) {
  for (const double second : {1e9, 1e-9}) {
    std::vector<RayCosts> rays;
    for (const auto& [volumes, primitives] : {std::pair{1e7, 5e3}, {4e7, 4e3}, {5e7, 3e3}, {1e6, 5e2}})
      rays.push_back({volumes, primitives, (volumes * 0.2 + primitives * 300 + 2e6) * second});
    const UnitTimes times = fit_unit_times(rays);
    EXPECT_NEAR(times.step_ns / second, 0.2, 1e-6);
    EXPECT_NEAR(times.test_ns / second, 300, 1e-3);
    EXPECT_NEAR(times.overhead_ns / second, 2e6, 10);
  }
}

// Rows in which steps and tests go together tell nothing of each alone: one of them stands for both.
TEST(UnitTimes, OfRowsThatDoNotTellThemApartForetellThemAllTheSame) {
  std::vector<RayCosts> rays;
  for (const double n : {1e-3, 2e-3, 5e-3}) rays.push_back({n, 3 * n, 7 * n + 1e-5});
  EXPECT_LT(largest_error(rays, fit_unit_times(rays)), 1e-6);
}

TEST(UnitTimes, AreNeverNegative) {
  // More tests, less time: no time of a test explains it.
  const std::vector<RayCosts> rays{{10, 1, 12}, {10, 2, 11}, {20, 3, 20}, {20, 4, 19}};
  const UnitTimes times = fit_unit_times(rays);
  EXPECT_GE(times.step_ns, 0);
  EXPECT_GE(times.test_ns, 0);
  EXPECT_GE(times.overhead_ns, 0);
  EXPECT_LT(largest_error(rays, times), 0.1);
}

TEST(UnitTimes, OfOneRayForetellIt) {
  const std::vector<RayCosts> rays{{4, 0, 20}};
  EXPECT_LT(largest_error(rays, fit_unit_times(rays)), 1e-9);
}

}  // namespace
}  // namespace rayfarm
