// Nodes, cameras, lights, clips, skins and morph targets of glTF files.
#include <numbers>

#include "common/compile/compile.h"
#include "common/description/scene_bounds.h"
#include "common/hierarchy/frame_state.h"
#include "common/scene/camera.h"
#include "tests/unit/tiny_gltf.h"

namespace rayfarm {
namespace {

using std::numbers::pi;
using test::meshes_of;
using test::notes_of;
using test::square_and;
using test::TinyGltf;

void expect_box(const Box& box, const Vec3& lo, const Vec3& hi) {
  EXPECT_NEAR(glm::length(box.lo - lo), 0, 1e-5) << box.lo.x << " " << box.lo.y << " " << box.lo.z;
  EXPECT_NEAR(glm::length(box.hi - hi), 0, 1e-5) << box.hi.x << " " << box.hi.y << " " << box.hi.z;
}

TEST(GltfScene, NodesStandInEachOtherAndShareMeshes) {
  TinyGltf file;
  const SceneDescription scene = file.load_alone(square_and(file, R"(
      "scene": 1, "scenes": [{"nodes": [3]}, {"nodes": [0]}], "nodes": [
      {"children": [1, 2], "translation": [10, 0, 0], "scale": [2, 2, 2]},
      {"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]},
      {"mesh": 0, "matrix": [0, 0, 1, 0,  0, 1, 0, 0,  1, 0, 0, 0,  0, 0, 3, 1]},
      {"mesh": 0, "translation": [1000, 0, 0]}])"));
  EXPECT_EQ(meshes_of(scene).size(), 1u);
  const CompiledScene compiled = compile(scene);
  EXPECT_EQ(compiled.scene.parts.size(), 1u);
  ASSERT_EQ(compiled.scene.instances.size(), 2u);
  // Turned to x from -1 to 0, and on its edge in x = 0, z from 3 to 4; then twice as large, from x = 10.
  expect_box(compiled.scene.poses[0].bounds, {8, 0, 0}, {10, 2, 0});
  expect_box(compiled.scene.poses[1].bounds, {10, 0, 6}, {10, 2, 8});
  EXPECT_NE(notes_of(compiled).find("of 2 scenes one is shown"), std::string::npos);
}

TEST(GltfScene, CopiesOfAMeshAreInstances) {
  TinyGltf file;
  const size_t places = file.vectors({0, 0, 0, 0, 0, 5, 7, 0, 0}),
               sizes = file.vectors({1, 1, 1, 2, 3, 1, 1, 1, 1});
  const CompiledScene compiled = compile(file.load_alone(square_and(
      file, fmt::format(
                R"("nodes": [{{"mesh": 0, "translation": [1, 0, 0], "extensions": {{"EXT_mesh_gpu_instancing":
      {{"attributes": {{"TRANSLATION": {}, "SCALE": {}}}}}}}}}])",
                places, sizes))));
  EXPECT_EQ(compiled.scene.parts.size(), 1u);
  ASSERT_EQ(compiled.scene.instances.size(), 3u);
  expect_box(compiled.scene.poses[1].bounds, {1, 0, 5}, {3, 3, 5});
  expect_box(compiled.scene.poses[2].bounds, {8, 0, 0}, {9, 1, 0});
}

TEST(GltfScene, DeepTreesStand) {
  TinyGltf file;
  std::string nodes = R"({"mesh": 0, "translation": [1, 0, 0]})";
  for (int i = 1; i < 300; ++i)
    nodes += fmt::format(R"(, {{"children": [{}], "translation": [1, 0, 0]}})", i - 1);
  const CompiledScene compiled = compile(file.load_alone(
      square_and(file, fmt::format(R"("scenes": [{{"nodes": [299]}}], "nodes": [{}])", nodes))));
  expect_box(compiled.scene.poses[0].bounds, {300, 0, 0}, {301, 1, 0});
}

