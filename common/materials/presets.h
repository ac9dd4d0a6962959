#pragma once
// Measured constants of named materials.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rayfarm {

/// Complex index of refraction at one wavelength.
struct ConductorConstants {
  double n, k;
};
/// A metal's number, if it is known.
std::optional<uint32_t> find_conductor(const std::string& name);
ConductorConstants conductor_at(uint32_t metal, double wavelength_nm);
/// Where its constants were measured; between they are straight lines.
std::vector<double> conductor_wavelengths(uint32_t metal);
const std::vector<std::string>& conductor_names();

/// Index of refraction at 587.6 nm, and Abbe number.
struct DielectricConstants {
  double index, abbe;
};
std::optional<DielectricConstants> find_dielectric(const std::string& name);
const std::vector<std::string>& dielectric_names();

}  // namespace rayfarm
