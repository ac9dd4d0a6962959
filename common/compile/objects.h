#pragma once
// The object tree: which objects are one part, where instances of parts stand, and the boxes over them.
#include <map>
#include <vector>

#include "common/description/scene_description.h"
#include "common/hierarchy/builder.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Stores the curve; returns its index.
uint32_t add_curve(SceneArrays<GrowingArray>& arrays, const Curve& curve);

/// An object whose primitives belong to a part, and the one that it is in.
struct FixedObject {
  uint32_t object = 0;
  size_t parent = 0;  ///< its place in the list; the first is its own
};

/// The objects by parts: lists of those whose primitives are one part, which moves with the first. Parents
/// stand before what is in them. In one with the root, or with an object that has a structure, are those that
/// stand once in it with no transform on the way to them: they never move against each other. What changes
/// its shape stands alone. `is_library`: the root is an object as others.
std::vector<std::vector<FixedObject>> objects_by_parts(const SceneDescription& description, bool is_library);

/// Expands the graph of objects to a tree (thesis 4.3.2), with an instance of each object's part and its
/// lights. What is visible in no frame is left out.
class ObjectTree {
 public:
  /// `part_of`: of each object, kNone if it has no primitives. All must outlive the tree.
  ObjectTree(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
             std::span<const uint32_t> part_of, std::stop_token stop)
      : arrays_(arrays), description_(description), part_of_(part_of), stop_(std::move(stop)) {}
  /// Returns where each light comes from that it adds. Throws Stopped, and InputError if there are too many.
  std::vector<Place> expand() {
    expand({description_.root, {}, {}, {}}, kNone, {});
    return std::move(light_places_);
  }
  /// By node.
  std::span<const uint32_t> objects() const { return objects_; }

 private:
  /// What a frame changes on the way from the root to a node.
  struct Changes {
    bool moves = false, comes_and_goes = false;
  };
  void expand(const ChildDescription& child, uint32_t parent, Changes changes);
  void add_light(const LightDescription& light, uint32_t node, bool moves);
  uint32_t curve_of(const Curve& curve);

  SceneArrays<GrowingArray>& arrays_;
  const SceneDescription& description_;
  std::span<const uint32_t> part_of_;
  std::stop_token stop_;
  std::map<const Curve*, uint32_t> curve_ids_;
  std::vector<Place> light_places_;
  std::vector<uint32_t> objects_;
};

/// Places of all lights and poses of all instances at the scene's first frame, and the boxes over them: over
/// those that never change, and over those that do, which are refitted for each frame. Throws InputError if
/// there is no such pose.
void build_object_part(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                       const std::stop_token& stop);

}  // namespace rayfarm
