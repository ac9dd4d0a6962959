// Each material's energy, density and reciprocity, and Fresnel's equations against values worked out by hand.
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "common/materials/fresnel.h"
#include "common/materials/presets.h"
#include "common/materials/scattering.h"
#include "common/materials/spectrum.h"
#include "common/sampling/random.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

TEST(Fresnel, DielectricAgreesWithTheTextbook) {
  // Normal incidence: ((n - 1) / (n + 1))². 60° from air to glass of 1.5: sin 60° / 1.5 = sin 35.2644°;
  // r_s = -sin(24.7356°) / sin(95.2644°), r_p = tan(24.7356°) / tan(95.2644°).
  EXPECT_NEAR(fresnel_dielectric(1, 1.5), 0.04, 1e-12);
  const double inside = std::asin(std::sin(pi / 3) / 1.5), a = pi / 3 - inside, b = pi / 3 + inside;
  const double expected =
      0.5 * (std::pow(std::sin(a) / std::sin(b), 2) + std::pow(std::tan(a) / std::tan(b), 2));
  EXPECT_NEAR(fresnel_dielectric(0.5, 1.5), expected, 1e-12);
  EXPECT_NEAR(fresnel_dielectric(0.5, 1.5), 0.0891867, 1e-6);
  EXPECT_EQ(fresnel_dielectric(0.5, 1 / 1.5), 1);  // beyond the critical angle of 41.8°
  EXPECT_NEAR(fresnel_dielectric(0, 1.5), 1, 1e-12);
  // Brewster's angle: the parallel part is gone, half of the other is left.
  const double brewster = std::atan(1.5), reflected = std::cos(2 * brewster);
  EXPECT_NEAR(fresnel_dielectric(std::cos(brewster), 1.5), 0.5 * reflected * reflected, 1e-12);
}

TEST(Fresnel, ConductorAgreesWithItsLimits) {
  for (const double cosine : {1.0, 0.7, 0.3, 0.05})  // without absorption it is a dielectric
    EXPECT_NEAR(fresnel_conductor(cosine, 1.5, 0), fresnel_dielectric(cosine, 1.5), 1e-12);
  // Normal incidence: ((n - 1)² + k²) / ((n + 1)² + k²).
  EXPECT_NEAR(fresnel_conductor(1, 0.2, 3.9), (0.64 + 15.21) / (1.44 + 15.21), 1e-12);
  EXPECT_NEAR(fresnel_conductor(0, 0.2, 3.9), 1, 1e-12);
  // Against the complex form of the amplitudes.
  const std::complex<double> eta(1.3, 7.3);
  const double c = 0.4;
  const std::complex<double> behind = std::sqrt(1.0 - (1 - c * c) / (eta * eta));
  const double rs = std::norm((c - eta * behind) / (c + eta * behind)),
               rp = std::norm((eta * c - behind) / (eta * c + behind));
  EXPECT_NEAR(fresnel_conductor(c, 1.3, 7.3), 0.5 * (rs + rp), 1e-12);
}

TEST(Presets, MetalsHaveTheirColours) {
  const auto reflectance = [](const char* name) {
    const uint32_t metal = *find_conductor(name);
    const auto at = [metal](double nm) {
      const ConductorConstants c = conductor_at(metal, nm);
      return fresnel_conductor(1, c.n, c.k);
    };
    return Color(at(630), at(532), at(465));
  };
  EXPECT_GT(reflectance("gold").x, 1.5 * reflectance("gold").z);
  EXPECT_GT(reflectance("copper").x, 1.2 * reflectance("copper").y);
  EXPECT_GT(max_component(-reflectance("silver")), -1.0);
  EXPECT_GT(reflectance("silver").z, 0.85);
  EXPECT_GT(reflectance("aluminium").y, 0.85);
  EXPECT_FALSE(find_conductor("unobtainium"));
  EXPECT_NEAR(find_dielectric("water")->index, 1.333, 1e-9);
}

struct Case {
  const char* name;
  Material material;
  double albedo;  ///< in white light from everywhere; negative: only <= 1
};

