#pragma once
// Parts: primitives that never move against each other, and the hierarchy below them.
#include "common/description/scene_description.h"
#include "common/hierarchy/structurer.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Primitives of a part that are to be one collection.
struct PrimitiveGroup {
  PartPrimitives primitives{};
  size_t parent = 0;           ///< the group that it is in; of the first, which is the part's own, itself
  uint32_t structure = kNone;  ///< kNone: as asked for on the command line
};

/// Builds the hierarchies of a part, of whose groups some are not empty, with their leaves in `arrays`. Notes
/// in `is_used` of which structures there is anything. Throws Stopped.
Part build_part(SceneArrays<GrowingArray>& arrays, std::vector<PrimitiveGroup>& groups,
                std::span<const StructureDescription> structures, const BuildOptions& options,
                std::vector<bool>& is_used);

}  // namespace rayfarm
