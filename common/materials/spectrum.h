#pragma once
// Colour by wavelengths (Shirley, Sung and Brown 1991, section 2.1): a spectrum is known at a few nodes and
// is a straight line between them. The renderer carries three channels a ray; here a channel is one node, and
// the picture is traced in as many passes as the nodes need.
#include <span>
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

/// `spectral`: at any nodes; without any given those that the scene's own colours have.
enum class ColourModel : uint8_t { rgb, meyer4, spectral20, spectral };

/// What is integrated of a spectrum, in nm.
inline constexpr double kFirstWavelength_nm = 380, kLastWavelength_nm = 730;
inline constexpr size_t kMostColourNodes = 500;

/// A spectrum is a list of them by rising wavelength: a straight line between two, constant beyond the ends.
struct SpectrumNode {
  double wavelength_nm = 0, value = 0;
};
double eval_spectrum(std::span<const SpectrumNode> spectrum, double wavelength_nm);
/// Its colour, linear Rec. 709, which can't show all: channels may be below 0. A flat spectrum of 1 is white.
Color rgb_of(std::span<const SpectrumNode> spectrum);

/// Up to three nodes that rays carry together.
struct ColourPass {
  bool is_rgb = true;                  ///< the channels are red, green and blue themselves
  Vec3 wavelengths_nm{630, 532, 465};  ///< a channel that no node needs repeats another
  Mat3 channels_from_rgb{1};           ///< the channels of a reflectance or light that is given as RGB
  Mat3 rgb_from_channels{1};           ///< what the channels add to the picture, linear Rec. 709
};

/// The passes that carry the nodes, rising wavelengths in nm that tell red, green and blue apart; without any
/// the one of RGB. `is_dispersive`: each wavelength goes its own way, so a pass has one node.
std::vector<ColourPass> make_passes(std::span<const double> nodes, bool is_dispersive);

/// The nodes of a model that has them fixed, in nm; none for the others.
std::vector<double> nodes_of(ColourModel model);
/// `count` of them, evenly spaced over what is integrated.
std::vector<double> even_nodes(size_t count);
/// What a list of nodes must be: rising, within what is integrated, no more than kMostColourNodes, and such
/// that an RGB colour has a spectrum on them.
bool are_colour_nodes(std::span<const double> nodes);

/// Corners of the spectra that RGB colours get.
inline constexpr double kBandCorners_nm[] = {470, 520, 570, 610};

/// Index of refraction at a wavelength: Cauchy's n = A + B / λ² through the index at 587.6 nm and the Abbe
/// number; 0: no dispersion.
double index_at(double index, double abbe, double wavelength_nm);

}  // namespace rayfarm
