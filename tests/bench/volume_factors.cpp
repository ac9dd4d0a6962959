// Prints what a test of each kind of bounding volume costs, beside the factor in use (`rayfarm experiment
// bounding-volumes` writes the same into its page).
//
//   volume_factors
#include "host/experiments/bounding-volumes/volume_factors.h"

#include <fmt/format.h>

int main() {
  using namespace rayfarm;
  const auto factors = measure_volume_factors(15);
  for (size_t kind = 0; kind < kVolumeKinds; ++kind)
    fmt::print("{:<9} {:5.1f} ns, {:2.0f} % of tests hit; the factor in use is {}\n", kVolumeKindNames[kind],
               factors[kind].ns, 100 * factors[kind].hit_share, kVolumeFactors[kind]);
}
