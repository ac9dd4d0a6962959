#pragma once
// Parts: primitives that never move against each other, and the hierarchy below them.
#include "common/description/scene_description.h"
#include "common/hierarchy/structurer.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// The primitives of one object, or one of the shapes that stand in the scene itself, among those of a group.
struct GroupObject {
  uint32_t object = kNone;
  uint32_t parent = kNone;        ///< the object that it is in, if that is of the group, too; else kNone
  uint32_t first = 0, count = 0;  ///< in ids
};

/// Primitives of a part that are to be one collection.
struct PrimitiveGroup {
  PartPrimitives primitives{};
  size_t parent = 0;           ///< the group that it is in; of the first, which is the part's own, itself
  uint32_t structure = kNone;  ///< kNone: as asked for on the command line
  uint32_t owner = kNone;      ///< the object that chose the structure
  uint32_t owner_in = kNone;   ///< and the one that it is in
  std::vector<GroupObject> objects{};  ///< parents before what is in them, as they follow each other in ids
};

/// Where the primitives of an object of the scene's own part have gone.
struct PlacedObject {
  uint32_t object = kNone;
  std::array<ChildRef, 3> leaves{};
};

/// What of a description has come to be used: structures, and bounds by object.
struct InUse {
  std::vector<bool> structures, bounds;
};

/// Builds the hierarchies of a part, of whose groups some are not empty, with their leaves in `arrays`. Notes
/// in `in_use` what is arranged. `placed`: if not null, and the part's own collection
/// is to be arranged by objects, it becomes a list, and its objects are told. Throws Stopped.
Part build_part(SceneArrays<GrowingArray>& arrays, std::vector<PrimitiveGroup>& groups,
                const SceneDescription& description, const BuildOptions& options, InUse& in_use,
                std::vector<PlacedObject>* placed);

}  // namespace rayfarm
