// What is computed in lanes is what the scalar functions say, to the last bit, on every SIMD target.
#include <gtest/gtest.h>

#include <bit>
#include <numbers>
#include <random>

#include "common/materials/fresnel.h"
#include "common/materials/scattering.h"
#include "common/math/portable_math.h"
#include "common/sampling/sampler.h"
#include "common/sampling/warps.h"
#include "tests/unit/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/lanes_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/materials/scattering-inl.h"
#include "common/sampling/sobol-inl.h"
#include "common/sampling/warps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Each takes the columns of eight arguments and gives those of the results.
using Columns = double (*)[8];

void lanes_sine_cosine(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) {
    const RealSineCosine s = sine_cosine(hn::Load(RealTag(), in[0] + i));
    hn::Store(s.sine, RealTag(), out[0] + i);
    hn::Store(s.cosine, RealTag(), out[1] + i);
  }
}
void lanes_normalized(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) store3(normalized(load3(in, i)), out, i);
}
HWY_INLINE Real2 load2(const double (*in)[8], size_t i) {
  return {hn::Load(RealTag(), in[0] + i), hn::Load(RealTag(), in[1] + i)};
}
void lanes_sample_cosine(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) store3(sample_cosine(load2(in, i)), out, i);
}
void lanes_sample_cone(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) {
    const Real height = hn::Load(RealTag(), in[2] + i);
    store3(sample_cone(load2(in, i), height), out, i);
    hn::Store(cone_pdf(height), RealTag(), out[3] + i);
  }
}
void lanes_sample_triangle(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) {
    const Real2 weights = sample_triangle(load2(in, i));
    hn::Store(weights.x, RealTag(), out[0] + i);
    hn::Store(weights.y, RealTag(), out[1] + i);
  }
}
void lanes_to_world(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) store3(to_world(load3(in, i), load3(in + 3, i)), out, i);
}
void lanes_mirrored(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) {
    const Real3 to_viewer = load3(in, i), normal = load3(in + 3, i);
    store3(mirrored(to_viewer, normal), out, i);
    Truth is_total;
    const Real3 through = refracted(to_viewer, normal, hn::Load(RealTag(), in[6] + i), is_total);
    store3(select(is_total, all(real(0)), through), out + 3, i);
  }
}
void lanes_fresnel(const double (*in)[8], Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) {
    const Real cosine = hn::Load(RealTag(), in[0] + i), n = hn::Load(RealTag(), in[1] + i),
               k = hn::Load(RealTag(), in[2] + i);
    hn::Store(fresnel_dielectric(cosine, n), RealTag(), out[0] + i);
    hn::Store(fresnel_conductor(cosine, n, k), RealTag(), out[1] + i);
  }
}
/// Sample numbers in, points out.
void lanes_sobol(const uint64_t* keys, const uint32_t* reversed, uint64_t frame_and_dimension, Columns out) {
  for (size_t i = 0; i < 8; i += kLanes) {
    const Real2 points = sobol_points(hn::Load(WordTag(), keys + i), hn::Load(HalfWordTag(), reversed + i),
                                      frame_and_dimension);
    hn::Store(points.x, RealTag(), out[0] + i);
    hn::Store(points.y, RealTag(), out[1] + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {
namespace {

HWY_EXPORT(lanes_sine_cosine);
HWY_EXPORT(lanes_normalized);
HWY_EXPORT(lanes_sample_cosine);
HWY_EXPORT(lanes_sample_cone);
HWY_EXPORT(lanes_sample_triangle);
HWY_EXPORT(lanes_to_world);
HWY_EXPORT(lanes_mirrored);
HWY_EXPORT(lanes_fresnel);
HWY_EXPORT(lanes_sobol);

using test::on_every_target;

constexpr size_t kMostColumns = 8;
struct alignas(64) Table {
  double columns[kMostColumns][8] = {};
};

void expect_same_bits(double expected, double found) {
  ASSERT_TRUE(test::same_bits(expected, found)) << expected << " and " << found;
}

/// Compares functions of rows of numbers: `make` gives arguments, `scalar` the expected results.
template <typename InLanes, typename Make, typename Scalar>
void compare(InLanes in_lanes, size_t results, Make make, Scalar scalar) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 2000; ++round) {
    Table in, out;
    for (size_t i = 0; i < 8; ++i) {
      const auto row = make(random);
      for (size_t k = 0; k < row.size(); ++k) in.columns[k][i] = row[k];
    }
    in_lanes(in.columns, out.columns);
    for (size_t i = 0; i < 8; ++i) {
      std::array<double, kMostColumns> row;
      for (size_t k = 0; k < kMostColumns; ++k) row[k] = in.columns[k][i];
      const auto expected = scalar(row);
      for (size_t k = 0; k < results; ++k) {
        expect_same_bits(expected[k], out.columns[k][i]);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

double uniform(std::mt19937_64& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}
Vec3 unit(std::mt19937_64& random) {
  return sample_sphere({uniform(random, 0, 1), uniform(random, 0, 1)});
}
/// In [0, 1), and often on a grid: the middle and edges are cases of their own.
double share(std::mt19937_64& random) {
  return random() % 4 == 0 ? static_cast<double>(random() % 4) / 4 : uniform(random, 0, 1);
}

TEST(Lanes, SineAndCosine) {
  on_every_target([] {
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_sine_cosine)
          (in, out);
        },
        2,
        [](std::mt19937_64& random) {
          return std::array{random() % 4 == 0 ? static_cast<double>(random() % 64) * std::numbers::pi / 8 - 12
                                              : uniform(random, -20, 20)};
        },
        [](const auto& row) {
          const SineCosine s = portable_sine_cosine(row[0]);
          return std::array{s.sine, s.cosine};
        });
  });
}

TEST(Lanes, NormalizedEvenWhereSquaresOverflow) {
  on_every_target([] {
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_normalized)
          (in, out);
        },
        3,
        [](std::mt19937_64& random) {
          const std::array<double, 6> scales{1, 1, 1, 1e-200, 1e200, 0};
          const Vec3 v = scales[random() % (random() % 8 == 0 ? 6 : 3)] * unit(random);
          return std::array{v.x, v.y, v.z};
        },
        [](const auto& row) {
          const Vec3 v = normalized(Vec3(row[0], row[1], row[2]));
          return std::array{v.x, v.y, v.z};
        });
  });
}

TEST(Lanes, WarpsOfTheUnitSquare) {
  // Shirley, Sung and Brown 1991, section 2.2.2.
  on_every_target([] {
    const auto square = [](std::mt19937_64& random) { return std::array{share(random), share(random)}; };
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_sample_cosine)
          (in, out);
        },
        3, square,
        [](const auto& row) {
          const Vec3 v = sample_cosine({row[0], row[1]});
          return std::array{v.x, v.y, v.z};
        });
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_sample_triangle)
          (in, out);
        },
        2, square,
        [](const auto& row) {
          const Vec2 v = sample_triangle({row[0], row[1]});
          return std::array{v.x, v.y};
        });
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_sample_cone)
          (in, out);
        },
        4,
        [](std::mt19937_64& random) {
          return std::array{share(random), share(random), uniform(random, 0, 1) * (random() % 2 ? 1 : 1e-9)};
        },
        [](const auto& row) {
          const Vec3 v = sample_cone({row[0], row[1]}, row[2]);
          return std::array{v.x, v.y, v.z, cone_pdf(row[2])};
        });
  });
}