TEST(GltfScene, CamerasAreTheView) {
  TinyGltf file;
  const std::string rest = square_and(file, R"(
      "nodes": [{"mesh": 0}, {"children": [2], "translation": [0, 0, 5]},
                {"camera": 0, "rotation": [0, 0.70710678, 0, 0.70710678], "name": "side"},
                {"camera": 1, "translation": [1, 2, 9], "name": "plan"}],
      "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 2, "znear": 0.5, "zfar": 50}},
                  {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 100}}])");
  const SceneDescription scene = file.load(rest);
  const ViewDescription& view = scene.view;
  EXPECT_TRUE(scene.has_view);
  EXPECT_NEAR(glm::length(view.location.values[0] - Vec4(0, 0, 5, 0)), 0, 1e-7);
  EXPECT_NEAR(glm::length(view.direction.values[0] - Vec4(-1, 0, 0, 0)), 0, 1e-7);  // -z, turned left
  EXPECT_NEAR(std::tan(view.field_of_view.values[0].x * pi / 360), 2 * std::tan(0.5), 1e-9);
  EXPECT_EQ(view.aspect, 2);
  EXPECT_EQ(view.near, 0.5);
  EXPECT_EQ(view.far, 50);
  EXPECT_NE(notes_of(compile(scene)).find("the first of 2 cameras, 'side'"), std::string::npos);
  for (const char* name : {"plan", "1"}) {
    LoadOptions options;
    options.camera = name;
    const ViewDescription plan = file.load(rest, options).view;
    EXPECT_EQ(plan.projection, Projection::orthographic);
    EXPECT_EQ(plan.width.values[0].x, 6);
    EXPECT_EQ(plan.aspect, 1.5);
    EXPECT_EQ(plan.location.values[0], Vec4(1, 2, 9, 0));
  }
  LoadOptions wrong;
  wrong.camera = "pln";
  EXPECT_THROW(file.load(rest, wrong), InputError);
}

TEST(GltfScene, WithoutACameraTheViewShowsItAll) {
  TinyGltf file;
  const CompiledScene compiled =
      compile(file.load_alone(square_and(file, R"("nodes": [{"mesh": 0, "translation": [7, 8, 9]}])")));
  const Camera camera = make_camera(compiled.scene, 0, 100, 100);
  for (const Vec3 p : {Vec3(7, 8, 9), Vec3(8, 9, 9)}) {
    const auto at = camera.project(p);
    ASSERT_TRUE(at.has_value());
    EXPECT_TRUE(at->raster.x > 5 && at->raster.x < 95 && at->raster.y > 5 && at->raster.y < 95);
  }
}

TEST(GltfScene, LightsKeepTheirNumbers) {
  TinyGltf file;
  const SceneDescription scene = file.load(square_and(file, R"(
      "extensionsUsed": ["KHR_lights_punctual"],
      "extensions": {"KHR_lights_punctual": {"lights": [
        {"type": "directional", "intensity": 3, "color": [1, 0.5, 0]}, {"type": "point", "intensity": 7, "range": 5},
        {"type": "spot", "intensity": 2, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}}]}},
      "nodes": [{"mesh": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}}},
                {"translation": [1, 2, 3], "extensions": {"KHR_lights_punctual": {"light": 1}}},
                {"rotation": [0, 1, 0, 0], "extensions": {"KHR_lights_punctual": {"light": 2}}}])"));
  const CompiledScene compiled = compile(scene);
  ASSERT_EQ(compiled.scene.lights.size(), 3u);
  const auto find = [&](LightKind kind) {
    for (const Light& light : compiled.scene.lights)
      if (light.kind == kind) return light;
    return Light();
  };
  // 3 lux on a white surface that faces it: radiance 3/π.
  const Light distant = find(LightKind::distant), bulb = find(LightKind::bulb), spot = find(LightKind::spot);
  EXPECT_NEAR(glm::length(distant.color - Color(3, 1.5, 0) / pi), 0, 1e-12);
  EXPECT_NEAR(glm::length(distant.direction - Vec3(0, 0, -1)), 0, 1e-12);
  EXPECT_EQ(bulb.color, Color(7));
  EXPECT_EQ(bulb.position, Vec3(1, 2, 3));
  EXPECT_NEAR(glm::length(spot.direction - Vec3(0, 0, 1)), 0, 1e-12);
  EXPECT_NEAR(spot.cosine_full, std::cos(0.2), 1e-12);
  EXPECT_NEAR(spot.cosine_none, std::cos(0.5), 1e-12);
  EXPECT_NE(notes_of(compiled).find("`range` of 1"), std::string::npos);
}

