// The principled material against what glTF 2.0's appendix B says, by quadrature of its own; energy,
// densities and reciprocity.
#include "common/materials/principled.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/materials/ggx.h"
#include "common/sampling/warps.h"
#include "tests/unit/chi_square.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

constexpr Vec3 kSurfaceNormal{0, 0, 1};

Vec3 viewer_at(double cosine, double phi = 0.4) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

/// A point, and what a viewer finds there.
struct Seen {
  Seen(const PrincipledPoint& with, const Vec3& to_viewer, double index_ratio = 1)
      : point(with), at{to_viewer, kSurfaceNormal, index_ratio >= 1, index_ratio, &point} {
    lobes.clear();
    scatter_principled(point, at, lobes);
  }
  Seen(const Seen&) = delete;
  Color f(const Vec3& direction) const { return eval(lobes, at, direction).value / std::abs(direction.z); }
  PrincipledPoint point;
  Interaction at;
  Lobes lobes;
};

/// Points that are spread evenly in three dimensions.
template <typename Visit>
void for_each_choice(uint32_t side, Visit visit) {
  for (uint32_t i = 0; i < side * side; ++i) {
    const double lobe = std::fmod(0.5 + i * 0.6180339887498949, 1);
    visit(Vec2((i % side + 0.5) / side, (i / side + 0.5) / side), lobe);
  }
}

/// What the viewer sees in light of 1 from everywhere, by sampling.
double furnace(const Seen& seen, uint32_t side = 96) {
  double sum = 0;
  for_each_choice(side,
                  [&](const Vec2& u, double lobe) { sum += sample(seen.lobes, seen.at, u, lobe).weight.y; });
  return sum / (side * side);
}

PrincipledPoint white_metal(double roughness) {
  PrincipledPoint p;
  p.metallic = 1;
  p.roughness = roughness;
  return p;
}

// "White furnace of white metals ≤ 1 % at any roughness" (multiple-scattering compensation).
TEST(Principled, WhiteMetalsAreWhiteInAFurnace) {
  for (const double roughness : {0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0})
    for (const double cosine : {1.0, 0.7, 0.3, 0.1, 0.03})
      EXPECT_NEAR(furnace(Seen(white_metal(roughness), viewer_at(cosine))), 1, 0.01)
          << roughness << " at " << cosine;
}

// Without it the same metal loses what has met several facets: more than half at roughness 1 (here by the
// table).
TEST(Ggx, TheTableIsTheIntegralOfTheDistribution) {
  for (const double roughness : {0.15, 0.37, 0.6, 1.0})
    for (const double cosine : {1.0, 0.5, 0.15}) {
      const double alpha = roughness * roughness;
      const Vec3 v = viewer_at(cosine, 0);
      // The sphere of half vectors: dω = 4 (v·h) dω_h.
      constexpr int kSide = 400;
      double sum = 0;
      for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
          const double u = (i + 0.5) / kSide, phi = 2 * pi * (j + 0.5) / kSide;
          const double height2 = (1 - u) / (1 + (alpha * alpha - 1) * u);  // so that D cos has the density 1
          const double s = std::sqrt(1 - height2);
          const Vec3 h(s * std::cos(phi), s * std::sin(phi), std::sqrt(height2));
          const double vh = glm::dot(v, h);
          const Vec3 l = 2 * vh * h - v;
          if (vh <= 0 || l.z <= 0) continue;
          sum += ggx_shadowing(v.z, alpha) * ggx_shadowing(l.z, alpha) * vh / (v.z * h.z);
        }
      EXPECT_NEAR(ggx_albedo(cosine, roughness), sum / (kSide * kSide), 0.003)
          << roughness << " at " << cosine;
    }
}

TEST(Ggx, OneBounceLosesMoreTheRougherAMetalIs) {
  EXPECT_NEAR(mean_ggx_albedo(0.3), 0.976, 0.002);
  EXPECT_NEAR(mean_ggx_albedo(0.7), 0.697, 0.005);
  EXPECT_NEAR(mean_ggx_albedo(1), 0.377, 0.002);
}

