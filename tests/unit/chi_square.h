#pragma once
// Whether samples are spread as their density says.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "common/math/vector.h"
#include "common/sampling/random.h"

namespace rayfarm {

/// The chi-square statistic against its distribution, by Wilson and Hilferty's normal approximation:
/// above 4.5 standard deviations is a chance below 1e-5.
inline void expect_fits(const std::vector<double>& observed, const std::vector<double>& expected) {
  double statistic = 0, pooled_observed = 0, pooled_expected = 0;
  int cells = 0;
  for (size_t i = 0; i < observed.size(); ++i) {
    pooled_observed += observed[i];
    pooled_expected += expected[i];
    if (pooled_expected < 10) continue;  // too few to compare: joined with the next cell
    statistic += (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
    ++cells;
    pooled_observed = pooled_expected = 0;
  }
  ASSERT_GT(cells, 10);
  EXPECT_LT(pooled_observed, 40) << "where nothing is expected";
  const double k = cells - 1, variance = 2 / (9 * k);
  const double z = (std::cbrt(statistic / k) - (1 - variance)) / std::sqrt(variance);
  EXPECT_LT(z, 4.5);
}

inline Vec2 random_point(uint32_t i, uint32_t purpose) {
  const auto r = random_pair(17, 0, {0, 0, i}, purpose);
  return {r[0], r[1]};
}

inline constexpr int kThetaCells = 20, kPhiCells = 40;
inline constexpr uint32_t kPoints = 200'000;

/// Directions in cells of cos θ and φ against the integral of their density over each cell. A zero vector is
/// no direction.
inline void check_directions(const std::function<Vec3(const Vec2&)>& sample,
                             const std::function<double(const Vec3&)>& pdf) {
  std::vector<double> observed(kThetaCells * kPhiCells), expected(observed.size());
  for (uint32_t i = 0; i < kPoints; ++i) {
    const Vec3 d = sample(random_point(i, 3));
    if (d == Vec3(0)) continue;  // the choice came to nothing
    ASSERT_NEAR(glm::length(d), 1, 1e-12);
    const int row = std::clamp(static_cast<int>((d.z + 1) / 2 * kThetaCells), 0, kThetaCells - 1);
    const double phi = std::atan2(d.y, d.x) + std::numbers::pi;
    const int column =
        std::clamp(static_cast<int>(phi / (2 * std::numbers::pi) * kPhiCells), 0, kPhiCells - 1);
    ++observed[static_cast<size_t>(row * kPhiCells + column)];
  }
  constexpr int kSub = 24;
  for (int row = 0; row < kThetaCells; ++row)
    for (int column = 0; column < kPhiCells; ++column) {
      double sum = 0;
      for (int i = 0; i < kSub; ++i)
        for (int j = 0; j < kSub; ++j) {
          const double z = -1 + 2 * (row + (i + 0.5) / kSub) / kThetaCells;
          const double phi =
                           2 * std::numbers::pi * (column + (j + 0.5) / kSub) / kPhiCells - std::numbers::pi,
                       s = std::sqrt(1 - z * z);
          sum += pdf({s * std::cos(phi), s * std::sin(phi), z});
        }
      expected[static_cast<size_t>(row * kPhiCells + column)] =
          sum / (kSub * kSub) * (2.0 / kThetaCells) * (2 * std::numbers::pi / kPhiCells) * kPoints;
    }
  expect_fits(observed, expected);
}

}  // namespace rayfarm
