#include "common/lighting/light_choice.h"

#include <numbers>

#include "common/lighting/environment.h"
#include "common/materials/scattering.h"
#include "common/sampling/shares.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// The largest value of a light's diagram; 1 if it has none.
double brightest(const Scene& scene, const Light& light) {
  if (light.diagram == kNone) return 1;
  const GoniometricDiagram& d = scene.goniometric_diagrams[light.diagram];
  const auto values =
      scene.goniometric_values.subspan(d.first_value, values_of(d.vertical_count, d.horizontal_count))
          .subspan(d.vertical_count + d.horizontal_count);
  return *std::max_element(values.begin(), values.end());
}

LightPower power_of(const Scene& scene, const Light& light) {
  switch (light.kind) {
    case LightKind::point:
    case LightKind::distant:
      return {luminance(light.color) * pi, false};
    case LightKind::bulb:
    case LightKind::spot:
      return {luminance(light.color) * brightest(scene, light)};
    case LightKind::environment:
      return {luminance(scene.head().background *
                        mean_environment(scene.textures[scene.head().environment], scene.texels)) *
                  pi,
              false};
    case LightKind::luminaire:
      return {luminance(scene.materials[light.material].emission) * luminaire_area(scene, light)};
  }
  return {};
}

}  // namespace

std::vector<LightPower> light_powers(const Scene& scene) {
  std::vector<LightPower> powers;
  for (const Light& light : scene.lights) powers.push_back(power_of(scene, light));
  return powers;
}

std::vector<double> make_light_shares(std::span<const LightPower> powers, double radius) {
  std::vector<double> shares;
  for (const LightPower& power : powers)
    shares.push_back(power.falls ? power.irradiance / (radius * radius) : power.irradiance);
  accumulate_shares(shares);
  return shares;
}

uint32_t choose_light(const Scene& scene, double u) {
  return static_cast<uint32_t>(choose_by_share(scene.light_shares, u));
}

double choice_probability(const Scene& scene, uint32_t light) {
  return share_of(scene.light_shares, light);
}

}  // namespace rayfarm
