// Patterns, warps and filters: chi-square against the densities they claim, and what each pattern promises.
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "common/sampling/pixel_filter.h"
#include "common/sampling/sampler.h"
#include "common/sampling/warps.h"
#include "tests/unit/chi_square.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

TEST(Warps, DirectionsHaveTheirDensities) {
  check_directions(sample_cosine, [](const Vec3& d) { return cosine_pdf(d.z); });
  check_directions(sample_sphere, [](const Vec3&) { return 1 / (4 * pi); });
  for (const double n : {1.0, 3.0, 8.0})
    check_directions([n](const Vec2& u) { return sample_phong(u, n); },
                     [n](const Vec3& d) { return phong_pdf(d.z, n); });
  check_directions([](const Vec2& u) { return sample_cone(u, 0.5); },
                   [](const Vec3& d) { return d.z >= 0.5 ? cone_pdf(0.5) : 0; });
}

/// Points of the plane in equal cells of [-radius, radius]² against their density.
void check_plane(const std::function<Vec2(const Vec2&)>& sample,
                 const std::function<double(const Vec2&)>& pdf, double radius) {
  constexpr int kCells = 24, kSub = 24;
  std::vector<double> observed(kCells * kCells), expected(observed.size());
  const auto cell = [&](double x) {
    return std::clamp(static_cast<int>((x + radius) / (2 * radius) * kCells), 0, kCells - 1);
  };
  for (uint32_t i = 0; i < kPoints; ++i) {
    const Vec2 p = sample(random_point(i, 2));
    ASSERT_LE(std::max(std::abs(p.x), std::abs(p.y)), radius * (1 + 1e-12));
    ++observed[static_cast<size_t>(cell(p.y) * kCells + cell(p.x))];
  }
  const double step = 2 * radius / kCells;
  for (int y = 0; y < kCells; ++y)
    for (int x = 0; x < kCells; ++x) {
      double sum = 0;
      for (int i = 0; i < kSub; ++i)
        for (int j = 0; j < kSub; ++j)
          sum += pdf({-radius + (x + (i + 0.5) / kSub) * step, -radius + (y + (j + 0.5) / kSub) * step});
      expected[static_cast<size_t>(y * kCells + x)] = sum / (kSub * kSub) * step * step * kPoints;
    }
  expect_fits(observed, expected);
}

TEST(Warps, AreasHaveTheirDensities) {
  check_plane(
      sample_disk, [](const Vec2& p) { return glm::dot(p, p) <= 1 ? 1 / pi : 0; }, 1);
  check_plane(
      sample_triangle, [](const Vec2& p) { return p.x >= 0 && p.y >= 0 && p.x + p.y <= 1 ? 2 : 0; }, 1);
}

TEST(Warps, FramesAreOrthonormal) {
  for (uint32_t i = 0; i < 1000; ++i) {
    const Vec3 n = i == 0 ? Vec3(0, 0, -1) : i == 1 ? Vec3(0, 0, 1) : sample_sphere(random_point(i, 5));
    const Frame frame(n);
    EXPECT_NEAR(glm::length(glm::cross(frame.tangent, frame.bitangent) - n), 0, 1e-12);
    EXPECT_NEAR(glm::length(frame.tangent), 1, 1e-12);
  }
}

TEST(Filters, SamplesFollowTheFilterAndWeighOneOnAverage) {
  for (const FilterKind kind :
       {FilterKind::box, FilterKind::tent, FilterKind::gaussian, FilterKind::mitchell}) {
    const PixelFilter filter(kind);
    double integral = 0, total = 0;  // of the filter, and of its magnitude
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
      const double v =
          filter.value(filter.radius() * (2 * (i + 0.5) / kSteps - 1)) * 2 * filter.radius() / kSteps;
      integral += v;
      total += std::abs(v);
    }
    EXPECT_NEAR(integral, 1, 1e-3);
    check_plane(
        [&](const Vec2& u) { return filter.sample(u).offset; },
        [&](const Vec2& p) { return std::abs(filter.value(p.x) * filter.value(p.y)) / (total * total); },
        filter.radius());
    double weight = 0;
    for (uint32_t i = 0; i < kPoints; ++i) weight += filter.sample(random_point(i, 2)).weight;
    EXPECT_NEAR(weight / kPoints, 1, 0.01);
  }
}

const std::vector<SamplingPattern> kPatterns{SamplingPattern::sobol,    SamplingPattern::regular,
                                             SamplingPattern::jittered, SamplingPattern::uncorrelated,
                                             SamplingPattern::n_rooks,  SamplingPattern::poisson};

Sampler make_sampler(SamplingPattern pattern, uint32_t samples, uint64_t seed = 1, int frame = 0) {
  return {{pattern, samples, seed}, frame};
}

