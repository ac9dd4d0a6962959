#include "common/materials/illuminants.h"

#include "common/materials/scattering.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

constexpr double kFirst_nm = 300, kStep_nm = 10;
constexpr size_t kCount = 54;

/// Relative spectral power of D65.
constexpr double kD65[kCount] = {
    0.0341,  3.2945,  20.236,  37.0535, 39.9488, 44.9117, 46.6383, 52.0891, 49.9755, 54.6482, 82.7549,
    91.486,  93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354, 107.802,
    104.79,  107.689, 104.405, 104.046, 100,     96.3342, 95.788,  88.6856, 90.0062, 89.5991, 87.6987,
    83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349,  61.604,  69.8856,
    75.087,  63.5927, 46.4182, 66.8054, 63.3828, 64.304,  59.4519, 55.7054, 57.4406, 60.3125};

/// Planck's law in the constants of the illuminant's definition, 1 at 560 nm.
double power_of_a(double nm) {
  constexpr double kC2_nm_K = 1.435e7, kTemperature_K = 2848;
  const auto term = [](double at_nm) { return portable_exp(kC2_nm_K / (kTemperature_K * at_nm)) - 1; };
  const double ratio = 560 / nm, squared = ratio * ratio;
  return squared * squared * ratio * term(560) / term(nm);
}

}  // namespace

std::optional<std::vector<SpectrumNode>> find_illuminant(std::string_view name) {
  if (name != "A" && name != "D65" && name != "E") return std::nullopt;
  std::vector<SpectrumNode> nodes(kCount);
  for (size_t i = 0; i < kCount; ++i) {
    const double nm = kFirst_nm + kStep_nm * static_cast<double>(i);
    nodes[i] = {nm, name == "A" ? power_of_a(nm) : name == "D65" ? kD65[i] : 1};
  }
  const double scale = 1 / luminance(rgb_of(nodes));
  for (SpectrumNode& node : nodes) node.value *= scale;
  return nodes;
}

std::vector<std::string> illuminant_names() {
  return {"A", "D65", "E"};
}

}  // namespace rayfarm