/// Appendix B of glTF 2.0, as it is written there, times the cosine.
double appendix_b(double base, double metallic, double roughness, const Vec3& v, const Vec3& l) {
  const double alpha = roughness * roughness, a2 = alpha * alpha;
  const Vec3 h = normalized(v + l);
  const double n_h = h.z, n_l = l.z, n_v = v.z, v_h = glm::dot(v, h);
  const double d = a2 / (pi * std::pow(n_h * n_h * (a2 - 1) + 1, 2));
  const double visibility =
      1 / (n_l + std::sqrt(a2 + (1 - a2) * n_l * n_l)) / (n_v + std::sqrt(a2 + (1 - a2) * n_v * n_v));
  const double specular = visibility * d, fresnel = std::pow(1 - v_h, 5);
  const double of_metal = specular * (base + (1 - base) * fresnel);
  const double fr = 0.04 + 0.96 * fresnel;
  const double of_dielectric = (1 - fr) * base / pi + fr * specular;
  return n_l * (metallic * of_metal + (1 - metallic) * of_dielectric);
}

// "dielectrics: default equals glTF 2.0's mix of appendix B".
TEST(Principled, DielectricsAreTheMixOfAppendixB) {
  for (const double roughness : {0.2, 0.5, 1.0})
    for (uint32_t i = 0; i < 200; ++i) {
      PrincipledPoint p;
      p.base = Color(0.7);
      p.roughness = roughness;
      const Vec3 v = sample_cosine(random_point(i, 1)), l = sample_cosine(random_point(i, 2));
      const double expected = appendix_b(0.7, 0, roughness, v, l);
      EXPECT_NEAR(eval(Seen(p, v).lobes, Seen(p, v).at, l).value.y, expected, 1e-9 * std::max(1.0, expected));
    }
}

// "it gains 4 % at roughness .05 and loses 2.5 % at 1": of light from all over the hemisphere, seen from all
// over it.
TEST(Principled, DielectricsGainAndLoseWhatTheMixDoes) {
  const auto albedo = [](double roughness) {
    double sum = 0;
    constexpr int kViews = 24;
    for (int k = 0; k < kViews; ++k) {  // evenly in cos², by which views are weighed
      PrincipledPoint p;
      p.roughness = roughness;
      sum += furnace(Seen(p, viewer_at(std::sqrt((k + 0.5) / kViews))), 64) / kViews;
    }
    return sum;
  };
  EXPECT_NEAR(albedo(0.05), 1.042, 0.003);
  EXPECT_NEAR(albedo(0.5), 1.009, 0.003);
  EXPECT_NEAR(albedo(1), 0.9735, 0.003);
}

struct PrincipledCase {
  const char* name;
  PrincipledPoint point;
  double index_ratio = 1;
};

std::vector<PrincipledCase> principled_cases() {
  std::vector<PrincipledCase> list;
  const auto add = [&](const char* name, double roughness) -> PrincipledPoint& {
    list.push_back({name, {}, 1});
    list.back().point.roughness = roughness;
    list.back().point.base = Color(0.9, 0.6, 0.3);
    return list.back().point;
  };
  add("plastic", 0.4);
  add("gold", 0.5).metallic = 1;
  add("half metal", 0.8).metallic = 0.5;
  PrincipledPoint& coated = add("coated", 0.7);
  coated.coat = 0.8;
  coated.coat_roughness = 0.3;
  PrincipledPoint& sheet = add("clear sheet", 0.5);
  sheet.transmission = 0.7;
  PrincipledPoint& glass = add("frosted glass", 0.45);
  glass.transmission = 1;
  glass.is_solid = true;
  list.back().index_ratio = 1.5;
  PrincipledPoint& inside = add("frosted glass from inside", 0.45);
  inside.transmission = 0.8;
  inside.is_solid = true;
  list.back().index_ratio = 1 / 1.5;
  PrincipledPoint& tinted = add("specular colour", 0.3);
  tinted.specular_color = Color(1, 0.5, 0.2);
  tinted.specular = 0.7;
  tinted.ior = 1.8;
  return list;
}

