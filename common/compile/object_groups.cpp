#include "common/compile/object_groups.h"

#include <ranges>
#include <unordered_map>

namespace rayfarm {
namespace {

/// Of what is tested as triangles, as spheres, and one by one.
size_t class_of(const PartPrimitives& primitives, uint32_t primitive) {
  return primitives.is_triangle(primitive)                           ? 0
         : primitives.ids[primitive].kind() == PrimitiveKind::sphere ? 1
                                                                     : 2;
}

template <typename Array>
uint32_t end_of(const Array& array) {
  return static_cast<uint32_t>(array.size());
}

/// The element with the object's bounds. Those of a group of one whose element has its own are of no use.
ObjectElement bounded(ObjectElement element, uint32_t object, const SceneDescription& description,
                      InUse& in_use) {
  element.bound = description.objects[object].bound;
  const bool has_element_own = element.children.size() == 1 && !element.children[0].bound.empty();
  element = without_idle_groups(std::move(element));
  if (!element.is_empty() && !has_element_own) in_use.bounds[object] = true;
  return element;
}

}  // namespace

ChildRef pack_objects(const PrimitiveGroup& group, std::span<const PrimitiveReference> references,
                      SceneArrays<GrowingArray>& arrays, std::vector<PlacedObject>& placed) {
  LeafArrays leaves{arrays.nodes, arrays.triangle_blocks, arrays.sphere_blocks, arrays.leaf_primitives};
  const auto ends = [&] {
    return std::array{end_of(arrays.triangle_blocks), end_of(arrays.sphere_blocks),
                      end_of(arrays.leaf_primitives)};
  };
  const std::array<uint32_t, 3> begin = ends();
  std::array<Box, 3> boxes;
  for (const GroupObject& object : group.objects) {
    if (object.count == 0) continue;
    std::array<std::vector<PrimitiveReference>, 3> classes;
    for (const PrimitiveReference& r : references.subspan(object.first, object.count)) {
      const size_t i = class_of(group.primitives, r.primitive);
      classes[i].push_back(r);
      boxes[i].grow(r.box());
    }
    PlacedObject& p = placed.emplace_back();
    p.object = object.object;
    for (size_t i = 0; i < 3; ++i)
      if (!classes[i].empty()) p.leaves[i] = pack_leaf(classes[i], group.primitives, arrays.spheres, leaves);
  }
  const std::array<uint32_t, 3> end = ends();
  constexpr std::array kinds{ChildKind::triangles, ChildKind::spheres, ChildKind::mixed};
  VolumeNode node = make_empty_node();
  size_t slot = 0;
  for (size_t i = 0; i < 3; ++i)
    if (end[i] > begin[i])
      set_child(node, slot++, boxes[i], make_child(kinds[i], begin[i], end[i] - begin[i]));
  if (slot == 1) return node.children[0];
  arrays.nodes.push_back(node);
  return make_child(ChildKind::inner, end_of(arrays.nodes) - 1);
}

ObjectElement element_of(const PrimitiveGroup& group, std::span<const PlacedObject> placed,
                         const SceneDescription& description, InUse& in_use) {
  // Parents stand before what is in them: from behind, each is whole when its parent takes it.
  std::vector<uint32_t> objects, parents;
  for (const GroupObject& g : group.objects)
    if (objects.empty() || objects.back() != g.object) {
      objects.push_back(g.object);
      parents.push_back(g.parent);
    }
  std::unordered_map<uint32_t, size_t> element_of_object;
  for (size_t i = objects.size(); i-- > 0;) element_of_object[objects[i]] = i;
  std::unordered_map<uint32_t, std::vector<size_t>> placed_of;
  for (size_t i = 0; i < placed.size(); ++i) placed_of[placed[i].object].push_back(i);
  std::vector<ObjectElement> elements(objects.size());
  for (size_t i = objects.size(); i-- > 0;) {
    // What is in it has been added, the last first.
    ObjectElement& element = elements[i];
    for (const size_t j : placed_of[objects[i]] | std::views::reverse)
      element.children.push_back({.leaves = placed[j].leaves});
    std::reverse(element.children.begin(), element.children.end());
    element = bounded(std::move(element), objects[i], description, in_use);
    const auto parent = element_of_object.find(parents[i]);
    if (i > 0 && !element.is_empty() && parent != element_of_object.end())
      elements[parent->second].children.push_back(std::move(element));
  }
  return std::move(elements[0]);
}

uint32_t build_scene_objects(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                             std::span<const uint32_t> object_of_node, std::span<const PlacedObject> placed,
                             const ObjectOptions& options, InUse& in_use) {
  std::vector<ObjectElement> elements(arrays.object_nodes.size());
  std::vector<std::vector<size_t>> placed_of(description.objects.size());
  for (size_t i = 0; i < placed.size(); ++i) placed_of[placed[i].object].push_back(i);
  std::vector<uint32_t> instance_of(arrays.object_nodes.size(), kNone);
  for (uint32_t i = 0; i < arrays.instances.size(); ++i) instance_of[arrays.instances[i].object_node] = i;
  for (size_t node = elements.size(); node-- > 0;) {
    // What is in it has been added, the last first.
    ObjectElement& element = elements[node];
    std::reverse(element.children.begin(), element.children.end());
    const uint32_t object = object_of_node[node], instance = instance_of[node];
    std::vector<ObjectElement> own;
    for (const size_t i : placed_of[object])
      own.push_back({.leaves = placed[i].leaves, .instance = instance_of[0]});
    const bool is_placed = node == 0 && !placed.empty();
    if (instance != kNone && arrays.instances[instance].moving == kNone && !is_placed)
      own.push_back({.instance = instance});
    element.children.insert(element.children.begin(), own.begin(), own.end());
    element = bounded(std::move(element), object, description, in_use);
    if (node > 0 && !element.is_empty())
      elements[arrays.object_nodes[node].parent].children.push_back(std::move(element));
  }
  if (elements.empty() || elements[0].is_empty()) return kNone;
  const double frame = description.frames ? (*description.frames)[0] : 0;
  const Vec3 eye(view_of(arrays).eval(arrays.header[0].view.location, frame));
  return build_bounding_tree(std::move(elements[0]), options, eye, arrays);
}

}  // namespace rayfarm
