#include "common/hierarchy/pose.h"

#include <cmath>
#include <stdexcept>

#include "common/hierarchy/builder.h"
#include "common/scene/animation.h"

namespace rayfarm {

std::vector<Affine> world_transforms(const Scene& scene, double frame) {
  std::vector<Affine> world(scene.object_nodes.size());
  for (size_t i = 0; i < world.size(); ++i) {
    const ObjectNode& node = scene.object_nodes[i];
    Affine local;
    for (const TransformStepRecord& step : scene.steps.subspan(node.first_step, node.step_count))
      local = eval_transform(static_cast<TransformKind>(step.kind), scene.eval(step.curve, frame), step.axis,
                             step.matrix) *
              local;
    world[i] = node.parent == kNone ? local : world[node.parent] * local;
  }
  return world;
}

std::vector<InstancePose> pose_instances(const Scene& scene, double frame) {
  const std::vector<Affine> world = world_transforms(scene, frame);
  std::vector<InstancePose> poses(scene.instances.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    const Instance& instance = scene.instances[i];
    InstancePose& pose = poses[i];
    pose.world_from_object = world[instance.object_node];
    pose.is_identity = pose.world_from_object.is_identity() ? 1 : 0;
    if (!pose.is_identity) {
      pose.object_from_world = inverse(pose.world_from_object);
      for (int column = 0; column < 3; ++column)
        if (!is_finite(pose.object_from_world.linear[column]) ||
            !is_finite(pose.world_from_object.translation))
          throw std::domain_error("an object's transform is singular or not finite");
    }
    const Box& part = scene.parts[instance.part].bounds;
    pose.bounds = transform(pose.world_from_object, part);
    // A hit is found in the object's space: leave room for the rounding of coordinates that cancel on the way
    // back.
    const Mat3& m = pose.world_from_object.linear;
    const double largest = std::max({max_magnitude(m[0]), max_magnitude(m[1]), max_magnitude(m[2])});
    const Vec3 margin(1e-14 *
                      (3 * largest * part.magnitude() + max_magnitude(pose.world_from_object.translation)));
    pose.bounds.lo -= margin;
    pose.bounds.hi += margin;
  }
  return poses;
}

void refit(const Scene& scene, std::span<const InstancePose> instances, std::span<VolumeNode> nodes) {
  for (size_t i = nodes.size(); i-- > 0;) {  // children stand after their parents
    VolumeNode& node = nodes[i];
    for (size_t slot = 0; slot < 8; ++slot) {
      const ChildRef child = node.children[slot];
      Box box;
      if (child.kind() == ChildKind::inner)
        box = bounds_of(nodes[child.first]);
      else if (child.kind() == ChildKind::instances)
        for (const uint32_t instance : scene.leaf_instances.subspan(child.first, child.count()))
          box.grow(instances[instance].bounds);
      else
        continue;
      set_child(node, slot, box, child);
    }
  }
}

Pose FramePose::at(double frame) {
  if (!scene_.head().is_animated) return {scene_.object_part_nodes, scene_.poses};
  instances_ = pose_instances(scene_, frame);
  nodes_.assign(scene_.object_part_nodes.begin(), scene_.object_part_nodes.end());
  refit(scene_, instances_, nodes_);
  return {nodes_, instances_};
}

}  // namespace rayfarm
