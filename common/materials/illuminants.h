#pragma once
// Lights of known spectra: the CIE's standard illuminants (CIE 15:2004, "Colorimetry", Table T.1).
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/materials/spectrum.h"

namespace rayfarm {

/// From 300 to 830 nm by 10, scaled so that its luminance is 1, as that of a flat spectrum of 1 is: A, of a
/// lamp with a filament at 2856 K; D65, of daylight; E, the same at all wavelengths. Nothing for other names.
std::optional<std::vector<SpectrumNode>> find_illuminant(std::string_view name);

std::vector<std::string> illuminant_names();

}  // namespace rayfarm
