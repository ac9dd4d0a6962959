#include "common/materials/spectrum.h"

#include <array>

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

constexpr double kFirst_nm = 380, kLast_nm = 730;

/// What each node adds to the picture: the matching functions under the straight lines between nodes. A flat
/// spectrum is white.
std::vector<Vec3> node_weights(const std::vector<double>& nodes) {
  std::vector<Vec3> weights(nodes.size(), Vec3(0));
  for (double nm = kFirst_nm + 0.5; nm < kLast_nm; ++nm) {
    const Vec3 rgb = rgb_from_xyz(color_matching(nm));
    size_t above = 0;
    while (above < nodes.size() && nodes[above] < nm) ++above;
    if (above == 0 || above == nodes.size()) {
      weights[above == 0 ? 0 : above - 1] += rgb;
      continue;
    }
    const double part = (nm - nodes[above - 1]) / (nodes[above] - nodes[above - 1]);
    weights[above - 1] += (1 - part) * rgb;
    weights[above] += part * rgb;
  }
  Vec3 white(0);
  for (const Vec3& w : weights) white += w;
  for (Vec3& w : weights) w /= white;
  return weights;
}

/// Three smooth bands whose sum is 1 everywhere, near to what looks red, green and blue.
Vec3 bands(double nm) {
  const double blue = 1 - smooth_step(470, 520, nm), red = smooth_step(570, 610, nm);
  return {red, 1 - red - blue, blue};
}

/// For each node the row that gives its value of an RGB colour. The colour of that spectrum is the RGB again.
std::vector<Vec3> node_rows(const std::vector<double>& nodes, const std::vector<Vec3>& weights) {
  Mat3 rgb_of_bands(0.0);  // columns: the colour of each band
  for (size_t i = 0; i < nodes.size(); ++i)
    for (int band = 0; band < 3; ++band) rgb_of_bands[band] += bands(nodes[i])[band] * weights[i];
  const Mat3 bands_of_rgb = glm::inverse(rgb_of_bands);
  std::vector<Vec3> rows;
  for (const double nm : nodes) rows.push_back(bands(nm) * bands_of_rgb);
  return rows;
}

}  // namespace

std::vector<double> nodes_of(ColourModel model) {
  switch (model) {
    case ColourModel::rgb:
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

std::vector<ColourPass> make_passes(ColourModel model, bool is_dispersive) {
  const std::vector<double> nodes = nodes_of(model);
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