std::vector<Case> cases() {
  std::vector<Case> list;
  const auto add = [&](const char* name, MaterialKind kind, double albedo) -> Material& {
    list.push_back({name, {}, albedo});
    list.back().material.kind = kind;
    return list.back().material;
  };
  add("lambertian", MaterialKind::lambertian, 0.6).color = Color(0.6);
  add("luminaire", MaterialKind::luminaire, 0.3).color = Color(0.3);
  Material& translucent = add("translucent", MaterialKind::translucent, 1);
  translucent.color = Color(0.6);
  translucent.through = Color(0.4);
  add("dielectric", MaterialKind::dielectric, 1).index = 1.5;
  Material& rough_glass = add("rough dielectric", MaterialKind::dielectric, -1);
  rough_glass.index = 1.5;
  rough_glass.exponent = 50;
  Material& mirror = add("perfect conductor", MaterialKind::conductor, 1);
  mirror.n = Color(1);
  mirror.k = Color(1e9);
  Material& metal = add("rough conductor", MaterialKind::conductor, -1);
  metal.n = Color(0.2);
  metal.k = Color(4);
  metal.exponent = 30;
  Material& polished = add("polished", MaterialKind::polished, 1);
  polished.color = Color(1);
  polished.index = 1.5;
  Material& classical = add("classical", MaterialKind::classical, 0.9);
  classical.diffuse = 0.5;
  classical.reflect = 0.3;
  classical.transmit = 0.1;
  classical.index = 1.3;
  return list;
}

Interaction interaction(const Case& c, double cosine) {
  Interaction at{{std::sqrt(1 - cosine * cosine), 0, cosine}, {0, 0, 1}, true, c.material.index};
  return at;
}

Vec2 uniform_point(uint32_t i, uint32_t purpose) {
  const auto r = random_pair(5, 0, {0, 0, i}, purpose);
  return {r[0], r[1]};
}

TEST(Spectrum, ColoursComeBackFromTheirSpectra) {
  for (const ColourModel model : {ColourModel::meyer4, ColourModel::spectral20})
    for (const bool is_dispersive : {false, true})
      for (const Color& rgb :
           {Color(1), Color(0.5), Color(1, 0, 0), Color(0.2, 0.7, 0.3), Color(0, 0, 1), Color(0)}) {
        Color back(0);
        for (const ColourPass& pass : make_passes(nodes_of(model), is_dispersive))
          back += pass.rgb_from_channels * (pass.channels_from_rgb * rgb);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(back[c], rgb[c], 1e-9);
      }
  EXPECT_EQ(make_passes(nodes_of(ColourModel::spectral20), false).size(), 7u);
  EXPECT_EQ(make_passes(nodes_of(ColourModel::spectral20), true).size(), 20u);
  EXPECT_EQ(make_passes(nodes_of(ColourModel::meyer4), false).size(), 2u);
  EXPECT_EQ(make_passes(nodes_of(ColourModel::rgb), true).size(), 1u);
}

TEST(Spectrum, ReflectancesStayBetweenNothingAndAll) {
  for (const ColourPass& pass : make_passes(nodes_of(ColourModel::spectral20), true))
    for (const Color& rgb :
         {Color(1, 0, 0), Color(0, 1, 0), Color(0, 0, 1), Color(1, 1, 0), Color(0, 1, 1)}) {
      const double value = (pass.channels_from_rgb * rgb).x;
      EXPECT_GT(value, -0.35) << pass.wavelengths_nm.x;
      EXPECT_LT(value, 1.35) << pass.wavelengths_nm.x;
    }
}

TEST(Spectrum, DispersionFollowsTheAbbeNumber) {
  const double f = index_at(1.5168, 64.17, 486.1), c = index_at(1.5168, 64.17, 656.3);
  EXPECT_NEAR(index_at(1.5168, 64.17, 587.6), 1.5168, 1e-12);
  EXPECT_NEAR((1.5168 - 1) / (f - c), 64.17, 1e-6);
  EXPECT_NEAR(f, 1.5224, 5e-4);  // Schott's catalogue
  EXPECT_EQ(index_at(1.5, 0, 400), 1.5);
}

