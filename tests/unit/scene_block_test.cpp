#include "common/scene/scene_block.h"

#include <cmath>
#include <cstring>

#include "common/hierarchy/builder.h"
#include "common/hierarchy/traverser.h"
#include "common/lighting/renderer.h"
#include "common/scene/settings_codec.h"
#include "tests/render_little.h"
#include "tests/unit/damaged_scene.h"

namespace rayfarm {
namespace {

TEST(SceneBlock, ThereAndBackIsIdentical) {
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/animation.yaml"));
  const SceneBlock moved = test::copy_of(compiled.block.bytes());
  const SceneBlock again = encode_scene(decode_scene(moved.bytes()));
  ASSERT_EQ(again.size, compiled.block.size);
  EXPECT_EQ(std::memcmp(again.data.get(), compiled.block.data.get(), again.size), 0);
}

TEST(SceneBlock, CompilingTwiceGivesTheSameBytes) {
  const SceneDescription scene = test::make_mixed_scene(1, 1, 200);
  const CompiledScene a = compile(scene), b = compile(scene);
  ASSERT_EQ(a.block.size, b.block.size);
  EXPECT_EQ(std::memcmp(a.block.data.get(), b.block.data.get(), a.block.size), 0);
}

/// Every array that a test of damage must reach holds something.
TEST(SceneBlock, TheSceneOfTheseTestsFillsEveryArray) {
  const CompiledScene compiled = test::compile_everything();
  for_each_array(compiled.scene, [](const char* name, auto array) { EXPECT_FALSE(array.empty()) << name; });
}

void render_a_little(const Scene& scene) {
  try {
    test::render_little(scene, 2, 12, 8);
  } catch (const std::domain_error&) {  // a view or pose that can't be
  }
}

TEST(SceneBlock, DamagedBytesEndInAnErrorOrInASceneThatCanBeRendered) {
  const CompiledScene compiled = test::compile_everything();
  std::vector<std::pair<size_t, size_t>> arrays;  // where each lies, and its size
  for_each_array(compiled.scene, [&](const char*, auto array) {
    arrays.emplace_back(reinterpret_cast<const std::byte*>(array.data()) - compiled.block.data.get(),
                        array.size_bytes());
  });
  std::mt19937 random(3);
  int errors = 0, rendered = 0;
  for (int i = 0; i < 4000; ++i) {
    SceneBlock damaged = test::copy_of(compiled.block.bytes());
    // In each array alike, however short; words, halves of numbers, and bytes.
    for (int k = 0; k <= i % 12; ++k) {
      const auto [begin, size] = arrays[random() % arrays.size()];
      static constexpr uint32_t kValues[] = {0, 1, 0xffffffffu, 0x7fffffffu, 0x7ff80000u, 0x3ff00000u};
      const uint32_t value = random() % 2 ? kValues[random() % 6] : static_cast<uint32_t>(random());
      const size_t at = random() % size / 4 * 4;
      std::memcpy(damaged.data.get() + begin + at, &value, std::min<size_t>(size - at, random() % 2 ? 4 : 1));
    }
    try {
      render_a_little(decode_scene(damaged.bytes()));
      ++rendered;
    } catch (const SceneBlockError&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 300);
  EXPECT_GT(rendered, 300);
  for (size_t size = 0; size < compiled.block.size; size += 977)
    EXPECT_THROW(decode_scene(test::copy_of(compiled.block.bytes().first(size)).bytes()), SceneBlockError);
}

TEST(SceneBlock, WhatWouldReadOutsideIsRefused) {
  const CompiledScene compiled = test::compile_everything();
  const auto slot_of = [](VolumeNode& node, ChildKind kind) {
    size_t slot = 0;
    while (slot < 8 && node.children[slot].kind() != kind) ++slot;
    return slot;
  };
  test::expect_refusal<VolumeNode>(
      compiled, &Scene::fixed_nodes,
      [&](VolumeNode& node) {
        const size_t slot = slot_of(node, ChildKind::empty);
        if (slot == 8) return false;
        for (size_t axis = 0; axis < 3; ++axis)
          node.planes[0][axis][slot] = -9, node.planes[1][axis][slot] = 9;
        return true;
      },
      "an empty child with a box");
  test::expect_refusal<VolumeNode>(
      compiled, &Scene::fixed_nodes,
      [&](VolumeNode& node) {
        const size_t slot = slot_of(node, ChildKind::empty);
        if (slot < 8) node.children[slot].first = 1u << 30;
        return slot < 8;
      },
      "an empty child that leads somewhere");
  test::expect_refusal<SphereBlock>(
      compiled, &Scene::sphere_blocks,
      [](SphereBlock& block) {
        for (size_t lane = 0; lane < 8; ++lane)
          if (block.spheres[lane] != kNone) return block.spheres[lane] = kNone, true;
        return false;
      },
      "a lane of no sphere with live numbers");
  test::expect_refusal<TriangleBlock>(
      compiled, &Scene::triangle_blocks,
      [](TriangleBlock& block) { return block.primitives[0] = kNoPrimitive, true; },
      "a lane of no triangle with live numbers");
  test::expect_refusal<TriangleShading>(
      compiled, &Scene::triangle_shading,
      [](TriangleShading& t) {
        return t.normals = {0, kNone, kNone}, true;
      },
      "a triangle with one normal");
  test::expect_refusal<TriangleShading>(
      compiled, &Scene::triangle_shading, [](TriangleShading& t) { return t.smoothing = 4, true; },
      "a triangle of no smoothing");
  test::expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.corner_count = 5, true; },
      "a face of more corners than there are");
  test::expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.corner_count = 2, true; }, "a face of two");
  test::expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.first_normal = 1, true; },
      "a face of more normals than there are");
  test::expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.smoothing = 9, true; },
      "a face of no smoothing");
  test::expect_refusal<uint32_t>(
      compiled, &Scene::face_corners, [](uint32_t& corner) { return corner = 99, true; }, "a face's corner");
  test::expect_refusal<uint32_t>(
      compiled, &Scene::face_normals, [](uint32_t& normal) { return normal = 1u << 20, true; },
      "a face's normal");
  test::expect_refusal<Instance>(
      compiled, &Scene::instances,
      [](Instance& instance) { return instance.moving = 1000, instance.part == 0; }, "a moving instance");
  test::expect_refusal<uint32_t>(
      compiled, &Scene::moving_instances, [](uint32_t& instance) { return instance = 0, true; },
      "an instance that says that it does not move");
  test::expect_refusal<Part>(
      compiled, &Scene::parts, [](Part& part) { return part.collection.structure = Structure{99}, true; },
      "a part of no structure");
  Scene at_rest = compiled.scene;
  at_rest.moving_instances = {};
  std::vector<Instance> instances(at_rest.instances.begin(), at_rest.instances.end());
  for (Instance& instance : instances) instance.moving = kNone;
  at_rest.instances = instances;
  EXPECT_THROW(decode_scene(encode_scene(at_rest).bytes()), SceneBlockError) << "boxes over nothing";
  test::expect_refusal<Texture>(
      compiled, &Scene::textures,
      [](Texture& t) {
        t.width_px = t.height_px = 1u << 31;
        t.levels = 1;
        return t.kind == TextureKind::image;
      },
      "a number of texels that wraps");
  test::expect_refusal<ObjectLight>(
      compiled, &Scene::object_lights, [](ObjectLight& light) { return light.light = 0, true; },
      "a light that says that it stands in no object");
  test::expect_refusal<ObjectNode>(
      compiled, &Scene::object_nodes, [](ObjectNode& node) { return node.visible = 1000, true; },
      "an object that is there by a curve that is not");
  test::expect_refusal<Light>(
      compiled, &Scene::lights, [](Light& light) { return light.moving = 7, true; },
      "a light that moves nowhere");
  test::expect_refusal<Texture>(
      compiled, &Scene::textures,
      [](Texture& t) { return t.depth_px = 1u << 31, t.kind == TextureKind::array; },
      "an array deeper than its texels");
  test::expect_refusal<Material>(
      compiled, &Scene::materials,
      [](Material& m) { return m.kind == MaterialKind::mix && (m.parts[1] = 1000, true); },
      "a mix of no material");
  test::expect_refusal<Material>(
      compiled, &Scene::materials,
      [&](Material& m) {
        return m.kind == MaterialKind::mix &&
               (m.parts[0] = static_cast<uint32_t>(compiled.scene.materials.size() - 1), true);
      },
      "a mix of a later material, that may be of this one");
  test::expect_refusal<Material>(
      compiled, &Scene::materials,
      [](Material& m) { return m.kind == MaterialKind::mix && (m.texture = kNone, true); },
      "a mix by nothing");
  test::expect_refusal<SpectralColor>(
      compiled, &Scene::spectral_colors, [](SpectralColor& c) { return c.index = 1000, true; },
      "a spectrum of no material");
  test::expect_refusal<SpectralColor>(
      compiled, &Scene::spectral_colors, [](SpectralColor& c) { return c.node_count = 0, true; },
      "a spectrum without nodes");
  test::expect_refusal<SpectralColor>(
      compiled, &Scene::spectral_colors, [](SpectralColor& c) { return c.first_node = 0xfffffff0u, true; },
      "a spectrum outside of the nodes");
  test::expect_refusal<SpectrumNode>(
      compiled, &Scene::spectrum_nodes, [](SpectrumNode& node) { return node.wavelength_nm = 1e5, true; },
      "wavelengths that fall");
  test::expect_refusal<Material>(
      compiled, &Scene::materials, [](Material& m) { return m.reflections = Reflections{3}, true; },
      "reflections of a fourth kind");
  test::expect_refusal<Material>(
      compiled, &Scene::materials, [](Material& m) { return m.exponent = NAN, true; }, "no exponent");
  for (Color Material::*const colour : {&Material::interior, &Material::filter})
    test::expect_refusal<Material>(
        compiled, &Scene::materials, [colour](Material& m) { return (m.*colour).y = -1, true; },
        "light below nothing");
  test::expect_refusal<double>(
      compiled, &Scene::key_frames, [](double& frame) { return frame = NAN, true; }, "a key at no frame");
  test::expect_refusal<double>(
      compiled, &Scene::light_shares, [](double& share) { return share = -1, true; }, "a negative share");
  test::expect_refusal<double>(
      compiled, &Scene::environment_shares, [](double& share) { return share = NAN, true; },
      "a share that is no number");
}

