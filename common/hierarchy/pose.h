#pragma once
// The object part in one frame (thesis 4.2.1.1): each instance's place in the world and the boxes over them.
// Parts never change; moving objects cost setting matrices and refitting these boxes, never a rebuild.
#include <vector>

#include "common/scene/scene.h"

namespace rayfarm {

/// Views of the object part that a traverser reads.
struct Pose {
  std::span<const VolumeNode> nodes;
  std::span<const InstancePose> instances;
};

/// The world transform of every object node at `frame`, in the tree's order.
std::vector<Affine> world_transforms(const Scene& scene, double frame);

/// The pose of every instance at `frame`. Throws std::domain_error if an object's transform is singular or
/// not finite there.
std::vector<InstancePose> pose_instances(const Scene& scene, double frame);

/// Sets the boxes of `nodes`, bottom up, to the instances' bounds.
void refit(const Scene& scene, std::span<const InstancePose> instances, std::span<VolumeNode> nodes);

/// Owns the pose of the current frame. A scene in which nothing moves is traversed where it lies in the
/// block.
class FramePose {
 public:
  explicit FramePose(const Scene& scene) : scene_(scene) {}
  /// The pose at `frame`, valid until the next call.
  Pose at(double frame);

 private:
  Scene scene_;
  std::vector<VolumeNode> nodes_;
  std::vector<InstancePose> instances_;
};

}  // namespace rayfarm