TEST(Lanes, FramesAboutNormals) {
  on_every_target([] {
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_to_world)
          (in, out);
        },
        3,
        [](std::mt19937_64& random) {
          Vec3 n = unit(random);
          if (random() % 4 == 0) n = Vec3(random() % 2 ? 1 : 0, 0, 0), n.z = n.x > 0 ? -0.0 : -1.0;
          const Vec3 local = unit(random);
          return std::array{n.x, n.y, n.z, local.x, local.y, local.z};
        },
        [](const auto& row) {
          const Vec3 v = Frame(Vec3(row[0], row[1], row[2])).to_world({row[3], row[4], row[5]});
          return std::array{v.x, v.y, v.z};
        });
  });
}

TEST(Lanes, MirroredAndRefractedDirections) {
  on_every_target([] {
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_mirrored)
          (in, out);
        },
        6,
        [](std::mt19937_64& random) {
          const Vec3 v = unit(random);
          Vec3 n = unit(random);
          if (glm::dot(v, n) < 0) n = -n;
          const double ratio = random() % 2 ? uniform(random, 0.4, 1) : uniform(random, 1, 2.5);
          return std::array{v.x, v.y, v.z, n.x, n.y, n.z, ratio};
        },
        [](const auto& row) {
          Interaction at;
          at.to_viewer = {row[0], row[1], row[2]};
          at.normal = {row[3], row[4], row[5]};
          at.index_ratio = row[6];
          const Vec3 m = mirrored(at), r = refracted(at);
          return std::array{m.x, m.y, m.z, r.x, r.y, r.z};
        });
  });
}

TEST(Lanes, FresnelsEquations) {
  on_every_target([] {
    compare(
        [](auto in, auto out) {
          HWY_DYNAMIC_DISPATCH(lanes_fresnel)
          (in, out);
        },
        2,
        [](std::mt19937_64& random) {
          return std::array{share(random) + 1e-9, uniform(random, 0.3, 3), uniform(random, 0, 5)};
        },
        [](const auto& row) {
          return std::array{fresnel_dielectric(row[0], row[1]), fresnel_conductor(row[0], row[1], row[2])};
        });
  });
}

TEST(Lanes, SobolPoints) {
  on_every_target([] {
    const Sampler sampler({SamplingPattern::sobol, 4096, 0x123456789abcdefull}, 3);
    std::mt19937_64 random(6);
    for (int round = 0; round < 2000; ++round) {
      alignas(64) std::array<uint64_t, 8> keys;
      alignas(64) std::array<uint32_t, 8> reversed;
      std::array<SampleId, 8> ids;
      for (size_t i = 0; i < 8; ++i) {
        ids[i] = {static_cast<int>(random() % 4000) - 100, static_cast<int>(random() % 4000),
                  static_cast<uint32_t>(random() % 5000)};
        keys[i] = sampler.pixel_key(ids[i]);
        reversed[i] = reversed_bits(ids[i].sample);
      }
      const auto dimension = static_cast<uint32_t>(1 + random() % 60);
      Table out;
      HWY_DYNAMIC_DISPATCH(lanes_sobol)
      (keys.data(), reversed.data(), sampler.frame_and_dimension(dimension), out.columns);
      for (size_t i = 0; i < 8; ++i) {
        const Vec2 expected = sampler.point(ids[i], dimension);
        ASSERT_EQ(expected, Vec2(out.columns[0][i], out.columns[1][i]));
      }
    }
  });
}

}  // namespace
}  // namespace rayfarm
#endif
