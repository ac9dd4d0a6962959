#pragma once
// Objects and groups of the scene to what a hierarchy of objects is built of.
#include "common/compile/parts.h"
#include "common/hierarchy/bounding_tree.h"

namespace rayfarm {

/// Packs the primitives of a group object by object, each into leaves of its own, and tells where they are.
/// Returns a leaf, or a node of leaves, of all of them.
ChildRef pack_objects(const PrimitiveGroup& group, std::span<const PrimitiveReference> references,
                      SceneArrays<GrowingArray>& arrays, std::vector<PlacedObject>& placed);

/// The objects of a group as they lie in each other. Here and below: notes in `in_use` whose bounds they
/// have.
ObjectElement element_of(const PrimitiveGroup& group, std::span<const PlacedObject> placed,
                         const SceneDescription& description, InUse& in_use);

/// Builds the tree over all that never moves in the scene: `placed`, objects of the scene's own part, and
/// instances of other parts; as their nodes lie in each other, of which `object_of_node` has the objects.
/// Returns its index, kNone if there is nothing. Poses must be there.
uint32_t build_scene_objects(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                             std::span<const uint32_t> object_of_node, std::span<const PlacedObject> placed,
                             const ObjectOptions& options, InUse& in_use);

}  // namespace rayfarm
