#pragma once
// Colours of the scene that are given as spectra: plain data. Beside each its RGB stands where it is used,
// for the RGB colour model; a pass of another puts the spectrum's values in its place.
#include <cstdint>

#include "common/materials/spectrum.h"

namespace rayfarm {

/// Whose colour it is: of a material or a medium the member of that name.
enum class SpectralField : uint32_t {
  color,
  filter,
  interior,
  back,
  through,
  emission,
  n,
  k,
  light,
  background,
  ambient,
  absorption,
  scattering
};

inline bool is_of_material(SpectralField field) {
  return field < SpectralField::light;
}

struct SpectralColor {
  SpectralField field = SpectralField::color;
  uint32_t index = 0;  ///< of the material, light or medium
  uint32_t first_node = 0, node_count = 0;
};

}  // namespace rayfarm
