#pragma once
// Items (Weghorst, Hooper and Greenberg 1984, Table I and section 4): what an item buffer names, and whether
// rays hit one of them. Where the hierarchy is one of objects an item is an object with all its primitives,
// as theirs; elsewhere it is a primitive.
#include "common/hierarchy/frame_state.h"
#include "common/hierarchy/hit.h"

namespace rayfarm {

struct Item {
  uint32_t instance = kNone;  ///< none: there is no item
  uint32_t bits = 0;          ///< of a PrimitivePointer; of an object 3 << 30 | its node in bounding_nodes

  bool is_there() const { return instance != kNone; }
  bool is_object() const { return bits >> 30 == 3; }
  uint32_t node() const { return bits & 0x3fffffffu; }
  PrimitivePointer primitive() const { return {bits}; }
  bool operator==(const Item&) const = default;
};
inline Item make_item(uint32_t instance, PrimitivePointer primitive) {
  return {instance, primitive.bits};
}
inline Item make_object_item(uint32_t instance, uint32_t node) {
  return {instance, 3u << 30 | node};
}

/// The closest hit of a ray in (0, ray.t_max] on these items alone: the one that closest_hit gives, to the
/// last bit, if it is on one of them.
Hit closest_hit_among(const Scene& scene, const Pose& pose, std::span<const Item> items, const Ray& ray);

/// True if the ray hits the item in (0, ray.t_max).
bool hits_item(const Scene& scene, const Pose& pose, const Item& item, const Ray& ray);

}  // namespace rayfarm
