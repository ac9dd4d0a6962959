#pragma once
// What a frame changes of a scene: where instances stand, and the object part's boxes over them (thesis
// 4.2.1.1). Moving objects cost setting matrices and refitting boxes, never a rebuild; no part changes but
// those that change their shape (DeformedParts).
#include <memory>
#include <vector>

#include "common/hierarchy/deformed_parts.h"

namespace rayfarm {

/// A frame's state as it is read while rays are traced: a view.
class Pose {
 public:
  Pose(const Scene& scene, std::span<const InstancePose> moving, std::span<const VolumeNode> moving_nodes,
       std::span<const LightPlace> light_places, const Scene* shapes = nullptr)
      : instances_(scene.moving_instances.empty() ? nullptr : scene.instances.data()),
        fixed_(scene.poses.data()),
        moving_(moving.data()),
        moving_nodes_(moving_nodes.data()),
        light_places_(light_places.data()),
        shapes_(shapes) {}

  const InstancePose& operator[](uint32_t instance) const {
    if (!instances_) return fixed_[instance];
    const uint32_t moving = instances_[instance].moving;
    return moving == kNone ? fixed_[instance] : moving_[moving];
  }
  /// Where the primitives of an instance's part stand, and its volumes: in `scene`, or in what the frame made
  /// of them.
  const Scene& shape_of(uint32_t instance, const Scene& scene) const {
    return shapes_ && (*this)[instance].is_deformed ? *shapes_ : scene;
  }
  /// The boxes over the instances that move.
  const VolumeNode* moving_nodes() const { return moving_nodes_; }
  /// Where a light of the scene stands in the world.
  const LightPlace& operator[](const Light& light) const {
    return light.moving == kNone ? light : light_places_[light.moving];
  }

 private:
  const Instance* instances_;  ///< null if none moves
  const InstancePose *fixed_, *moving_;
  const VolumeNode* moving_nodes_;
  const LightPlace* light_places_;  ///< of the objects' lights
  const Scene* shapes_;             ///< of the parts that change theirs; null if none does
};

/// The world transform of every object node at `frame`, in the tree's order.
std::vector<Affine> world_transforms(const Scene& scene, double frame);

/// Of every object node, whether the links to it are there in `frame` (thesis 4.2.1.1).
std::vector<char> visible_nodes(const Scene& scene, double frame);

/// True if some object or light is not there in every frame.
bool has_changing_links(const Scene& scene);
/// True if something but the camera moves, comes or goes in some frame.
bool has_poses(const Scene& scene);

/// Where a light stands whose object node has this transform. Throws std::domain_error if the transform is
/// singular or not finite.
LightPlace make_light_place(const LightPlace& in_object, const Affine& world);

/// Where an instance stands whose object node has this transform. Throws std::domain_error if the transform
/// is singular or not finite.
InstancePose make_instance_pose(const Scene& scene, const Instance& instance, const Affine& world);

/// Sets the boxes of `nodes`, bottom up, to the moving instances' bounds; over hidden ones alone to boxes
/// that let no ray in.
void refit(const Scene& scene, std::span<const InstancePose> moving, std::span<VolumeNode> nodes);

/// Owns the state of one moment: of what moves alone. All else is traced where it lies in the scene block.
class FrameState {
 public:
  explicit FrameState(const Scene& scene)
      : scene_(scene),
        has_moving_lights_(std::any_of(scene.lights.begin(), scene.lights.end(),
                                       [](const Light& light) { return light.moving != kNone; })) {}
  /// The state at `time`, valid until the next call. Objects move while the shutter is open, but come and go
  /// between frames (Figure 4.4): they are there by the number of the frame. Throws std::domain_error if the
  /// transform of what is there is singular or not finite.
  Pose at(double time, double frame);
  Pose at(double frame) { return at(frame, frame); }

 private:
  Scene scene_;
  bool has_moving_lights_;
  std::unique_ptr<DeformedParts> parts_;  ///< null if none changes its shape
  std::vector<InstancePose> moving_;
  LargeVector<VolumeNode> moving_nodes_;
  std::vector<LightPlace> light_places_;
};

}  // namespace rayfarm
