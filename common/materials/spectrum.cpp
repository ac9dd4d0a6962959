#include "common/materials/spectrum.h"

#include <algorithm>

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

/// The CIE 1931 colour matching functions, fitted by Gaussians (Wyman, Sloan, Shirley 2013, "Simple analytic
/// approximations to the CIE XYZ color matching functions").
Vec3 color_matching(double nm) {
  const auto lobe = [nm](double peak, double height, double below, double above) {
    const double t = (nm - peak) / (nm < peak ? below : above);
    return height * portable_exp(-0.5 * t * t);
  };
  return {lobe(599.8, 1.056, 37.9, 31.0) + lobe(442.0, 0.362, 16.0, 26.7) + lobe(501.1, -0.065, 20.4, 26.2),
          lobe(568.8, 0.821, 46.9, 40.5) + lobe(530.9, 0.286, 16.3, 31.1),
          lobe(437.0, 1.217, 11.8, 36.0) + lobe(459.0, 0.681, 26.0, 13.8)};
}

/// Linear Rec. 709 from XYZ (IEC 61966-2-1), by rows.
Vec3 rgb_from_xyz(const Vec3& xyz) {
  return {3.2406 * xyz.x - 1.5372 * xyz.y - 0.4986 * xyz.z, -0.9689 * xyz.x + 1.8758 * xyz.y + 0.0415 * xyz.z,
          0.0557 * xyz.x - 0.2040 * xyz.y + 1.0570 * xyz.z};
}

/// Calls visit(nm, what a colour gets of a spectrum's value there), nanometre by nanometre.
template <typename Visitor>
void integrate(Visitor visit) {
  for (double nm = kFirstWavelength_nm + 0.5; nm < kLastWavelength_nm; ++nm)
    visit(nm, rgb_from_xyz(color_matching(nm)));
}

/// What each node adds to the picture: the matching functions under the straight lines between nodes. A flat
/// spectrum is white.
std::vector<Vec3> node_weights(std::span<const double> nodes) {
  std::vector<Vec3> weights(nodes.size(), Vec3(0));
  integrate([&](double nm, const Vec3& rgb) {
    size_t above = 0;
    while (above < nodes.size() && nodes[above] < nm) ++above;
    if (above == 0 || above == nodes.size()) {
      weights[above == 0 ? 0 : above - 1] += rgb;
      return;
    }
    const double part = (nm - nodes[above - 1]) / (nodes[above] - nodes[above - 1]);
    weights[above - 1] += (1 - part) * rgb;
    weights[above] += part * rgb;
  });
  Vec3 white(0);
  for (const Vec3& w : weights) white += w;
  for (Vec3& w : weights) w /= white;
  return weights;
}

/// Three smooth bands whose sum is 1 everywhere, near to what looks red, green and blue.
Vec3 bands(double nm) {
  const auto& corner = kBandCorners_nm;
  const double blue = 1 - smooth_step(corner[0], corner[1], nm), red = smooth_step(corner[2], corner[3], nm);
  return {red, 1 - red - blue, blue};
}

/// By columns.
Mat3 rgb_of_bands(std::span<const double> nodes, std::span<const Vec3> weights) {
  Mat3 rgb(0.0);
  for (size_t i = 0; i < nodes.size(); ++i)
    for (int band = 0; band < 3; ++band) rgb[band] += bands(nodes[i])[band] * weights[i];
  return rgb;
}

/// For each node the row that gives its value of an RGB colour. The colour of that spectrum is the RGB again.
std::vector<Vec3> node_rows(std::span<const double> nodes, std::span<const Vec3> weights) {
  const Mat3 bands_of_rgb = glm::inverse(rgb_of_bands(nodes, weights));
  std::vector<Vec3> rows;
  for (const double nm : nodes) rows.push_back(bands(nm) * bands_of_rgb);
  return rows;
}

}  // namespace