TEST(GltfScene, LightsInBlendersStandardUnitsAreNamed) {
  const auto note_of = [](const char* generator, const char* type, double intensity) {
    TinyGltf file;
    file.asset = fmt::format(R"("generator": "{}")", generator);
    return notes_of(compile(file.load(square_and(file, fmt::format(R"(
      "extensionsUsed": ["KHR_lights_punctual"],
      "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "{}", "intensity": {}}}]}}}},
      "nodes": [{{"mesh": 0}}, {{"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}])",
                                                                   type, intensity)))));
  };
  const char* const blender = "Khronos glTF Blender I/O v3.4.50";
  // A lamp of 1000 W and a sun of strength 1, as the exporter writes them: "Standard" and "Unitless".
  EXPECT_NE(note_of(blender, "point", 54351).find("1 of its lights are as strong as Blender writes them"),
            std::string::npos);
  EXPECT_NE(note_of(blender, "directional", 683).find("add `--exposure -9.4`"), std::string::npos);
  EXPECT_EQ(note_of(blender, "point", 79.6).find("Blender"), std::string::npos);
  EXPECT_EQ(note_of(blender, "directional", 1).find("Blender"), std::string::npos);
  EXPECT_EQ(note_of("COLLADA2GLTF", "spot", 54351).find("Blender"), std::string::npos)
      << "it may mean candela";
}

TEST(GltfScene, LightsThatCanNotShineAreNamed) {
  const auto with = [](TinyGltf& file, const char* light) {
    return square_and(file, fmt::format(R"(
      "extensionsUsed": ["KHR_lights_punctual"], "extensions": {{"KHR_lights_punctual": {{"lights": [{}]}}}},
      "nodes": [{{"mesh": 0}}, {{"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}])",
                                        light));
  };
  TinyGltf dark, wide, negative;
  EXPECT_NE(notes_of(compile(dark.load(with(dark, R"({"type": "point", "intensity": 0})"))))
                .find("1 lights without any light"),
            std::string::npos);
  EXPECT_NE(
      notes_of(compile(wide.load(with(
                   wide, R"({"type": "spot", "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.2}})"))))
          .find("the inner cone is wider"),
      std::string::npos);
  EXPECT_NE(
      negative.error(with(negative, R"({"type": "point", "color": [-1, 0, 0]})")).find("can't be negative"),
      std::string::npos);
}

TEST(GltfClip, NodesMoveByCurves) {
  TinyGltf file;
  const size_t times = file.scalars({0, 1, 3}), where = file.vectors({0, 0, 0, 2, 0, 0, 6, 0, 0}),
               stepped = file.vectors({0, 0, 0, 0, 5, 0, 0, 9, 0}),
               // x³ - 2x + 1 with its slopes
      cubic = file.vectors(
          {-2, 0, 0, 1, 0, 0, -2, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 25, 0, 0, 22, 0, 0, 25, 0, 0});
  const std::string rest = square_and(file, fmt::format(R"("nodes": [{{"mesh": 0}}], "animations": [
      {{"name": "walk", "samplers": [{{"input": {0}, "output": {1}}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}}]}},
      {{"name": "jump", "samplers": [{{"input": {0}, "output": {2}, "interpolation": "STEP"}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}}]}},
      {{"samplers": [{{"input": {0}, "output": {3}, "interpolation": "CUBICSPLINE"}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}}]}}])",
                                                        times, where, stepped, cubic));
  const auto place = [&](const char* clip, double fps, double frame) {
    LoadOptions options;
    options.clip = clip;
    options.fps = fps;
    const SceneDescription scene = file.load_alone(rest, options);
    EXPECT_EQ(*scene.frames, (std::array<int, 2>{0, static_cast<int>(3 * fps)}));
    const CompiledScene compiled = compile(scene);
    FrameState state(compiled.scene);
    return state.at(frame)[0].bounds.lo;
  };
  EXPECT_NEAR(place("", 24, 12).x, 1, 1e-9);  // half a second
  EXPECT_NEAR(place("walk", 10, 20).x, 4, 1e-9);
  EXPECT_NEAR(place("1", 10, 29).y, 5, 1e-9);
  EXPECT_NEAR(place("jump", 10, 30).y, 9, 1e-9);
  for (const double t : {0.25, 0.5, 1.5, 2.5})
    EXPECT_NEAR(place("2", 8, 8 * t).x, t * t * t - 2 * t + 1, 1e-6) << t;
  LoadOptions wrong;
  wrong.clip = "wlk";
  try {
    file.load(rest, wrong);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean 'walk'?"), std::string::npos) << e.what();
  }
}

TEST(GltfClip, CamerasMoveWithTheirNodes) {
  TinyGltf file;
  const size_t times = file.scalars({0, 1}),
               turns = file.floats("VEC4", {0, 0, 0, 1, 0, 0.70710678f, 0, 0.70710678f}, 4);
  const SceneDescription scene = file.load(square_and(
      file,
      fmt::format(R"("nodes": [{{"mesh": 0}}, {{"children": [2]}}, {{"camera": 0, "translation": [0, 0, 4]}}],
      "cameras": [{{"type": "perspective", "perspective": {{"yfov": 1, "znear": 0.1}}}}],
      "animations": [{{"samplers": [{{"input": {}, "output": {}}}], "channels": [{{"sampler": 0, "target": {{"node": 1, "path": "rotation"}}}}]}}])",
                  times, turns)));
  const CompiledScene compiled = compile(scene);
  for (const int frame : {0, 8, 24}) {
    const Camera camera = make_camera(compiled.scene, frame, 64, 48);
    const double angle = frame / 24.0 * pi / 2;
    EXPECT_NEAR(glm::length(camera.location - 4.0 * Vec3(std::sin(angle), 0, std::cos(angle))), 0, 1e-6);
    EXPECT_NEAR(glm::length(camera.forward + Vec3(std::sin(angle), 0, std::cos(angle))), 0, 1e-6);
  }
}

/// A strip of two squares above each other, whose upper edge hangs on a bone that stands at y = 1.
struct Arm {
  Arm() {
    const size_t positions = file.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0}),
                 weights = file.floats(
                     "VEC4", {2, 0, 0, 0, 2, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, 4);
    std::vector<uint8_t> which;
    for (int v = 0; v < 6; ++v)
      for (const int j : {0, 1, 0, 77})
        which.push_back(static_cast<uint8_t>(j));  // what has no weight may be anything
    const size_t named = file.accessor(5121, "VEC4", 6, fmt::format(R"("bufferView": {})", file.view(which))),
                 matrices = file.floats("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                                 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                                        16),
                 times = file.scalars({0, 1}),
                 turns = file.floats("VEC4", {0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f}, 4);
    rest = fmt::format(
        R"("nodes": [{{"mesh": 0, "skin": 0, "translation": [500, 0, 0]}}, {{"children": [2], "translation": [0, 0, 7]}}, {{"translation": [0, 1, 0]}}],
      "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}, "JOINTS_0": {}, "WEIGHTS_0": {}}}, "mode": 5}}]}}],
      "skins": [{{"joints": [1, 2], "inverseBindMatrices": {}}}],
      "animations": [{{"samplers": [{{"input": {}, "output": {}}}], "channels": [{{"sampler": 0, "target": {{"node": 2, "path": "rotation"}}}}]}}])",
        positions, named, weights, matrices, times, turns);
  }
  TinyGltf file;
  std::string rest;
};

