#include "common/materials/presets.h"

#include <array>
#include <span>

namespace rayfarm {
namespace {

struct Constant {
  double wavelength_nm, n, k;
};

// H.-J. Hagemann, W. Gudat, C. Kunz, "Optical constants from the far infrared to the X-ray region: Mg, Al,
// Cu, Ag, Au, Bi, C, and Al2O3", DESY report SR-74/7, 1974, tables 3 and 5: the visible part.
constexpr std::array kAluminium{Constant{413.3, 0.548, 5.00}, Constant{495.9, 0.771, 5.91},
                                Constant{619.9, 1.292, 7.28}, Constant{688.8, 1.731, 7.96}};
constexpr std::array kCopper{Constant{442.8, 1.169, 2.36}, Constant{476.9, 1.152, 2.50},
                             Constant{516.6, 1.121, 2.60}, Constant{539.1, 1.037, 2.59},
                             Constant{563.6, 0.826, 2.60}, Constant{590.4, 0.468, 2.81},
                             Constant{619.9, 0.272, 3.24}, Constant{652.5, 0.214, 3.67}};
constexpr std::array kGold{Constant{442.8, 1.826, 1.81}, Constant{476.8, 1.541, 1.71},
                           Constant{516.6, 0.878, 2.01}, Constant{563.5, 0.613, 2.64},
                           Constant{619.9, 0.487, 3.31}, Constant{826.5, 0.418, 5.13}};
constexpr std::array kSilver{Constant{413.3, 0.226, 2.28}, Constant{495.9, 0.237, 3.09},
                             Constant{619.9, 0.269, 4.18}, Constant{826.6, 0.271, 5.80}};

Constant at_wavelength(std::span<const Constant> table, double wavelength_nm) {
  size_t i = 0;
  while (i + 2 < table.size() && table[i + 1].wavelength_nm < wavelength_nm) ++i;
  const Constant &a = table[i], &b = table[i + 1];
  const double part = (wavelength_nm - a.wavelength_nm) / (b.wavelength_nm - a.wavelength_nm);
  return {wavelength_nm, a.n + part * (b.n - a.n), a.k + part * (b.k - a.k)};
}

template <typename Value>
using Named = std::pair<std::string, Value>;

const std::array<Named<std::span<const Constant>>, 4> kConductors{
    {{"aluminium", kAluminium}, {"copper", kCopper}, {"gold", kGold}, {"silver", kSilver}}};

// Glass and flint: Schott's N-BK7 and SF11, from their catalogue. Water and ice: Hecht, Optics, table 4.1;
// diamond also; Abbe numbers from the indices at 486 and 656 nm (water: 1.3371, 1.3311;
// diamond: 2.4354, 2.4100).
const std::array<Named<DielectricConstants>, 5> kDielectrics{{{"diamond", {2.417, 55.8}},
                                                              {"flint", {1.7847, 25.76}},
                                                              {"glass", {1.5168, 64.17}},
                                                              {"ice", {1.309, 0}},
                                                              {"water", {1.333, 55.5}}}};

template <typename Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& [name, value] : table) names.push_back(name);
  return names;
}

}  // namespace

std::optional<uint32_t> find_conductor(const std::string& name) {
  for (uint32_t i = 0; i < kConductors.size(); ++i)
    if (kConductors[i].first == name) return i;
  return std::nullopt;
}
ConductorConstants conductor_at(uint32_t metal, double wavelength_nm) {
  const Constant c = at_wavelength(kConductors.at(metal).second, wavelength_nm);
  return {c.n, c.k};
}
std::vector<double> conductor_wavelengths(uint32_t metal) {
  std::vector<double> wavelengths;
  for (const Constant& c : kConductors.at(metal).second) wavelengths.push_back(c.wavelength_nm);
  return wavelengths;
}
const std::vector<std::string>& conductor_names() {
  static const std::vector<std::string> names = names_of(kConductors);
  return names;
}

std::optional<DielectricConstants> find_dielectric(const std::string& name) {
  for (const auto& [known, constants] : kDielectrics)
    if (known == name) return constants;
  return std::nullopt;
}
const std::vector<std::string>& dielectric_names() {
  static const std::vector<std::string> names = names_of(kDielectrics);
  return names;
}

}  // namespace rayfarm
