#include "common/lighting/light_choice.h"

#include <numbers>

#include "common/lighting/environment.h"
#include "common/materials/scattering.h"

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

double irradiance(const Scene& scene, const Light& light, double radius2) {
  switch (light.kind) {
    case LightKind::point:
    case LightKind::distant:
      return luminance(light.color) * pi;
    case LightKind::bulb:
    case LightKind::spot:
      return luminance(light.color) * brightest(scene, light) / radius2;
    case LightKind::environment:
      return luminance(scene.head().background *
                       mean_environment(scene.textures[scene.head().environment], scene.texels)) *
             pi;
    case LightKind::luminaire:
      return luminance(scene.materials[light.material].emission) * luminaire_area(scene, light) / radius2;
  }
  return 0;
}

}  // namespace

std::vector<double> make_light_shares(const Scene& scene, double radius) {
  std::vector<double> shares;
  double total = 0;
  for (const Light& light : scene.lights)
    shares.push_back(total += irradiance(scene, light, radius * radius));
  for (size_t i = 0; i < shares.size(); ++i)
    shares[i] =
        total > 0 ? shares[i] / total : static_cast<double>(i + 1) / static_cast<double>(shares.size());
  return shares;
}

uint32_t choose_light(const Scene& scene, double u) {
  const auto& shares = scene.light_shares;
  const auto found = std::upper_bound(shares.begin(), shares.end(), u) - shares.begin();
  return static_cast<uint32_t>(std::min<ptrdiff_t>(found, static_cast<ptrdiff_t>(shares.size()) - 1));
}

double choice_probability(const Scene& scene, uint32_t light) {
  return scene.light_shares[light] - (light > 0 ? scene.light_shares[light - 1] : 0.0);
}

}  // namespace rayfarm
