#include "host/experiments/colour/linear_colour.h"

#include <functional>

namespace rayfarm {
namespace {

/// The value at a wavelength no greater than that of node `next`, and greater than of the one before.
double value_before(const LinearColour& colour, size_t next, double wavelength_nm) {
  if (next == colour.size()) return colour.back().value;
  if (next == 0 || colour[next].wavelength_nm == wavelength_nm) return colour[next].value;
  const SpectrumNode &a = colour[next - 1], &b = colour[next];
  return a.value +
         (wavelength_nm - a.wavelength_nm) / (b.wavelength_nm - a.wavelength_nm) * (b.value - a.value);
}

template <typename Operation>
LinearColour combined(const LinearColour& a, const LinearColour& b, Operation operation) {
  LinearColour result;
  result.reserve(a.size() + b.size());
  for (size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    const double nm = j == b.size() || (i < a.size() && a[i].wavelength_nm <= b[j].wavelength_nm)
                          ? a[i].wavelength_nm
                          : b[j].wavelength_nm;
    result.push_back({nm, operation(value_before(a, i, nm), value_before(b, j, nm))});
    if (i < a.size() && a[i].wavelength_nm == nm) ++i;
    if (j < b.size() && b[j].wavelength_nm == nm) ++j;
  }
  return result;
}

}  // namespace

LinearColour operator*(const LinearColour& a, const LinearColour& b) {
  return combined(a, b, std::multiplies<>());
}
LinearColour operator+(const LinearColour& a, const LinearColour& b) {
  return combined(a, b, std::plus<>());
}

}  // namespace rayfarm
