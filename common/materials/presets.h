#pragma once
// Measured constants of named materials.
#include <optional>
#include <string>
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

/// Complex index of refraction at 630, 532 and 465 nm, the dominant wavelengths of the three channels.
struct ConductorConstants {
  Color n, k;
};
std::optional<ConductorConstants> find_conductor(const std::string& name);
const std::vector<std::string>& conductor_names();

/// Index of refraction at 589 nm.
std::optional<double> find_dielectric(const std::string& name);
const std::vector<std::string>& dielectric_names();

}  // namespace rayfarm
