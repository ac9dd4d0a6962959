#pragma once
// Choice by importance among many: cumulative shares.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace rayfarm {

/// Makes weights the shares of all up to each, the last being 1; all alike if every weight is 0, or their sum
/// no number.
inline void accumulate_shares(std::span<double> weights) {
  double total = 0;
  for (double& w : weights) w = total += w;
  const bool has_sum = total > 0 && std::isfinite(total);
  for (size_t i = 0; i < weights.size(); ++i)
    weights[i] =
        has_sum ? weights[i] / total : static_cast<double>(i + 1) / static_cast<double>(weights.size());
}

/// The one whose step holds u in [0, 1). There must be one.
inline size_t choose_by_share(std::span<const double> shares, double u) {
  const auto found = std::upper_bound(shares.begin(), shares.end(), u) - shares.begin();
  return std::min(static_cast<size_t>(found), shares.size() - 1);
}

/// The probability of choosing `i`.
inline double share_of(std::span<const double> shares, size_t i) {
  return shares[i] - (i > 0 ? shares[i - 1] : 0);
}

}  // namespace rayfarm