double eval_spectrum(std::span<const SpectrumNode> spectrum, double wavelength_nm) {
  if (wavelength_nm <= spectrum.front().wavelength_nm) return spectrum.front().value;
  const auto above =
      std::lower_bound(spectrum.begin(), spectrum.end(), wavelength_nm,
                       [](const SpectrumNode& node, double nm) { return node.wavelength_nm < nm; });
  if (above == spectrum.end()) return spectrum.back().value;
  const SpectrumNode &a = *(above - 1), &b = *above;
  return a.value +
         (wavelength_nm - a.wavelength_nm) / (b.wavelength_nm - a.wavelength_nm) * (b.value - a.value);
}

Color rgb_of(std::span<const SpectrumNode> spectrum) {
  Color sum(0), white(0);
  integrate([&](double nm, const Vec3& rgb) {
    sum += eval_spectrum(spectrum, nm) * rgb;
    white += rgb;
  });
  return sum / white;
}

std::vector<double> nodes_of(ColourModel model) {
  switch (model) {
    case ColourModel::rgb:
    case ColourModel::spectral:
      return {};
    case ColourModel::meyer4:  // Meyer 1988, "Wavelength selection for synthetic image generation"
      return {456.4, 490.9, 557.7, 631.4};
    case ColourModel::spectral20:
      break;
  }
  std::vector<double> nodes;
  for (int i = 0; i < 20; ++i) nodes.push_back(400 + 300.0 / 19 * i);
  return nodes;
}

std::vector<double> even_nodes(size_t count) {
  std::vector<double> nodes;
  for (size_t i = 0; i < count; ++i)
    nodes.push_back(kFirstWavelength_nm + (kLastWavelength_nm - kFirstWavelength_nm) *
                                              static_cast<double>(i) / static_cast<double>(count - 1));
  return nodes;
}

bool are_colour_nodes(std::span<const double> nodes) {
  if (nodes.size() < 3 || nodes.size() > kMostColourNodes) return false;
  double below = -1;
  for (const double nm : nodes) {
    if (!(nm > below && nm >= kFirstWavelength_nm && nm <= kLastWavelength_nm)) return false;
    below = nm;
  }
  // White is a sum of the bands' colours: where they lie nearly in a plane, or one is missing, no sum of them
  // is red, green or blue without a band far above 1.
  constexpr double kLeastVolume = 0.01;
  return glm::determinant(rgb_of_bands(nodes, node_weights(nodes))) > kLeastVolume;
}

std::vector<ColourPass> make_passes(std::span<const double> nodes, bool is_dispersive) {
  if (nodes.empty()) return {ColourPass{}};
  const std::vector<Vec3> weights = node_weights(nodes), rows = node_rows(nodes, weights);
  const size_t passes = is_dispersive ? nodes.size() : (nodes.size() + 2) / 3;
  std::vector<ColourPass> result;
  for (size_t p = 0; p < passes; ++p) {
    const size_t begin = p * nodes.size() / passes, end = (p + 1) * nodes.size() / passes;
    ColourPass pass;
    pass.is_rgb = false;
    for (int channel = 0; channel < 3; ++channel) {
      const size_t node = std::min(begin + static_cast<size_t>(channel), end - 1);
      pass.wavelengths_nm[channel] = nodes[node];
      for (int c = 0; c < 3; ++c) pass.channels_from_rgb[c][channel] = rows[node][c];
      pass.rgb_from_channels[channel] = begin + static_cast<size_t>(channel) < end ? weights[node] : Vec3(0);
    }
    result.push_back(pass);
  }
  return result;
}

double index_at(double index, double abbe, double wavelength_nm) {
  if (!(abbe > 0)) return index;
  // V = (n_d - 1) / (n_F - n_C) at 587.6, 486.1 and 656.3 nm.
  constexpr double d2 = 587.6 * 587.6, per_f = 1 / (486.1 * 486.1), per_c = 1 / (656.3 * 656.3);
  const double b = (index - 1) / (abbe * (per_f - per_c));
  return index + b * (1 / (wavelength_nm * wavelength_nm) - 1 / d2);
}

}  // namespace rayfarm