TEST(Patterns, AreUniformOverManyPixels) {
  for (const SamplingPattern pattern : kPatterns) {
    if (pattern == SamplingPattern::regular) continue;  // always the same places
    SCOPED_TRACE(static_cast<int>(pattern));
    const Sampler sampler = make_sampler(pattern, 12);
    for (const uint32_t dimension : {dimension::kScreen, dimension::of_bounce(2, dimension::kLight)}) {
      constexpr int kCells = 16, kPixels = 4000;
      std::vector<double> observed(kCells * kCells),
          expected(kCells * kCells, 12.0 * kPixels / (kCells * kCells));
      for (int pixel = 0; pixel < kPixels; ++pixel)
        for (uint32_t i = 0; i < 12; ++i) {
          const Vec2 p = sampler.point({pixel % 67, pixel / 67, i}, dimension);
          ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
          ++observed[static_cast<size_t>(static_cast<int>(p.y * kCells) * kCells +
                                         static_cast<int>(p.x * kCells))];
        }
      expect_fits(observed, expected);
    }
  }
}

TEST(Patterns, JitterHasOnePointInEachStratum) {
  for (const SamplingPattern pattern :
       {SamplingPattern::jittered, SamplingPattern::uncorrelated, SamplingPattern::regular})
    for (const uint32_t dimension : {0u, 7u}) {
      const Sampler sampler = make_sampler(pattern, 12);
      std::set<std::pair<int, int>> cells;
      for (uint32_t i = 0; i < 12; ++i) {
        const Vec2 p = sampler.point({3, 4, i}, dimension);
        cells.insert({static_cast<int>(p.x * 4), static_cast<int>(p.y * 3)});
      }
      EXPECT_EQ(cells.size(), 12u);
    }
}

TEST(Patterns, RooksDoNotSeeEachOther) {
  for (const uint32_t samples : {1u, 7u, 64u, 100u})
    for (const uint32_t dimension : {0u, 9u}) {
      const Sampler sampler = make_sampler(SamplingPattern::n_rooks, samples);
      std::set<int> rows, columns;
      for (uint32_t i = 0; i < samples; ++i) {
        const Vec2 p = sampler.point({-1, 8, i}, dimension);
        columns.insert(static_cast<int>(p.x * samples));
        rows.insert(static_cast<int>(p.y * samples));
      }
      EXPECT_EQ(rows.size(), samples);
      EXPECT_EQ(columns.size(), samples);
    }
}

TEST(Patterns, SobolStratifiesEveryElementaryInterval) {
  // A (0, 2)-sequence: 64 points have one in each box of area 1/64, whatever its shape.
  const Sampler sampler = make_sampler(SamplingPattern::sobol, 64);
  for (int pixel = 0; pixel < 20; ++pixel)
    for (int columns = 1; columns <= 64; columns *= 2) {
      std::set<std::pair<int, int>> cells;
      for (uint32_t i = 0; i < 64; ++i) {
        const Vec2 p = sampler.point({pixel, 0, i}, 6);
        cells.insert({static_cast<int>(p.x * columns), static_cast<int>(p.y * 64 / columns)});
      }
      EXPECT_EQ(cells.size(), 64u) << columns;
    }
}

TEST(Patterns, PoissonDisksKeepTheirDistance) {
  const Sampler sampler = make_sampler(SamplingPattern::poisson, 64);
  double nearest = 1;
  for (uint32_t i = 0; i < 64; ++i)
    for (uint32_t k = 0; k < i; ++k) {
      const Vec2 d = glm::abs(sampler.point({5, 5, i}, 0) - sampler.point({5, 5, k}, 0));
      nearest = std::min(nearest, glm::length(glm::min(d, 1.0 - d)));
    }
  EXPECT_GT(nearest, 0.55 / 8);  // random points: about 0.01
}

TEST(Patterns, DependOnSeedFramePixelAndDimensionAlone) {
  for (const SamplingPattern pattern : kPatterns) {
    if (pattern == SamplingPattern::regular) continue;
    const SampleId id{3, 4, 5};
    const Vec2 p = make_sampler(pattern, 16).point(id, 6);
    EXPECT_EQ(p, make_sampler(pattern, 16).point(id, 6));
    EXPECT_NE(p, make_sampler(pattern, 16, 2).point(id, 6));
    EXPECT_NE(p, make_sampler(pattern, 16, 1, 1).point(id, 6));
    EXPECT_NE(p, make_sampler(pattern, 16).point({4, 4, 5}, 6));
    EXPECT_NE(p, make_sampler(pattern, 16).point(id, 7));
  }
  EXPECT_EQ(make_sampler(SamplingPattern::sobol, 1).point({9, 9, 0}, 0), Vec2(0.5));  // alone in the centre
}

TEST(Patterns, PermutationsAreOneToOne) {
  for (const uint32_t n : {1u, 2u, 3u, 17u, 64u, 1000u}) {
    std::set<uint32_t> seen;
    for (uint32_t i = 0; i < n; ++i) seen.insert(permuted(i, n, 99));
    EXPECT_EQ(seen.size(), n);
    EXPECT_EQ(*seen.rbegin(), n - 1);
  }
  std::set<uint32_t> firsts;
  for (uint64_t seed = 0; seed < 200; ++seed) firsts.insert(permuted(0, 8, seed));
  EXPECT_EQ(firsts.size(), 8u);
}

}  // namespace
}  // namespace rayfarm
