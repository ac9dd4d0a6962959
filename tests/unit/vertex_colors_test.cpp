// Colours and second coordinates that meshes give at their vertices: what is between them, on triangles and
// on faces, is linear, and weighs what the material has.
#include "common/lighting/holes.h"
#include "common/lighting/principled_surface.h"
#include "common/lighting/textured.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

/// The square from (-1, -1) to (1, 1) in z = 0, red where x is 1, green where y is 1, clear where x is -1.
MeshShape coloured_square(bool is_one_face) {
  MeshShape mesh;
  for (const glm::vec2 p : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
    mesh.positions.push_back(glm::vec3(p, 0));
    const Vec2 part = (Vec2(p) + 1.0) / 2.0;
    mesh.colors.push_back(make_vertex_color(Color(part, 0.5), part.x));
    mesh.uvs.emplace_back(part.x, 0);
    mesh.second_uvs.emplace_back(3 * part.x, part.y);
  }
  if (is_one_face) {
    mesh.polygons.sides = {4};
    mesh.polygons.corners = {0, 1, 2, 3};
    mesh.polygons.uvs = {0, 1, 2, 3};
    mesh.second_uvs.clear();
  } else {
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.triangle_uvs = mesh.triangles;
  }
  return mesh;
}

/// With an uncoloured triangle before it, far behind, and one after it.
CompiledScene compiled_square(bool is_one_face, const MaterialDescription& material,
                              const PrincipledMaterial* principled = nullptr) {
  SceneDescription scene;
  scene.files = {"square"};
  scene.materials.push_back(material);
  scene.materials.emplace_back("plain");
  if (principled) scene.principled.push_back(*principled);
  MeshShape plain;
  plain.positions = {{-9, -9, -9}, {-8, -9, -9}, {-9, -8, -9}};
  plain.triangles = {{0, 1, 2}};
  scene.objects.push_back({"root", {}, {}, {}});
  auto& primitives = scene.objects[0].primitives;
  primitives.push_back({plain, 1, {}});
  primitives.push_back({coloured_square(is_one_face), 0, {}});
  primitives.push_back({plain, 1, {}});
  return compile(scene);
}

TEST(VertexColors, AreLinearBetweenVerticesAndWeighTheMaterial) {
  for (const bool is_one_face : {false, true}) {
    MaterialDescription material("red");
    material.color = Color(0.5, 1, 1);
    const CompiledScene compiled = compiled_square(is_one_face, material);
    FrameState state(compiled.scene);
    const Pose pose = state.at(0);
    EXPECT_TRUE(compiled.scene.materials[0].is_colored);
    EXPECT_FALSE(compiled.scene.materials[1].is_colored);
    for (const Vec2 p : {Vec2(0.5, -0.3), Vec2(-0.7, 0.2), Vec2(0.1, 0.9)}) {
      const Ray ray{Vec3(p, 3), Vec3(0, 0, -1)};
      const Hit hit = closest_hit(compiled.scene, pose, ray);
      ASSERT_TRUE(hit.is_hit());
      const Vec2 part = (p + 1.0) / 2.0;
      const Vec4 color = vertex_color(compiled.scene, hit, Vec3(p, 0));
      EXPECT_NEAR(glm::length(color - Vec4(part, 0.5, part.x)), 0, 2e-5);
      Surface surface = eval_surface(compiled.scene, pose, ray, hit);
      const Material seen = textured(compiled.scene, pose, ray, hit, 0.01, 0.5, surface);
      EXPECT_NEAR(glm::length(seen.color - Color(0.5 * part.x, part.y, 0.5)), 0, 2e-5);
      const Vec2 second = second_parameters(compiled.scene, hit, Vec3(p, 0));
      EXPECT_NEAR(glm::length(second - (is_one_face ? Vec2(part.x, 0) : Vec2(3 * part.x, part.y))), 0, 1e-6);
    }
    const Hit plain = closest_hit(compiled.scene, pose, {Vec3(-8.9, -8.9, 3), Vec3(0, 0, -1)});
    EXPECT_EQ(vertex_color(compiled.scene, plain, Vec3(-8.9, -8.9, -9)), Vec4(1));
  }
}

TEST(VertexColors, OfPrincipledMaterialsAreAlsoOpacity) {
  MaterialDescription material("glass pane");
  material.color = Color(0.8, 0.5, 1);
  material.principled = 0;
  PrincipledMaterial principled = usual_principled();
  finish_principled(principled, material);
  material.is_pierced = 1;
  const CompiledScene compiled = compiled_square(false, material, &principled);
  ASSERT_TRUE(compiled.scene.head().has_holes);
  FrameState state(compiled.scene);
  const Pose pose = state.at(0);
  const Ray ray{Vec3(0.5, 0, 3), Vec3(0, 0, -1)};
  const Hit hit = closest_hit(compiled.scene, pose, ray);
  Surface surface = eval_surface(compiled.scene, pose, ray, hit);
  PrincipledPoint point;
  textured(compiled.scene, pose, ray, hit, 0.01, 0.5, surface, point);
  EXPECT_NEAR(glm::length(point.base - Color(0.8 * 0.75, 0.5 * 0.5, 0.5)), 0, 2e-5);
  const SurfacePatch patch = patch_at(compiled.scene, pose, ray, hit, 0.01, surface);
  EXPECT_NEAR(patch.color.w, 0.75, 2e-5);
  EXPECT_NEAR(patch.sets[0].uv.x, 0.75, 1e-6);
  EXPECT_NEAR(patch.sets[1].uv.x, 2.25, 1e-6);
}

TEST(VertexColors, OfTheSecondSetReachTheTexturesThatAskForIt) {
  // A ramp of two pixels, black and white, clamped: with the first set's u = 0.75 white's part is 1; with the
  // second's 0.75 × 3 it is 1, and at x = -0.8, where they are 0.1 and 0.3, there is 0 and 0.1.
  MaterialDescription material("ramp");
  material.principled = 0;
  for (const uint32_t set : {0u, 1u}) {
    SceneDescription scene;
    scene.files = {"ramp"};
    TextureDescription& ramp = scene.textures.emplace_back();
    ramp.kind = TextureKind::image;
    ramp.is_mapped = 1;
    ramp.width_px = 2;
    ramp.height_px = ramp.levels = 1;
    ramp.wraps = {TextureWrap::clamp, TextureWrap::clamp};
    ramp.texels = {0, 0, 0, 0x3c00, 0x3c00, 0x3c00};
    PrincipledMaterial principled = usual_principled();
    principled[PrincipledInput::base_color].texture = 0;
    principled[PrincipledInput::base_color].uv_set = set;
    material.color = Color(1);
    finish_principled(principled, material);
    scene.materials.push_back(material);
    scene.principled.push_back(principled);
    scene.objects.push_back({"root", {}, {}, {}});
    MeshShape mesh = coloured_square(false);
    mesh.colors.clear();
    scene.objects[0].primitives.push_back({std::move(mesh), 0, {}});
    const CompiledScene compiled = compile(scene);
    FrameState state(compiled.scene);
    const Pose pose = state.at(0);
    const Ray ray{Vec3(-0.8, 0, 3), Vec3(0, 0, -1)};
    const Hit hit = closest_hit(compiled.scene, pose, ray);
    Surface surface = eval_surface(compiled.scene, pose, ray, hit);
    PrincipledPoint point;
    textured(compiled.scene, pose, ray, hit, 1e-9, 0.5, surface, point);
    EXPECT_NEAR(point.base.x, set == 0 ? 0 : 0.1, 1e-4);
  }
}

}  // namespace
}  // namespace rayfarm
