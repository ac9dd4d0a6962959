#include "host/experiments/hierarchies/unit_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace rayfarm {
namespace {

using Row = std::array<double, 3>;

Row row_of(const RayCosts& ray) {
  return {ray.volumes / ray.ns, ray.primitives / ray.ns, 1 / ray.ns};
}

/// The least squares of rows · x = 1 with x = 0 where `used` has no bit; nothing if the rows don't tell.
std::optional<Row> solve(std::span<const RayCosts> rays, unsigned used) {
  std::array<std::array<double, 4>, 3> m{};  // the normal equations
  for (const RayCosts& ray : rays) {
    const Row row = row_of(ray);
    for (size_t i = 0; i < 3; ++i) {
      for (size_t k = 0; k < 3; ++k) m[i][k] += row[i] * row[k];
      m[i][3] += row[i];
    }
  }
  // In units in which all unknowns weigh the same, so that what is left of a pivot tells about the rows.
  Row unit{1, 1, 1};
  for (size_t i = 0; i < 3; ++i)
    if (m[i][i] > 0) unit[i] = std::sqrt(m[i][i]);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t k = 0; k < 3; ++k) m[i][k] /= unit[i] * unit[k];
    m[i][3] /= unit[i];
  }
  for (size_t i = 0; i < 3; ++i)
    if (!(used >> i & 1)) {
      for (size_t k = 0; k < 3; ++k) m[i][k] = m[k][i] = 0;
      m[i] = {};
      m[i][i] = 1;
    }
  for (size_t i = 0; i < 3; ++i) {
    const auto pivot =
        std::max_element(m.begin() + static_cast<ptrdiff_t>(i), m.end(),
                         [&](const auto& a, const auto& b) { return std::abs(a[i]) < std::abs(b[i]); });
    std::swap(m[i], *pivot);
    if (std::abs(m[i][i]) < 1e-12) return std::nullopt;
    for (size_t j = 0; j < 3; ++j) {
      if (j == i) continue;
      const double factor = m[j][i] / m[i][i];
      for (size_t k = i; k < 4; ++k) m[j][k] -= factor * m[i][k];
    }
  }
  return Row{m[0][3] / m[0][0] / unit[0], m[1][3] / m[1][1] / unit[1], m[2][3] / m[2][2] / unit[2]};
}

}  // namespace

UnitTimes fit_unit_times(std::span<const RayCosts> rays) {
  UnitTimes best;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned used = 1; used < 8; ++used) {
    const auto x = solve(rays, used);
    if (!x || std::any_of(x->begin(), x->end(), [](double t) { return t < 0; })) continue;
    const UnitTimes times{(*x)[0], (*x)[1], (*x)[2]};
    double sum = 0;
    for (const RayCosts& ray : rays) sum += std::pow(times.ns(ray) / ray.ns - 1, 2);
    if (sum < least) {
      least = sum;
      best = times;
    }
  }
  return best;
}

double largest_error(std::span<const RayCosts> rays, const UnitTimes& times) {
  double error = 0;
  for (const RayCosts& ray : rays) error = std::max(error, std::abs(times.ns(ray) / ray.ns - 1));
  return error;
}

}  // namespace rayfarm
