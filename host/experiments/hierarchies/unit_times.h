#pragma once
// What a step and a test cost (thesis, Equations 4.4 and 4.5): a ray's time is N_V · T_N + N_P · T_P + T_O,
// of N_V volumes visited and N_P primitives tested.
#include <span>

namespace rayfarm {

struct RayCosts {
  double volumes, primitives;  ///< N_V and N_P
  double ns;                   ///< measured
};

struct UnitTimes {
  double step_ns = 0, test_ns = 0, overhead_ns = 0;  ///< T_N, T_P, T_O
  double ns(const RayCosts& ray) const {
    return ray.volumes * step_ns + ray.primitives * test_ns + overhead_ns;
  }
};

/// Those that foretell the times best: with the least sum of squares of relative errors among times that are
/// not negative.
UnitTimes fit_unit_times(std::span<const RayCosts> rays);

/// The largest error of a prediction, as a share of what was measured.
double largest_error(std::span<const RayCosts> rays, const UnitTimes& times);

}  // namespace rayfarm