/// Without what a quick look adds.
Box bounds_of_skin(SceneDescription scene, int frame) {
  scene.frames = {frame, frame};
  scene.objects[scene.root].children.resize(1);
  return bounds_of(scene);
}

TEST(GltfSkin, BendsWithItsBonesAlone) {
  const Arm arm;
  const SceneDescription scene = arm.file.load(arm.rest);
  ASSERT_EQ(scene.skeletons.size(), 1u);
  const auto& bones = scene.skeletons[0].bones;
  ASSERT_EQ(bones.size(), 2u);
  EXPECT_EQ(bones[1].parent, 0u);
  const MeshShape& mesh = *meshes_of(scene)[0];
  ASSERT_TRUE(mesh.deformation);
  EXPECT_EQ(mesh.deformation->influences, 4u);
  EXPECT_EQ(mesh.deformation->joints[1].bone_from_mesh.translation, Vec3(0, -1, 0));
  // The mesh's node is elsewhere, which means nothing to it. Bent by 90 degrees the upper edge lies at x =
  // -1; the middle one, which hangs on both by halves, is drawn between (1, 1) and (0, 2).
  expect_box(bounds_of_skin(scene, 0), {0, 0, 7}, {1, 2, 7});
  expect_box(bounds_of_skin(scene, 24), {-1, 0, 7}, {1, 2, 7});
}

