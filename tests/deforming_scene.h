#pragma once
// Scenes of meshes that change their shape, described without a file.
#include "common/description/scene_description.h"
#include "common/math/portable_math.h"

namespace rayfarm::test {

/// A tube about the y axis from y = 0 to 2, radius 0.3, with `rings` × `sides` vertices, smooth normals and
/// coordinates (u, v).
inline MeshShape make_tube(uint32_t rings, uint32_t sides) {
  MeshShape mesh;
  mesh.smoothing = Smoothing::phong;
  for (uint32_t r = 0; r < rings; ++r)
    for (uint32_t s = 0; s < sides; ++s) {
      const double angle = 6.283185307179586 * s / sides, y = 2.0 * r / (rings - 1);
      const Vec3 n(portable_cos(angle), 0, portable_sin(angle));
      mesh.positions.emplace_back(0.3 * n.x, y, 0.3 * n.z);
      mesh.normals.emplace_back(n);
      mesh.uvs.emplace_back(static_cast<double>(s) / sides, y / 2);
    }
  for (uint32_t r = 0; r + 1 < rings; ++r)
    for (uint32_t s = 0; s < sides; ++s) {
      const uint32_t a = r * sides + s, b = r * sides + (s + 1) % sides, c = a + sides, d = b + sides;
      mesh.triangles.emplace_back(a, c, b);
      mesh.triangles.emplace_back(b, c, d);
    }
  mesh.triangle_normals = mesh.triangles;
  mesh.triangle_uvs = mesh.triangles;
  return mesh;
}

inline TransformStep still_step(TransformKind kind, const Vec3& value) {
  TransformStep step;
  step.kind = kind;
  step.curve = constant_curve(Vec4(value, 0));
  return step;
}

/// About z, linearly from 0 at frame 0.
inline TransformStep bend(double degrees, double frames) {
  TransformStep step;
  step.kind = TransformKind::rotate;
  step.axis = Vec3(0, 0, 1);
  step.curve = {Interpolation::linear, {0, frames}, {Vec4(0), Vec4(degrees, 0, 0, 0)}};
  return step;
}

/// Two bones for the tube: one at the origin, and on it one whose joint is at (0, 1, 0), which bends by this
/// angle from frame 0 to frame 10.
inline SkeletonDescription make_arm(double degrees = 90) {
  SkeletonDescription arm;
  arm.bones.push_back({kNone, {}});
  arm.bones.push_back({0, {bend(degrees, 10), still_step(TransformKind::translate, Vec3(0, 1, 0))}});
  return arm;
}

/// How much of a vertex hangs on the second bone.
inline double share_of_second(double y) {
  return std::clamp((y - 0.5), 0.0, 1.0);
}

/// The tube's skin, four influences a vertex as in files.
inline std::shared_ptr<DeformationDescription> make_skin(const MeshShape& mesh) {
  auto skin = std::make_shared<DeformationDescription>();
  skin->skeleton = 0;
  skin->joints = {{0, {}}, {1, make_translation(Vec3(0, -1, 0))}};
  skin->influences = 4;
  for (const glm::vec3& p : mesh.positions) {
    const auto second = static_cast<float>(share_of_second(p.y));
    for (const uint32_t joint : {0u, 1u, 0u, 0u}) skin->joint_of.push_back(joint);
    for (const float weight : {1 - second, second, 0.0f, 0.0f}) skin->weights.push_back(weight);
  }
  return skin;
}

/// The root with an object for each mesh, and a floor in the root.
inline SceneDescription make_scene_of(std::vector<MeshShape> meshes) {
  SceneDescription scene;
  scene.files = {"deforming"};
  scene.view.location = constant_curve(Vec4(0.5, 1, 6, 0));
  scene.view.direction = constant_curve(Vec4(0, 0, -1, 0));
  Light light;
  light.position = Vec3(2, 5, 6);
  light.color = Color(0.8);
  scene.lights.push_back(light);
  scene.materials.emplace_back("default");
  TextureDescription boards;
  boards.kind = TextureKind::boards;
  boards.name = "boards";
  scene.textures.push_back(boards);
  scene.materials.emplace_back("boards");
  scene.materials.back().texture = 0;
  scene.frames = std::array{0, 10};
  scene.objects.push_back({"root", {}, {}, {}});
  scene.objects[0].primitives.push_back(
      {PolygonShape{{{-3, -0.5, -3}, {-3, -0.5, 3}, {3, -0.5, 3}, {3, -0.5, -3}}, {}, Smoothing::flat},
       0,
       {}});
  for (MeshShape& mesh : meshes) {
    const auto object = static_cast<uint32_t>(scene.objects.size());
    scene.objects.push_back({"mesh", {}, {}, {}});
    scene.objects.back().primitives.push_back({std::move(mesh), 1, {}});
    scene.objects[0].children.push_back({object, {}, {}, {}});
  }
  return scene;
}

/// The tube with its skin.
inline SceneDescription make_bending_tube(uint32_t rings, uint32_t sides, double degrees = 90) {
  MeshShape mesh = make_tube(rings, sides);
  mesh.deformation = make_skin(mesh);
  SceneDescription scene = make_scene_of({std::move(mesh)});
  scene.skeletons.push_back(make_arm(degrees));
  return scene;
}

/// A tube whose skin bends it and whose target makes it bulge, from frame 0 to 10.
inline SceneDescription make_bulging_tube(uint32_t rings, uint32_t sides) {
  MeshShape mesh = make_tube(rings, sides);
  const auto deformation = make_skin(mesh);
  DeformationDescription::Target target{{Interpolation::linear, {0, 10}, {Vec4(0), Vec4(1)}}, {}};
  for (uint32_t i = 0; i < mesh.positions.size(); ++i)
    if (mesh.positions[i].y > 1) target.deltas.push_back({i, 0.5f * mesh.normals[i], glm::vec3(0, -0.1f, 0)});
  deformation->targets.push_back(std::move(target));
  mesh.deformation = deformation;
  SceneDescription scene = make_scene_of({std::move(mesh)});
  scene.skeletons.push_back(make_arm(120));
  return scene;
}

/// Triangles whose vertices change places with others far away.
inline SceneDescription make_scrambled(uint32_t rings, uint32_t sides) {
  MeshShape mesh = make_tube(rings, sides);
  mesh.normals.clear();
  mesh.triangle_normals.clear();
  const auto deformation = std::make_shared<DeformationDescription>();
  DeformationDescription::Target target{{Interpolation::linear, {0, 10}, {Vec4(0), Vec4(1)}}, {}};
  const auto count = static_cast<uint32_t>(mesh.positions.size());
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t other = i / sides * 7 % rings * sides + i % sides;  // rings in another order
    target.deltas.push_back({i, mesh.positions[other] - mesh.positions[i], glm::vec3(0)});
  }
  deformation->targets.push_back(std::move(target));
  mesh.deformation = deformation;
  return make_scene_of({std::move(mesh)});
}

}  // namespace rayfarm::test
