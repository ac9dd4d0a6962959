#pragma once
#include <optional>

namespace rayfarm {

struct BakeOptions {
  /// What vertices of a .glb show is radiance times 2 to this; empty: 0.
  std::optional<double> exposure_stops;
};

}  // namespace rayfarm
