#pragma once
// What a frame changes of a scene: where instances stand, and the object part's boxes over them (thesis
// 4.2.1.1). Parts never change; moving objects cost setting matrices and refitting boxes, never a rebuild.
#include <vector>

#include "common/scene/scene.h"

namespace rayfarm {

/// A frame's state as it is read while rays are traced: a view.
class Pose {
 public:
  Pose(const Scene& scene, std::span<const InstancePose> moving, std::span<const VolumeNode> moving_nodes)
      : instances_(scene.moving_instances.empty() ? nullptr : scene.instances.data()),
        fixed_(scene.poses.data()),
        moving_(moving.data()),
        moving_nodes_(moving_nodes.data()) {}

  const InstancePose& operator[](uint32_t instance) const {
    if (!instances_) return fixed_[instance];
    const uint32_t moving = instances_[instance].moving;
    return moving == kNone ? fixed_[instance] : moving_[moving];
  }
  /// The boxes over the instances that move.
  const VolumeNode* moving_nodes() const { return moving_nodes_; }

 private:
  const Instance* instances_;  ///< null if none moves
  const InstancePose *fixed_, *moving_;
  const VolumeNode* moving_nodes_;
};

/// The world transform of every object node at `frame`, in the tree's order.
std::vector<Affine> world_transforms(const Scene& scene, double frame);

/// Where an instance stands whose object node has this transform. Throws std::domain_error if the transform
/// is singular or not finite.
InstancePose make_instance_pose(const Scene& scene, const Instance& instance, const Affine& world);

/// Sets the boxes of `nodes`, bottom up, to the moving instances' bounds.
void refit(const Scene& scene, std::span<const InstancePose> moving, std::span<VolumeNode> nodes);

/// Owns the state of one moment: of what moves alone. All else is traced where it lies in the scene block.
class FrameState {
 public:
  explicit FrameState(const Scene& scene) : scene_(scene) {}
  /// The state at `frame`, valid until the next call. Throws std::domain_error if an object's transform is
  /// singular or not finite there.
  Pose at(double frame);

 private:
  Scene scene_;
  std::vector<InstancePose> moving_;
  std::vector<VolumeNode> moving_nodes_;
};

}  // namespace rayfarm
