#pragma once
// What a test of each kind of bounding volume costs on this machine: the factors by which `--bounds best`
// chooses (Weghorst, Hooper and Greenberg 1984, section 2: "a factor that is indicative of the relative
// complexity of its intersection test").
#include <array>

#include "common/hierarchy/bounding_volumes.h"

namespace rayfarm {

inline constexpr std::array kVolumeKindNames{"sphere", "box", "cylinder", "slabs"};

struct VolumeFactor {
  double ns = 0;         ///< of a test, the least of several rounds
  double hit_share = 0;  ///< of the tests
};

/// By VolumeKind. Each kind is fitted to the same 256 sets of points, and met by the same rays, of which
/// about half hit the sphere.
std::array<VolumeFactor, kVolumeKinds> measure_volume_factors(int rounds);

}  // namespace rayfarm