TEST(Principled, DirectionsAreChosenByTheirDensity) {
  for (const PrincipledCase& c : principled_cases()) {
    const Seen seen(c.point, viewer_at(0.6), c.index_ratio);
    uint32_t i = 0;
    check_directions(
        [&](const Vec2& u) {
          const ScatteredRay ray = sample(seen.lobes, seen.at, u, random_point(i++, 4).x);
          return ray.weight == Color(0) ? Vec3(0) : ray.direction;
        },
        [&](const Vec3& d) {
          const Scattered s = eval(seen.lobes, seen.at, d);
          return s.value == Color(0) ? 0 : s.pdf;
        });
    if (HasFailure()) FAIL() << c.name;
  }
}

TEST(Principled, WeightsAreValuesOverDensities) {
  for (const PrincipledCase& c : principled_cases()) {
    const Seen seen(c.point, viewer_at(0.5), c.index_ratio);
    for_each_choice(24, [&](const Vec2& u, double lobe) {
      const ScatteredRay ray = sample(seen.lobes, seen.at, u, lobe);
      if (ray.weight == Color(0)) return;
      const Scattered s = eval(seen.lobes, seen.at, ray.direction);
      EXPECT_NEAR(ray.pdf, s.pdf, 1e-9 * s.pdf) << c.name;
      EXPECT_NEAR(ray.weight.x, s.value.x / s.pdf, 1e-9) << c.name;
      EXPECT_EQ(ray.direction.z < 0, ray.is_transmitted) << c.name;
    });
  }
}

// f(v, l) = f(l, v); through a body, per squared index of refraction (Veach 1997, section 5.2).
TEST(Principled, LightTakesTheSameWayBack) {
  for (const PrincipledCase& c : principled_cases())
    for (uint32_t i = 0; i < 100; ++i) {
      const Vec3 v = sample_cosine(random_point(i, 5)), l = sample_cosine(random_point(i, 6));
      const Color there = Seen(c.point, v, c.index_ratio).f(l), back = Seen(c.point, l, c.index_ratio).f(v);
      EXPECT_NEAR(there.y, back.y, 1e-9 * std::max(1.0, there.y)) << c.name;
      const Vec3 below(l.x, l.y, -l.z);
      const Color through = Seen(c.point, v, c.index_ratio).f(below);
      // Seen from below, up is down.
      const double ratio = c.point.is_solid ? c.index_ratio : 1;
      const Color reverse = Seen(c.point, l, 1 / ratio).f({v.x, v.y, -v.z});
      EXPECT_NEAR(through.y * ratio * ratio, reverse.y, 1e-9 * std::max(1.0, reverse.y)) << c.name;
    }
}

TEST(Principled, SmoothSurfacesAreMirrorsAndGlass) {
  PrincipledPoint glass;
  glass.roughness = 0;
  glass.transmission = 1;
  glass.is_solid = true;
  const Seen seen(glass, viewer_at(1), 1.5);
  ASSERT_EQ(seen.lobes.size(), 2u);
  EXPECT_NEAR(seen.lobes[0].attenuation.y, 0.04, 1e-12);
  EXPECT_NEAR(seen.lobes[1].attenuation.y * 1.5 * 1.5, 0.96, 1e-12);
  const Seen total(glass, viewer_at(0.5), 1 / 1.5);  // beyond the critical angle of 41.8°
  ASSERT_EQ(total.lobes.size(), 1u);
  EXPECT_EQ(total.lobes[0].attenuation, Color(1));
  glass.is_solid = false;
  const Seen sheet(glass, viewer_at(0.8));
  EXPECT_NEAR(glm::length(sheet.lobes[1].axis + sheet.at.to_viewer), 0, 1e-12);  // not bent
}

TEST(Principled, AnUnlitSurfaceScattersNothing) {
  PrincipledPoint p;
  p.is_black = true;
  EXPECT_TRUE(Seen(p, viewer_at(0.9)).lobes.empty());
}

}  // namespace
}  // namespace rayfarm
