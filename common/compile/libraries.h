#pragma once
// Parts of libraries join those of a scene: their arrays are appended, nothing is built.
#include "common/compile/luminaires.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Where a library's parts stand in the scene.
struct PlacedLibrary {
  uint32_t first_part = 0;
  std::vector<std::vector<Luminous>> luminous_of;  ///< of each of its parts
};

/// Appends the library's geometry. `place`: of its use, for what is said of its lamps.
PlacedLibrary append_library(SceneArrays<GrowingArray>& arrays, const LibraryDescription& library,
                             const Place& place, Luminaires& luminaires);

}  // namespace rayfarm
