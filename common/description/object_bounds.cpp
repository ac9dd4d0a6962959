#include "common/description/object_bounds.h"

namespace rayfarm {
namespace {

Affine eval_steps_of(std::span<const TransformStep> steps, double frame) {
  Affine all;
  for (const TransformStep& step : steps) {
    const Curve& curve = step.curve;
    all = eval_transform(step.kind, eval_curve(curve.interpolation, curve.frames, curve.values, frame),
                         step.axis, step.matrix) *
          all;
  }
  return all;
}

class ObjectBounds {
 public:
  ObjectBounds(const SceneDescription& scene, double frame)
      : scene_(scene), frame_(frame), known_(scene.objects.size()) {}

  const Box& of(uint32_t index) {
    std::optional<Box>& known = known_[index];
    if (known) return *known;
    Box box;
    const ObjectDescription& object = scene_.objects[index];
    for (const PrimitiveDescription& primitive : object.primitives)
      std::visit([&](const auto& shape) { grow(box, shape); }, primitive.shape);
    for (const ChildDescription& child : object.children)
      if (const Box& inner = of(child.object); !inner.is_empty())
        box.grow(transform(eval_steps_of(child.transform, frame_), inner));
    return *(known = box);
  }

 private:
  static void grow(Box& box, const SphereShape& sphere) {
    box.grow(sphere.center - Vec3(sphere.radius));
    box.grow(sphere.center + Vec3(sphere.radius));
  }
  static void grow(Box& box, const ConeShape& cone) {
    grow(box, SphereShape{cone.base, cone.base_radius});
    grow(box, SphereShape{cone.apex, cone.apex_radius});
  }
  static void grow(Box&, const QuadricShape&) {}
  static void grow(Box& box, const PolygonShape& polygon) {
    for (const Vec3& p : polygon.points) box.grow(p);
  }
  void grow(Box& box, const MeshShape& mesh) {
    const DeformationDescription* const d = mesh.deformation.get();
    if (!d || d->skeleton == kNone) {
      for (const glm::vec3& p : mesh.positions) box.grow(Vec3(p));
      return;
    }
    std::vector<Affine> skin;
    const std::vector<Affine>& bones = bones_of(d->skeleton);
    for (const auto& joint : d->joints) skin.push_back(bones[joint.bone] * joint.bone_from_mesh);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      Vec3 sum(0);
      double weights = 0;
      for (size_t k = i * d->influences; k < (i + 1) * d->influences; ++k) {
        const double weight = static_cast<double>(d->weights[k]);
        if (weight == 0) continue;
        sum += weight * skin[d->joint_of[k]].point(Vec3(mesh.positions[i]));
        weights += weight;
      }
      if (weights > 0) box.grow(sum / weights);
    }
  }
  const std::vector<Affine>& bones_of(uint32_t skeleton) {
    if (skeletons_.size() <= skeleton) skeletons_.resize(skeleton + 1);
    std::vector<Affine>& bones = skeletons_[skeleton];
    if (bones.empty())
      for (const SkeletonDescription::Bone& bone : scene_.skeletons[skeleton].bones) {
        const Affine own = eval_steps_of(bone.transform, frame_);
        bones.push_back(bone.parent == kNone ? own : bones[bone.parent] * own);
      }
    return bones;
  }

  const SceneDescription& scene_;
  double frame_;
  std::vector<std::optional<Box>> known_;
  std::vector<std::vector<Affine>> skeletons_;
};

}  // namespace

Box bounds_of_object(const SceneDescription& scene, uint32_t object, double frame) {
  return ObjectBounds(scene, frame).of(object);
}

void look_at(const Box& bounds, ViewDescription& view) {
  if (bounds.is_empty()) return;
  constexpr double kSine = 0.29;  // of half the angle of view from the picture's lower edge to its upper
  const Vec3 center = bounds.center();
  const double distance = std::max(1e-6, 0.5 * glm::length(bounds.extent())) / kSine;
  view.location = constant_curve(Vec4(center + Vec3(0, 0, distance), 0));
  view.direction = constant_curve(Vec4(0, 0, -1, 0));
}

}  // namespace rayfarm