TEST(Settings, ThereAndBack) {
  RenderSettings settings;
  settings.samples = 17;
  settings.min_weight = 0.125;
  settings.max_reflections = 3;
  settings.max_transmissions = 9;
  settings.crop = {1, 2, 30, 40};
  settings.sampling = SamplingPattern::corners;
  settings.subpixels = {3, 2};
  settings.diffuse_bands = DiffuseBands::cone;
  settings.diffuse_set = DiffuseSet::fixed;
  const RenderSettings back = decode_settings(encode_settings(settings));
  EXPECT_EQ(back.samples, 17u);
  EXPECT_EQ(back.min_weight, 0.125);
  EXPECT_EQ(back.max_reflections, 3u);
  EXPECT_EQ(back.max_transmissions, 9u);
  EXPECT_EQ(back.crop, settings.crop);
  EXPECT_EQ(back.sampling, SamplingPattern::corners);
  EXPECT_EQ(back.subpixels, settings.subpixels);
  EXPECT_EQ(back.diffuse_bands, DiffuseBands::cone);
  EXPECT_EQ(back.diffuse_set, DiffuseSet::fixed);
  EXPECT_THROW(decode_settings(std::vector<std::byte>(3)), std::exception);
  for (const Subpixels wrong : {Subpixels{0, 1}, Subpixels{1, 65}, Subpixels{1u << 31, 2}}) {
    RenderSettings damaged = settings;
    damaged.subpixels = wrong;
    EXPECT_THROW(decode_settings(encode_settings(damaged)), SettingsError);
  }
  RenderSettings damaged = settings;
  damaged.diffuse_bands = static_cast<DiffuseBands>(2);
  EXPECT_THROW(decode_settings(encode_settings(damaged)), SettingsError);
  damaged = settings;
  damaged.diffuse_set = static_cast<DiffuseSet>(2);
  EXPECT_THROW(decode_settings(encode_settings(damaged)), SettingsError);
  for (uint32_t RenderSettings::*limit :
       {&RenderSettings::max_depth, &RenderSettings::max_reflections, &RenderSettings::max_transmissions}) {
    RenderSettings wrong;
    wrong.*limit = kMostDepth + 1;
    EXPECT_THROW(decode_settings(encode_settings(wrong)), SettingsError);
  }
  damaged = settings;
  damaged.colour = ColourModel::spectral;
  damaged.colour_nodes_nm = {400, 500.5, 600};
  EXPECT_EQ(decode_settings(encode_settings(damaged)).colour_nodes_nm, damaged.colour_nodes_nm);
  for (const std::vector<double>& wrong : {std::vector<double>{400, 600, 500},
                                           {400, 500},
                                           {400, 500, NAN},
                                           {300, 500, 600},
                                           {400, 410, 420},
                                           std::vector<double>(1'000'000, 500)}) {
    damaged.colour_nodes_nm = wrong;
    EXPECT_THROW(decode_settings(encode_settings(damaged)), SettingsError);
  }
  damaged.colour_nodes_nm = {400, 500, 600};
  damaged.colour = ColourModel::meyer4;
  EXPECT_THROW(decode_settings(encode_settings(damaged)), SettingsError)
      << "wavelengths of a model that has its own";
  // As many diffuse rays and samples as there may be of each: their product once wrapped round to 0.
  settings.sampling = SamplingPattern::sobol;
  settings.lighting = LightingModel::thesis;
  settings.diffuse_rays = 4096;
  settings.samples = 1 << 20;
  EXPECT_THROW(decode_settings(encode_settings(settings)), std::runtime_error);
  settings.samples = 1 << 10;
  EXPECT_EQ(decode_settings(encode_settings(settings)).diffuse_rays, 4096u);
  settings.glass_shadows = GlassShadows::none;
  settings.ambient_colour = AmbientColour::light;
  settings.transmitted_rays = 1000;
  EXPECT_EQ(decode_settings(encode_settings(settings)).transmitted_rays, 1000u);
  EXPECT_EQ(decode_settings(encode_settings(settings)).glass_shadows, GlassShadows::none);
  EXPECT_EQ(decode_settings(encode_settings(settings)).ambient_colour, AmbientColour::light);
  for (const uint32_t rays : {0u, 1001u}) {
    settings.transmitted_rays = rays;
    EXPECT_THROW(decode_settings(encode_settings(settings)), std::runtime_error);
  }
}

}  // namespace
}  // namespace rayfarm