TEST(GltfSkin, MorphTargetsHaveTheirWeights) {
  TinyGltf file;
  const size_t p = file.square(), first = file.vectors({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}),
               index = file.view(std::vector<uint16_t>{2}), value = file.view(std::vector<float>{0, 3, 0}),
               second = file.accessor(
                   5126, "VEC3", 4,
                   fmt::format(
                       R"("sparse": {{"count": 1, "indices": {{"bufferView": {}, "componentType": 5123}},
                      "values": {{"bufferView": {}}}}})",
                       index, value)),
               times = file.scalars({0, 2}), weights = file.scalars({0, 1, 1, 0});
  const std::string rest = fmt::format(R"("nodes": [{{"mesh": 0}}, {{"mesh": 0, "weights": [0.25, 0.5]}}],
      "meshes": [{{"weights": [0.1, 0.2], "primitives": [{{"attributes": {{"POSITION": {}}}, "mode": 6,
        "targets": [{{"POSITION": {}}}, {{"POSITION": {}}}]}}]}}],
      "animations": [{{"samplers": [{{"input": {}, "output": {}}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "weights"}}}}]}}])",
                                       p, first, second, times, weights);
  const SceneDescription scene = file.load(rest);
  const auto meshes = meshes_of(scene);
  ASSERT_EQ(meshes.size(), 2u);
  const auto& moved = meshes[0]->deformation->targets;
  ASSERT_EQ(moved.size(), 2u);
  ASSERT_EQ(moved[0].deltas.size(), 1u) << "the others don't move";
  EXPECT_EQ(moved[0].deltas[0].position, glm::vec3(0, 0, 1));
  EXPECT_EQ(moved[1].deltas[0].vertex, 2u);
  EXPECT_EQ(moved[0].weight.frames, (std::vector<double>{0, 48}));
  EXPECT_EQ(moved[0].weight.values[1].x, 1);
  EXPECT_EQ(moved[1].weight.values[0].x, 1);
  const auto& still = meshes[1]->deformation->targets;
  EXPECT_EQ(still[0].weight.values[0].x, 0.25);
  EXPECT_EQ(still[1].weight.values[0].x, 0.5);
}

TEST(GltfScene, MeshesAreAsSmoothAsIsAskedFor) {
  TinyGltf file;
  const size_t p = file.square(), n = file.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  file.write(test::shows(fmt::format(R"("attributes": {{"POSITION": {}, "NORMAL": {}}}, "mode": 6)", p, n)));
  for (const auto& [words, smoothing] : {std::pair{"", Smoothing::phong},
                                         {", smooth: flat", Smoothing::flat},
                                         {", smooth: center", Smoothing::center}}) {
    const SceneDescription scene =
        test::load_yaml(test::view_text() + fmt::format("scene: [{{mesh: {{file: tiny.gltf{}}}}}]\n", words));
    EXPECT_EQ(meshes_of(scene)[0]->smoothing, smoothing) << words;
    EXPECT_EQ(meshes_of(scene)[0]->normals.empty(), smoothing == Smoothing::flat);
  }
}

TEST(GltfScene, AFileIsLoadedOnceHoweverOftenItIsNamed) {
  TinyGltf file;
  file.write(square_and(file, R"("nodes": [{"mesh": 0}], "cameras": [{"type": "x"}])"));
  const SceneDescription scene = test::load_yaml(test::view_text() + R"(
scene:
  - mesh: {file: tiny.gltf}
  - {mesh: {file: tiny.gltf}, transform: {translate: [3, 0, 0]}}
  - {mesh: {file: tiny.gltf}, transform: {translate: [6, 0, 0]}}
)");
  EXPECT_EQ(meshes_of(scene).size(), 1u);
  const CompiledScene compiled = compile(scene);
  EXPECT_EQ(compiled.scene.parts.size(), 1u);
  EXPECT_EQ(compiled.scene.instances.size(), 3u);
}

}  // namespace
}  // namespace rayfarm