TEST(Materials, WhiteFurnace) {
  // In light of radiance 1 from everywhere (n² inside glass) the viewer sees the mean of the weights.
  constexpr uint32_t kRays = 40'000;
  for (const Case& c : cases())
    for (const double cosine : {1.0, 0.6, 0.2}) {
      const Interaction at = interaction(c, cosine);
      Lobes lobes;
      scatter(c.material, at, lobes);
      double sum = 0;
      for (uint32_t i = 0; i < kRays; ++i) {
        const ScatteredRay ray = sample(lobes, at, uniform_point(i, 1), uniform_point(i, 2).x);
        const double squeeze = ray.is_transmitted && c.material.kind == MaterialKind::dielectric
                                   ? at.index_ratio * at.index_ratio
                                   : 1;
        sum += ray.weight.y * squeeze;
      }
      EXPECT_LE(sum / kRays, 1.005) << c.name << " at " << cosine;
      if (c.albedo >= 0) {
        EXPECT_NEAR(sum / kRays, c.albedo, 0.005) << c.name << " at " << cosine;
      }
    }
}

TEST(Materials, SampledDirectionsHaveTheirDensity) {
  // The integral of value over the sphere equals the mean weight of what is not perfect, and densities
  // integrate to the share of what spreads.
  for (const Case& c : cases()) {
    const Interaction at = interaction(c, 0.7);
    Lobes lobes;
    scatter(c.material, at, lobes);
    double value = 0, density = 0, weight = 0, spread_share = 0, total = 0;
    constexpr uint32_t kRays = 200'000;
    for (uint32_t i = 0; i < kRays; ++i) {
      const Scattered s = eval(lobes, at, sample_sphere(uniform_point(i, 3)));
      value += 4 * pi * s.value.y / kRays;
      density += 4 * pi * s.pdf / kRays;
      const ScatteredRay ray = sample(lobes, at, uniform_point(i, 1), uniform_point(i, 2).x);
      if (ray.spread == Lobe::Spread::perfect) continue;
      weight += ray.weight.y / kRays;
      if (ray.weight != Color(0)) {
        EXPECT_NEAR(eval(lobes, at, ray.direction).pdf, ray.pdf, 1e-9 * ray.pdf) << c.name;
      }
    }
    for (const Lobe& lobe : lobes) {
      total += luminance(lobe.attenuation);
      if (lobe.spread != Lobe::Spread::perfect) spread_share += luminance(lobe.attenuation);
    }
    EXPECT_NEAR(density, spread_share / total, 0.03) << c.name;
    EXPECT_NEAR(value, weight, 0.03) << c.name;
  }
}

TEST(Materials, RefractionAndItsReverseCancel) {
  Interaction at{normalized(Vec3(0.6, 0.2, 0.7)), {0, 0, 1}, true, 1.5};
  const Vec3 inside = refracted(at);
  EXPECT_NEAR(std::hypot(inside.x, inside.y), std::hypot(at.to_viewer.x, at.to_viewer.y) / 1.5, 1e-12);
  const Vec3 outside = refracted({inside * -1.0, Vec3(0, 0, 1), true, 1 / 1.5});
  EXPECT_NEAR(glm::length(outside + at.to_viewer), 0, 1e-12);
  EXPECT_EQ(refracted({normalized(Vec3(1, 0, 0.3)), {0, 0, 1}, false, 1 / 1.5}), Vec3(0));
}

TEST(Materials, LuminairesShineOutwardAndFallOff) {
  Material lamp;
  lamp.kind = MaterialKind::luminaire;
  lamp.emission = Color(2, 3, 4);
  EXPECT_EQ(emitted(lamp, {{0, 0.6, 0.8}, {0, 0, 1}, true, 1}), Color(2, 3, 4));
  EXPECT_EQ(emitted(lamp, {{0, 0.6, 0.8}, {0, 0, 1}, false, 1}), Color(0));
  lamp.exponent = 2;
  EXPECT_NEAR(emitted(lamp, {{0, 0.6, 0.8}, {0, 0, 1}, true, 1}).x, 2 * 0.64, 1e-12);
}

}  // namespace
}  // namespace rayfarm
