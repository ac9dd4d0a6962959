// What can't change its shape, in descriptions and in scene blocks.
#include "common/hierarchy/deformed_parts.h"
#include "tests/deforming_scene.h"
#include "tests/unit/damaged_scene.h"

namespace rayfarm {
namespace {

std::string deform_error(const SceneDescription& description, Purpose purpose = Purpose::pictures) {
  try {
    validate(description);
    compile(description, {}, purpose);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(DeformChecks, WhatCanNotBeIsRefused) {
  SceneDescription description = test::make_bending_tube(9, 8);
  EXPECT_EQ(deform_error(description), "");
  EXPECT_NE(deform_error(description, Purpose::library).find("changes its shape from frame to frame"),
            std::string::npos);
  SceneDescription mixed = description;
  mixed.objects[1].primitives.push_back({SphereShape{}, 0, {}});
  EXPECT_NE(deform_error(mixed).find("consists of meshes of triangles"), std::string::npos);
  const auto damaged =
      [&](const std::function<void(SceneDescription&, MeshShape&, DeformationDescription&)>& damage) {
        SceneDescription copy = description;
        auto& mesh = std::get<MeshShape>(copy.objects[1].primitives[0].shape);
        const auto deformation = std::make_shared<DeformationDescription>(*mesh.deformation);
        mesh.deformation = deformation;
        damage(copy, mesh, *deformation);
        return deform_error(copy);
      };
  const auto no = [](auto&...) {};
  EXPECT_EQ(damaged(no), "");
  EXPECT_NE(damaged([](auto&, auto& mesh, auto&) { mesh.normals.pop_back(); }), "");
  EXPECT_NE(damaged([](auto&, auto&, auto& d) { d.skeleton = 1; }), "");
  EXPECT_NE(damaged([](auto&, auto&, auto& d) { d.joints[1].bone = 2; }), "");
  EXPECT_NE(damaged([](auto&, auto&, auto& d) { d.joint_of[0] = 2; }), "");
  EXPECT_NE(damaged([](auto&, auto&, auto& d) { d.weights[0] = -1; }), "");
  EXPECT_NE(damaged([](auto&, auto&, auto& d) { d.weights.pop_back(); }), "");
  EXPECT_NE(damaged([](auto&, auto&, auto& d) {
              d.targets.push_back({constant_curve(Vec4(1)), {{72, {}, {}}}});
            }),
            "");
  EXPECT_NE(damaged([](auto& scene, auto&, auto&) { scene.skeletons[0].bones[0].parent = 1; }), "");
}

TEST(DeformChecks, DamagedBlocksAreRefused) {
  SceneDescription description = test::make_bulging_tube(9, 8);
  description.objects.push_back(description.objects[1]);
  description.objects[0].children.push_back({2, {}, {}, {}});
  const CompiledScene compiled = compile(description);
  const auto refuse = [&]<typename T>(std::span<const T> SceneArrays<ArrayView>::*array, auto damage,
                                      const char* what, size_t index = 0) {
    test::expect_refusal_at<T>(compiled, array, damage, what, index);
  };
  refuse(
      &Scene::deforming_parts, [](DeformingPart& p) { ++p.first_node; }, "a first node");
  refuse(
      &Scene::deforming_parts, [](DeformingPart& p) { ++p.node_count; }, "a node of another", 0);
  refuse(
      &Scene::deforming_parts, [](DeformingPart& p) { p.node_count = 1 << 30; }, "nodes", 1);
  refuse(
      &Scene::deforming_parts, [](DeformingPart& p) { ++p.triangle_count; }, "triangles");
  refuse(
      &Scene::deforming_parts, [](DeformingPart& p) { p.cost = std::nan(""); }, "a cost");
  refuse(
      &Scene::deforming_vertices, [](DeformingVertex& v) { v.first_delta = 1; }, "deltas");
  refuse(
      &Scene::deforming_vertices, [](DeformingVertex& v) { v.first_influence = ~0u; }, "joints", 3);
  refuse(
      &Scene::deforming_vertices, [](DeformingVertex& v) { v.position.x = std::nanf(""); }, "NaN", 3);
  refuse(
      &Scene::deforming_triangles, [](glm::uvec3& t) { t.y = 144; }, "a corner", 7);
  refuse(
      &Scene::triangle_shading, [](TriangleShading& t) { t.normals[1] = 144; }, "a normal", 7);
  refuse(
      &Scene::morph_deltas, [](MorphDelta& d) { d.target = 2; }, "a target", 1);
  refuse(
      &Scene::morph_weights, [](uint32_t& w) { w = 1000; }, "a weight");
  refuse(
      &Scene::joint_weights, [](JointWeight& w) { w.joint = 4; }, "a joint");
  refuse(
      &Scene::joint_weights, [](JointWeight& w) { w.weight = -1; }, "a joint's weight");
  refuse(
      &Scene::joints, [](Joint& j) { j.bone = 2; }, "a bone");
  refuse(
      &Scene::bones, [](Bone& b) { b.parent = 1; }, "a parent", 1);
  refuse(
      &Scene::bones, [](Bone& b) { b.step_count = 1000; }, "steps", 1);
  refuse(
      &Scene::poses, [](InstancePose& p) { p.is_deformed ^= 1; }, "a pose");
  refuse(
      &Scene::parts, [](Part& p) { ++p.collection.first_triangle_block; }, "blocks");
  refuse(
      &Scene::triangle_blocks,
      [](TriangleBlock& b) { b.primitives[0] = make_primitive_id(PrimitiveKind::triangle, 130); },
      "a triangle of another part");
}

}  // namespace
}  // namespace rayfarm
