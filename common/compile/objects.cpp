#include "common/compile/objects.h"

#include <stdexcept>

#include "common/compile/deforming.h"
#include "common/compile/spectra.h"
#include "common/errors/input_error.h"
#include "common/hierarchy/frame_state.h"

namespace rayfarm {
namespace {

/// How often long loops ask whether to stop.
constexpr size_t kObjectsPerLook = 1 << 14;

/// Some of the instances, for the builder.
class InstanceSource : public PrimitiveSource {
 public:
  InstanceSource(std::span<const InstancePose> poses, std::span<const uint32_t> instances)
      : poses_(poses), instances_(instances) {}
  size_t size() const override { return instances_.size(); }
  Box bounds(uint32_t i) const override { return poses_[instances_[i]].bounds; }
  Box clipped(uint32_t i, const Box& cell) const override { return intersection(bounds(i), cell); }

 private:
  std::span<const InstancePose> poses_;
  std::span<const uint32_t> instances_;
};

}  // namespace

uint32_t add_curve(SceneArrays<GrowingArray>& arrays, const Curve& curve) {
  const auto first = static_cast<uint32_t>(arrays.key_frames.size()),
             first_value = static_cast<uint32_t>(arrays.key_values.size());
  arrays.key_frames.insert(arrays.key_frames.end(), curve.frames.begin(), curve.frames.end());
  arrays.key_values.insert(arrays.key_values.end(), curve.values.begin(), curve.values.end());
  arrays.curves.push_back({static_cast<uint32_t>(curve.interpolation), first,
                           static_cast<uint32_t>(curve.frames.size()), first_value});
  return static_cast<uint32_t>(arrays.curves.size() - 1);
}

std::vector<std::vector<FixedObject>> objects_by_parts(const SceneDescription& description, bool is_library) {
  const std::vector<ObjectDescription>& objects = description.objects;
  std::vector<uint32_t> uses(objects.size()), fixed_in(objects.size(), kNone);
  std::vector<char> is_deforming;
  for (const ObjectDescription& object : objects) {
    is_deforming.push_back(changes_shape(description, object));
    for (const ChildDescription& child : object.children) ++uses[child.object];
  }
  for (uint32_t i = 0; i < objects.size(); ++i)
    for (const ChildDescription& child : objects[i].children)
      if (child.transform.empty() && !child.visible && uses[child.object] == 1 &&
          !objects[child.object].built && !is_deforming[child.object])
        fixed_in[child.object] = i;
  const auto takes_in = [&](uint32_t object) {
    return !is_deforming[object] &&
           (objects[object].structure != kNone || (object == description.root && !is_library));
  };
  std::vector<std::vector<FixedObject>> parts;
  const auto add = [&](uint32_t owner, bool is_with_others) {
    std::vector<FixedObject>& part = parts.emplace_back(1, FixedObject{owner});
    if (!is_with_others) return;
    for (size_t i = 0; i < part.size(); ++i) {  // grows while it is read
      const uint32_t object = part[i].object;
      for (const ChildDescription& child : objects[object].children)
        if (fixed_in[child.object] == object) part.push_back({child.object, i});
    }
  };
  add(description.root, takes_in(description.root));
  for (uint32_t i = 0; i < objects.size(); ++i) {
    if (i == description.root) continue;
    bool is_taken = false;
    for (uint32_t above = fixed_in[i]; above != kNone && !is_taken; above = fixed_in[above])
      is_taken = takes_in(above);
    if (!is_taken) add(i, takes_in(i));
  }
  return parts;
}

void ObjectTree::expand(const ChildDescription& child, uint32_t parent, Changes changes) {
  ObjectNode node;
  node.parent = parent;
  node.first_step = static_cast<uint32_t>(arrays_.steps.size());
  node.step_count = static_cast<uint32_t>(child.transform.size());
  for (const TransformStep& step : child.transform) {
    arrays_.steps.push_back({static_cast<uint32_t>(step.kind), curve_of(step.curve), step.axis, step.matrix});
    changes.moves = changes.moves || step.curve.is_animated();
  }
  const uint32_t part = part_of_[child.object];
  if (child.visible) {
    const auto shows = [](const Vec4& value) { return value.x != 0; };
    const std::vector<Vec4>& values = child.visible->values;
    if (std::none_of(values.begin(), values.end(), shows)) return;
    if (!std::all_of(values.begin(), values.end(), shows)) {
      node.visible = curve_of(*child.visible);
      changes.comes_and_goes = true;
    }
  }
  const ObjectDescription& object = description_.objects[child.object];
  const auto index = static_cast<uint32_t>(arrays_.object_nodes.size());
  arrays_.object_nodes.push_back(node);
  objects_.push_back(child.object);
  if (part != kNone) {
    Instance instance{index, part};
    if (changes.moves || changes.comes_and_goes || part < arrays_.deforming_parts.size()) {
      instance.moving = static_cast<uint32_t>(arrays_.moving_instances.size());
      arrays_.moving_instances.push_back(static_cast<uint32_t>(arrays_.instances.size()));
    }
    arrays_.instances.push_back(instance);
  }
  if (index % kObjectsPerLook == 0) throw_if_stopped(stop_);
  for (const LightDescription& light : object.lights) add_light(light, index, changes.moves);
  for (const ChildDescription& grandchild : object.children) expand(grandchild, index, changes);
}

void ObjectTree::add_light(const LightDescription& light, uint32_t node, bool moves) {
  if (arrays_.lights.size() >= limits::kLights)
    throw InputError(
        description_.source(light.place),
        fmt::format(
            "the scene has more than {} lights, those of each copy of an object counted; use fewer copies, "
            "or make lamps of luminous spheres and polygons",
            limits::kLights));
  const auto index = static_cast<uint32_t>(arrays_.lights.size());
  add_spectra(arrays_, light.spectra, index);
  arrays_.lights.push_back(light.light);
  arrays_.lights.back().object_node = node;
  if (moves) arrays_.lights.back().moving = static_cast<uint32_t>(arrays_.object_lights.size());
  arrays_.object_lights.push_back({light.light, node, index});
  light_places_.push_back(light.place);
}

/// Shared objects repeat their curves in every copy; each is stored once.
uint32_t ObjectTree::curve_of(const Curve& curve) {
  const auto found = curve_ids_.find(&curve);
  if (found != curve_ids_.end()) return found->second;
  return curve_ids_[&curve] = add_curve(arrays_, curve);
}

void build_object_part(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                       const std::stop_token& stop) {
  const double frame = description.frames ? (*description.frames)[0] : 0;
  std::vector<uint32_t> fixed;
  try {
    const Scene scene = view_of(arrays);
    const std::vector<Affine> world = world_transforms(scene, frame);
    const std::vector<char> visible = visible_nodes(scene, frame);
    for (Light& light : arrays.lights)
      if (light.object_node != kNone)
        static_cast<LightPlace&>(light) = make_light_place(light, world[light.object_node]);
    for (uint32_t i = 0; i < arrays.instances.size(); ++i) {
      const Instance& instance = arrays.instances[i];
      arrays.poses.push_back(make_instance_pose(scene, instance, world[instance.object_node]));
      if (!visible[instance.object_node]) arrays.poses.back().is_hidden = 1;
      if (instance.moving == kNone) fixed.push_back(i);
    }
  } catch (const std::domain_error& e) {
    throw InputError({description.files.at(0)}, fmt::format("at frame {}: {}", frame, e.what()));
  }
  const auto build = [&](std::span<const uint32_t> instances, LargeVector<VolumeNode>& nodes) {
    const LeafMaker make_leaf = [&](std::span<const PrimitiveReference> references) {
      const auto first = static_cast<uint32_t>(arrays.leaf_instances.size());
      for (const PrimitiveReference& r : references) arrays.leaf_instances.push_back(instances[r.primitive]);
      return make_child(ChildKind::instances, first, static_cast<uint32_t>(references.size()));
    };
    return build_hierarchy(InstanceSource(arrays.poses, instances),
                           {.max_primitives = 1, .quality = BuildQuality::fast, .stop = stop}, make_leaf,
                           nodes);
  };
  arrays.header[0].fixed_root = build(fixed, arrays.fixed_nodes);
  arrays.header[0].moving_root = build(arrays.moving_instances, arrays.moving_nodes);
}

}  // namespace rayfarm
