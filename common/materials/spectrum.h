#pragma once
// Colour by wavelengths (Shirley, Sung and Brown 1991, section 2.1): a spectrum is known at a few nodes and
// is a straight line between them. The renderer carries three channels a ray; here a channel is one node, and
// the picture is traced in as many passes as the nodes need.
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

enum class ColourModel : uint8_t { rgb, meyer4, spectral20 };

/// Up to three nodes that rays carry together.
struct ColourPass {
  bool is_rgb = true;                  ///< the channels are red, green and blue themselves
  Vec3 wavelengths_nm{630, 532, 465};  ///< a channel that no node needs repeats another
  Mat3 channels_from_rgb{1};           ///< the channels of a reflectance or light that is given as RGB
  Mat3 rgb_from_channels{1};           ///< what the channels add to the picture, linear Rec. 709
};

/// The passes of a colour model. `is_dispersive`: each wavelength goes its own way, so a pass has one node.
std::vector<ColourPass> make_passes(ColourModel model, bool is_dispersive);

/// The nodes of a model, in nm; none for RGB.
std::vector<double> nodes_of(ColourModel model);

/// Index of refraction at a wavelength: Cauchy's n = A + B / λ² through the index at 587.6 nm and the Abbe
/// number; 0: no dispersion.
double index_at(double index, double abbe, double wavelength_nm);

}  // namespace rayfarm
