#include "common/description/scene_bounds.h"

namespace rayfarm {
namespace {

class MeshBounds {
 public:
  explicit MeshBounds(const SceneDescription& scene)
      : scene_(scene), frame_(scene.frames ? (*scene.frames)[0] : 0), boxes_(scene.objects.size()) {}

  Box read() {
    if (scene_.root < scene_.objects.size()) add(scene_.root, {}, 0);
    return bounds_;
  }

 private:
  /// As many points as are looked at in a tenth of a second.
  static constexpr size_t kMostPoints = 20'000'000;

  void add(uint32_t index, const Affine& world_from_object, size_t depth) {
    const ObjectDescription& object = scene_.objects[index];
    if (depth > limits::kObjectDepth) return;
    for (const PrimitiveDescription& primitive : object.primitives)
      if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape)) points_ += mesh->positions.size();
    if (points_ > kMostPoints) {
      const Box& box = box_of(index);
      if (!box.is_empty()) bounds_.grow(transform(world_from_object, box));
    } else {
      grow(bounds_, object, world_from_object);
    }
    for (const ChildDescription& child : object.children) {
      if (child.object >= scene_.objects.size()) continue;
      if (child.visible && value_of(*child.visible).x == 0) continue;
      add(child.object, world_from_object * eval_steps(child.transform), depth + 1);
    }
  }

  Vec4 value_of(const Curve& curve) const {
    return curve.frames.empty() ? Vec4(0)
                                : eval_curve(curve.interpolation, curve.frames, curve.values, frame_);
  }

  void grow(Box& bounds, const ObjectDescription& object, const Affine& world_from_object) {
    for (const PrimitiveDescription& primitive : object.primitives)
      if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape)) {
        if (mesh->deformation && mesh->deformation->skeleton != kNone) {
          grow_bent(bounds, *mesh, world_from_object);
          continue;
        }
        const auto grow_by = [&](uint32_t point) {
          bounds.grow(world_from_object.point(Vec3(mesh->positions[point])));
        };
        for (const glm::uvec3& t : mesh->triangles)
          for (int k = 0; k < 3; ++k) grow_by(t[k]);
        for (const uint32_t corner : mesh->polygons.corners) grow_by(corner);
      }
  }

  /// By a mesh with a skin.
  void grow_bent(Box& bounds, const MeshShape& mesh, const Affine& world_from_object) {
    const DeformationDescription& d = *mesh.deformation;
    const std::vector<Affine>& bones = bones_of(d.skeleton);
    std::vector<Affine> skin;
    for (const auto& joint : d.joints) skin.push_back(bones[joint.bone] * joint.bone_from_mesh);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      Vec3 sum(0);
      double weights = 0;
      for (size_t k = i * d.influences; k < (i + 1) * d.influences; ++k) {
        const auto weight = static_cast<double>(d.weights[k]);
        if (weight == 0) continue;
        sum += weight * skin[d.joint_of[k]].point(Vec3(mesh.positions[i]));
        weights += weight;
      }
      if (weights > 0) bounds.grow(world_from_object.point(sum / weights));
    }
  }

  /// Those of a skeleton, in its space.
  const std::vector<Affine>& bones_of(uint32_t skeleton) {
    skeletons_.resize(scene_.skeletons.size());
    std::vector<Affine>& bones = skeletons_[skeleton];
    if (bones.empty())
      for (const SkeletonDescription::Bone& bone : scene_.skeletons[skeleton].bones) {
        const Affine own = eval_steps(bone.transform);
        bones.push_back(bone.parent == kNone ? own : bones[bone.parent] * own);
      }
    return bones;
  }

  Affine eval_steps(std::span<const TransformStep> steps) const {
    Affine all;
    for (const TransformStep& step : steps)
      all = eval_transform(step.kind, value_of(step.curve), step.axis, step.matrix) * all;
    return all;
  }

  const Box& box_of(uint32_t index) {
    std::optional<Box>& box = boxes_[index];
    if (!box) grow(box.emplace(), scene_.objects[index], {});
    return *box;
  }

  const SceneDescription& scene_;
  double frame_;
  std::vector<std::optional<Box>> boxes_;  ///< of objects, in their own space
  std::vector<std::vector<Affine>> skeletons_;
  Box bounds_;
  size_t points_ = 0;
};

}  // namespace

Box bounds_of_meshes(const SceneDescription& scene) {
  return MeshBounds(scene).read();
}

}  // namespace rayfarm
