#include "common/hierarchy/frame_state.h"

#include <cmath>
#include <stdexcept>

namespace rayfarm {

std::vector<Affine> world_transforms(const Scene& scene, double frame) {
  return scene.transforms_to_root(scene.object_nodes, frame);
}

std::vector<char> visible_nodes(const Scene& scene, double frame) {
  std::vector<char> visible(scene.object_nodes.size());
  for (size_t i = 0; i < visible.size(); ++i) {
    const ObjectNode& node = scene.object_nodes[i];
    visible[i] = (node.parent == kNone || visible[node.parent]) &&
                 (node.visible == kNone || scene.eval(node.visible, frame).x != 0);
  }
  return visible;
}

bool has_changing_links(const Scene& scene) {
  return std::any_of(scene.object_nodes.begin(), scene.object_nodes.end(),
                     [](const ObjectNode& node) { return node.visible != kNone; });
}

bool has_poses(const Scene& scene) {
  return !scene.moving_instances.empty() || has_changing_links(scene) ||
         std::any_of(scene.lights.begin(), scene.lights.end(),
                     [](const Light& light) { return light.moving != kNone; });
}

LightPlace make_light_place(const LightPlace& in_object, const Affine& world) {
  LightPlace place = in_object;
  if (world.is_identity()) return place;
  const double determinant = glm::determinant(world.linear);
  place.position = world.point(in_object.position);
  place.direction = normalized(world.vector(in_object.direction));
  const Vec3 zero = world.vector(in_object.zero);
  place.zero = normalized(zero - glm::dot(zero, place.direction) * place.direction);
  if (!is_finite(place.position) || !is_finite(place.direction) || !is_finite(place.zero) ||
      !std::isfinite(determinant) || determinant == 0)
    throw std::domain_error("a light's transform is singular or not finite");
  if (determinant < 0) place.is_mirrored ^= 1;
  return place;
}

InstancePose make_instance_pose(const Scene& scene, const Instance& instance, const Affine& world) {
  InstancePose pose;
  pose.is_deformed = instance.part < scene.deforming_parts.size() ? 1 : 0;
  pose.world_from_object = world;
  pose.is_identity = world.is_identity() ? 1 : 0;
  if (!pose.is_identity) {
    pose.object_from_world = inverse(world);
    for (int column = 0; column < 3; ++column)
      if (!is_finite(pose.object_from_world.linear[column]) || !is_finite(world.translation))
        throw std::domain_error("an object's transform is singular or not finite");
  }
  const Box& part = scene.parts[instance.part].collection.bounds;
  pose.bounds = transform(world, part);
  // A hit is found in the object's space: leave room for the rounding of coordinates that cancel on the way
  // back.
  const Mat3& m = world.linear;
  const double largest = std::max({max_magnitude(m[0]), max_magnitude(m[1]), max_magnitude(m[2])});
  const Vec3 margin(1e-14 * (3 * largest * part.magnitude() + max_magnitude(world.translation)));
  pose.bounds.lo -= margin;
  pose.bounds.hi += margin;
  return pose;
}

void refit(const Scene& scene, std::span<const InstancePose> moving, std::span<VolumeNode> nodes) {
  for (size_t n = nodes.size(); n-- > 0;) {  // children stand after their parents
    VolumeNode& node = nodes[n];
    for (size_t slot = 0; slot < 8; ++slot) {
      const ChildRef child = node.children[slot];
      Box box;
      if (child.kind() == ChildKind::inner) {
        box = bounds_of(nodes[child.first]);
      } else if (child.kind() == ChildKind::instances) {
        for (const uint32_t i : scene.leaf_instances.subspan(child.first, child.count()))
          if (scene.instances[i].moving != kNone) box.grow(moving[scene.instances[i].moving].bounds);
      } else {
        continue;
      }
      set_child(node, slot, box, child);
    }
  }
}

Pose FrameState::at(double time, double frame) {
  if (scene_.moving_instances.empty() && !has_moving_lights_) return {scene_, {}, scene_.moving_nodes, {}};
  const bool has_shapes = !scene_.deforming_parts.empty();
  if (has_shapes) {
    if (!parts_) parts_ = std::make_unique<DeformedParts>(scene_);
    parts_->set(time);
  }
  const std::vector<Affine> world = world_transforms(scene_, time);
  const std::vector<char> visible =
      has_changing_links(scene_) ? visible_nodes(scene_, frame) : std::vector<char>(world.size(), 1);
  moving_.clear();
  for (const uint32_t i : scene_.moving_instances) {
    const Instance& instance = scene_.instances[i];
    if (visible[instance.object_node])
      moving_.push_back(
          make_instance_pose(instance.part < scene_.deforming_parts.size() ? parts_->shapes() : scene_,
                             instance, world[instance.object_node]));
    else
      moving_.emplace_back().is_hidden = 1;  // its bounds are empty
  }
  light_places_.clear();
  for (const ObjectLight& light : scene_.object_lights) {
    const bool is_placed = scene_.lights[light.light].moving != kNone && visible[light.object_node];
    light_places_.push_back(is_placed ? make_light_place(light.place, world[light.object_node])
                                      : light.place);
  }
  moving_nodes_.assign(scene_.moving_nodes.begin(), scene_.moving_nodes.end());
  refit(scene_, moving_, moving_nodes_);
  return {scene_, moving_, moving_nodes_, light_places_, has_shapes ? &parts_->shapes() : nullptr};
}

}  // namespace rayfarm
