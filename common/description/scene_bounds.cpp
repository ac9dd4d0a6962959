#include "common/description/scene_bounds.h"

namespace rayfarm {
namespace {

/// As many points as are looked at in about a tenth of a second.
constexpr size_t kMostPoints = 20'000'000;

/// Adds shapes to a box of the world.
struct BoxGrower {
  Box& bounds;
  const Affine& world_from_object;

  void grow_by(const Vec3& p) const { bounds.grow(world_from_object.point(p)); }

  /// A ball, or with a normal a disc: an axis of the world reaches as far in it as along the ball or disc.
  void grow_by(const Vec3& center, double radius, const Vec3& normal = Vec3(0)) const {
    Vec3 reach;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 row(world_from_object.linear[0][axis], world_from_object.linear[1][axis],
                     world_from_object.linear[2][axis]);
      reach[axis] = radius * glm::length(row - glm::dot(row, normal) * normal);
    }
    const Vec3 p = world_from_object.point(center);
    bounds.grow(p - reach);
    bounds.grow(p + reach);
  }

  void operator()(const SphereShape& sphere) const { grow_by(sphere.center, sphere.radius); }
  void operator()(const ConeShape& cone) const {
    const Vec3 axis = normalized(cone.apex - cone.base);
    grow_by(cone.base, cone.base_radius, axis);
    grow_by(cone.apex, cone.apex_radius, axis);
  }
  void operator()(const QuadricShape&) const {}
  void operator()(const PatchShape& patch) const {
    for (const Vec3& p : patch.corners) grow_by(p);
  }
  void operator()(const PolygonShape& polygon) const {
    for (const Vec3& p : polygon.points) grow_by(p);
  }
  void operator()(const MeshShape& mesh) const {
    for (const glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) grow_by(Vec3(mesh.positions[t[k]]));
    for (const uint32_t corner : mesh.polygons.corners) grow_by(Vec3(mesh.positions[corner]));
  }
};

class ObjectBounds {
 public:
  explicit ObjectBounds(const SceneDescription& scene)
      : scene_(scene),
        frame_(scene.frames ? (*scene.frames)[0] : 0),
        own_(scene.objects.size()),
        bounds_(scene.objects.size()) {}

  std::vector<Box> read() {
    if (scene_.root < scene_.objects.size()) add(scene_.root, {}, 0);
    return std::move(bounds_);
  }

 private:
  void add(uint32_t index, const Affine& world_from_object, size_t depth) {
    const ObjectDescription& object = scene_.objects[index];
    if (depth > limits::kObjectDepth) return;
    for (const PrimitiveDescription& primitive : object.primitives)
      if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape))
        points_ += 3 * mesh->triangles.size() + mesh->polygons.corners.size();
    if (points_ <= kMostPoints || !own_[index]) {
      grow(bounds_[index], object, world_from_object);
    } else if (!own_[index]->is_empty()) {
      bounds_[index].grow(transform(world_from_object, *own_[index]));
    }
    if (!own_[index] && points_ > kMostPoints) grow(own_[index].emplace(), object, {});
    for (const ChildDescription& child : object.children) {
      if (child.object >= scene_.objects.size()) continue;
      if (child.visible && value_of(*child.visible).x == 0) continue;
      add(child.object, world_from_object * eval_steps(child.transform, frame_), depth + 1);
    }
  }

  Vec4 value_of(const Curve& curve) const {
    return eval_curve(curve.interpolation, curve.frames, curve.values, frame_);
  }

  void grow(Box& bounds, const ObjectDescription& object, const Affine& world_from_object) {
    for (const PrimitiveDescription& primitive : object.primitives)
      if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape);
          mesh && mesh->deformation && mesh->deformation->skeleton != kNone)
        grow_bent(bounds, *mesh, world_from_object);
      else
        std::visit(BoxGrower{bounds, world_from_object}, primitive.shape);
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
        const Affine own = eval_steps(bone.transform, frame_);
        bones.push_back(bone.parent == kNone ? own : bones[bone.parent] * own);
      }
    return bones;
  }

  const SceneDescription& scene_;
  double frame_;
  std::vector<std::optional<Box>> own_;  ///< of objects in their own space, once there are too many points
  std::vector<Box> bounds_;
  std::vector<std::vector<Affine>> skeletons_;
  size_t points_ = 0;
};

}  // namespace

std::vector<Box> bounds_of_objects(const SceneDescription& scene) {
  return ObjectBounds(scene).read();
}

Box bounds_of(const SceneDescription& scene) {
  Box all;
  for (const Box& box : bounds_of_objects(scene))
    if (!box.is_empty()) all.grow(box);
  return all;
}

}  // namespace rayfarm
