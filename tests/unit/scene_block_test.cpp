#include "common/scene/scene_block.h"

#include <cmath>
#include <cstring>
#include <functional>

#include "common/hierarchy/builder.h"
#include "common/hierarchy/traverser.h"
#include "common/lighting/renderer.h"
#include "common/scene/settings_codec.h"
#include "tests/render_little.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

SceneBlock copy_of(std::span<const std::byte> bytes) {
  SceneBlock block;
  block.size = bytes.size();
  block.data.reset(static_cast<std::byte*>(std::aligned_alloc(64, (bytes.size() + 63) / 64 * 64)));
  std::memcpy(block.data.get(), bytes.data(), bytes.size());
  return block;
}

TEST(SceneBlock, ThereAndBackIsIdentical) {
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/animation.yaml"));
  const SceneBlock moved = copy_of(compiled.block.bytes());
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

/// A scene with something in every array.
CompiledScene compile_everything() {
  Image sky{4, 2, {0, 0, 4, 2}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (int i = 0; i < 24; ++i) sky.pixels.push_back(static_cast<std::byte>(10 * i));
  write_image(test::write_temporary("sky.png", ""), sky, {});
  test::write_temporary("lamp.ies", "TILT=NONE\n1 1 1 2 1 1 1 0 0 0\n1 1 1\n0 180\n0\n5 7\n");
  test::write_temporary(
      "mesh.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.2\nv 0 -1 0\nv 1 -1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n"
      "f 1/1 3/3 4/2\nf 5/1 6/2 2/3 1/1\n");
  std::string text = R"(
view: {location: {0: [0, 0, 6], 4: [1, 0, 6]}, look_at: [0, 0, 0], lens: {radius: 0.01, focus: 6}}
environment: {file: sky.png}
textures: {image: {kind: image, file: sky.png}, boards: {kind: boards}, array: {kind: array, size: [3, 2, 2], values: [0, 1, 0, 1, 0, 1, 0, 1, 0.5, 0, 1, 1], scale: 0.2}}
materials:
  painted: {color: 0.7, reflect: 0.1, texture: image, bump: {texture: boards, height: 0.01}}
  gold: {conductor: gold}
  glass: {dielectric: glass}
  lamp: {luminaire: {emission: 3, ies: lamp.ies}}
  green: {lambertian: {spectrum: [[450, 0.1], [540, 0.8], [600, 0.2]]}}
  dusty: {mix: {a: green, b: gold, by: array}}
  dustier: {mix: {a: dusty, b: painted, by: boards}}
lights: [{position: [2, 3, 4]}, {position: [0, 4, 0], ies: lamp.ies}]
objects: {pair: [{sphere: {center: [0, 0, 0], radius: 0.3}}, {sphere: {center: [1, 0, 0], radius: 0.3}}]}
frames: [0, 4]
scene:
  - {material: painted, mesh: {file: mesh.obj, smooth: phong}}
  - {material: lamp, polygon: {points: [[-1, 2, 0], [1, 2, 0], [1, 2, 1], [-1, 2, 1]]}}
  - {material: lamp, sphere: {center: [-2, 2, 0], radius: 0.2}}
  - {material: glass, quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -0.2], planes: [[0, 1, 0, 0]]}}
  - polygon: {points: [[-3, -1, -3], [3, -1, -3], [3, -1, 3], [0, -1, 0], [-3, -1, 3]],
              normals: [[0, 1, 0], [0, 1, 0], [0, 1, 0], [0, 1, 0.1], [0, 1, 0]], smooth: gouraud}
  - {material: dustier, sphere: {center: [0, 0, 1], radius: 0.4}}
  - {material: gold, use: pair, transform: [{rotate: {axis: [0, 0, 1], degrees: {0: 0, 4: 90}}}, {translate: [0, 1, 0]}]}
  - {use: pair, transform: {translate: [0, -2, 0]}}
  - {use: pair, transform: {translate: [1, -2, 0]}, visible: {0: true, 3: false}}
  - {structure: {regular: {cells: 2}}, group: [{polygon: {points: [[0, 0, -2], [1, 0, -2], [1, 1, -2], [0, 1, -2]]}},
     {sphere: {center: [0, 0, -2], radius: 0.3}}, {structure: thesis, sphere: {center: [1, 1, -2], radius: 0.3}}]}
  - {light: {position: [0, 3, 0], falloff: true}, transform: {translate: {0: [0, 0, 0], 4: [1, 0, 0]}}}
  - {use: pair, transform: {orient: {0: {axis: [0, 1, 0], degrees: 0}, 4: {axis: [0, 1, 0], degrees: 90}}}}
)";
  for (int i = 0; i < 12; ++i)
    text += fmt::format("  - {{sphere: {{center: [{}, {}, -1], radius: 0.2}}}}\n", i % 4 - 1.5, i / 4 - 1.5);
  return compile(test::load_yaml(text));
}

/// Every array that a test of damage must reach holds something.
TEST(SceneBlock, TheSceneOfTheseTestsFillsEveryArray) {
  const CompiledScene compiled = compile_everything();
  for_each_array(compiled.scene, [](const char* name, auto array) { EXPECT_FALSE(array.empty()) << name; });
}

void render_a_little(const Scene& scene) {
  try {
    test::render_little(scene, 2, 12, 8);
  } catch (const std::domain_error&) {  // a view or pose that can't be
  }
}

TEST(SceneBlock, DamagedBytesEndInAnErrorOrInASceneThatCanBeRendered) {
  const CompiledScene compiled = compile_everything();
  std::vector<std::pair<size_t, size_t>> arrays;  // where each lies, and its size
  for_each_array(compiled.scene, [&](const char*, auto array) {
    arrays.emplace_back(reinterpret_cast<const std::byte*>(array.data()) - compiled.block.data.get(),
                        array.size_bytes());
  });
  std::mt19937 random(3);
  int errors = 0, rendered = 0;
  for (int i = 0; i < 4000; ++i) {
    SceneBlock damaged = copy_of(compiled.block.bytes());
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
    EXPECT_THROW(decode_scene(copy_of(compiled.block.bytes().first(size)).bytes()), SceneBlockError);
}

/// Expects that the scene is refused when `damage` has been done to the first element of an array for which
/// it returns true.
template <typename T>
void expect_refusal(const CompiledScene& compiled, std::span<const T> Scene::*array,
                    const std::function<bool(T&)>& damage, const char* what) {
  SceneBlock copy = copy_of(compiled.block.bytes());
  const std::span<const T> elements = decode_scene(copy.bytes()).*array;
  const auto damaged = std::find_if(elements.begin(), elements.end(),
                                    [&](const T& element) { return damage(const_cast<T&>(element)); });
  ASSERT_NE(damaged, elements.end()) << what;
  EXPECT_THROW(decode_scene(copy.bytes()), SceneBlockError) << what;
}

TEST(SceneBlock, WhatWouldReadOutsideIsRefused) {
  const CompiledScene compiled = compile_everything();
  const auto slot_of = [](VolumeNode& node, ChildKind kind) {
    size_t slot = 0;
    while (slot < 8 && node.children[slot].kind() != kind) ++slot;
    return slot;
  };
  expect_refusal<VolumeNode>(
      compiled, &Scene::fixed_nodes,
      [&](VolumeNode& node) {
        const size_t slot = slot_of(node, ChildKind::empty);
        if (slot == 8) return false;
        for (size_t axis = 0; axis < 3; ++axis)
          node.planes[0][axis][slot] = -9, node.planes[1][axis][slot] = 9;
        return true;
      },
      "an empty child with a box");
  expect_refusal<VolumeNode>(
      compiled, &Scene::fixed_nodes,
      [&](VolumeNode& node) {
        const size_t slot = slot_of(node, ChildKind::empty);
        if (slot < 8) node.children[slot].first = 1u << 30;
        return slot < 8;
      },
      "an empty child that leads somewhere");
  expect_refusal<SphereBlock>(
      compiled, &Scene::sphere_blocks,
      [](SphereBlock& block) {
        for (size_t lane = 0; lane < 8; ++lane)
          if (block.spheres[lane] != kNone) return block.spheres[lane] = kNone, true;
        return false;
      },
      "a lane of no sphere with live numbers");
  expect_refusal<TriangleBlock>(
      compiled, &Scene::triangle_blocks,
      [](TriangleBlock& block) { return block.primitives[0] = kNoPrimitive, true; },
      "a lane of no triangle with live numbers");
  expect_refusal<TriangleShading>(
      compiled, &Scene::triangle_shading,
      [](TriangleShading& t) {
        return t.normals = {0, kNone, kNone}, true;
      },
      "a triangle with one normal");
  expect_refusal<TriangleShading>(
      compiled, &Scene::triangle_shading, [](TriangleShading& t) { return t.smoothing = 4, true; },
      "a triangle of no smoothing");
  expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.corner_count = 5, true; },
      "a face of more corners than there are");
  expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.corner_count = 2, true; }, "a face of two");
  expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.first_normal = 1, true; },
      "a face of more normals than there are");
  expect_refusal<MeshFace>(
      compiled, &Scene::mesh_faces, [](MeshFace& f) { return f.smoothing = 9, true; },
      "a face of no smoothing");
  expect_refusal<uint32_t>(
      compiled, &Scene::face_corners, [](uint32_t& corner) { return corner = 4, true; }, "a face's corner");
  expect_refusal<uint32_t>(
      compiled, &Scene::face_normals, [](uint32_t& normal) { return normal = 1u << 20, true; },
      "a face's normal");
  expect_refusal<Instance>(
      compiled, &Scene::instances,
      [](Instance& instance) { return instance.moving = 1000, instance.part == 0; }, "a moving instance");
  expect_refusal<uint32_t>(
      compiled, &Scene::moving_instances, [](uint32_t& instance) { return instance = 0, true; },
      "an instance that says that it does not move");
  expect_refusal<Part>(
      compiled, &Scene::parts, [](Part& part) { return part.collection.structure = Structure{3}, true; },
      "a part of no structure");
  expect_refusal<Collection>(
      compiled, &Scene::collections,
      [](Collection& c) { return c.grid = 7, c.structure == Structure::regular; }, "a collection of no grid");
  expect_refusal<Collection>(
      compiled, &Scene::collections, [](Collection& c) { return c.leaf_primitive_count = 1u << 30, true; },
      "a collection of more primitives than there are");
  expect_refusal<PrimitiveId>(
      compiled, &Scene::leaf_primitives,
      [](PrimitiveId& id) {
        return id.kind() == PrimitiveKind::collection && (id = make_primitive_id(id.kind(), 1), true);
      },
      "a collection in itself");
  expect_refusal<Grid>(
      compiled, &Scene::grids, [](Grid& grid) { return grid.cells[1] = 0, true; }, "a grid without cells");
  expect_refusal<Grid>(
      compiled, &Scene::grids, [](Grid& grid) { return grid.cells[2] = 3, true; },
      "a grid of more cells than there are");
  expect_refusal<Grid>(
      compiled, &Scene::grids, [](Grid& grid) { return grid.cell.y = NAN, true; }, "a grid of no size");
  expect_refusal<uint32_t>(
      compiled, &Scene::grid_cells, [](uint32_t& end) { return end = 1000, true; },
      "a list that ends before it begins");
  expect_refusal<PrimitivePointer>(
      compiled, &Scene::primitive_pointers,
      [](PrimitivePointer& p) { return p = make_pointer(p.kind(), 1 << 20), true; }, "a pointer to nothing");
  expect_refusal<PrimitivePointer>(
      compiled, &Scene::primitive_pointers, [](PrimitivePointer& p) { return p.bits = 3u << 30, true; },
      "a pointer of no kind");
  Scene at_rest = compiled.scene;
  at_rest.moving_instances = {};
  std::vector<Instance> instances(at_rest.instances.begin(), at_rest.instances.end());
  for (Instance& instance : instances) instance.moving = kNone;
  at_rest.instances = instances;
  EXPECT_THROW(decode_scene(encode_scene(at_rest).bytes()), SceneBlockError) << "boxes over nothing";
  expect_refusal<Texture>(
      compiled, &Scene::textures,
      [](Texture& t) {
        t.width_px = t.height_px = 1u << 31;
        t.levels = 1;
        return t.kind == TextureKind::image;
      },
      "a number of texels that wraps");
  expect_refusal<ObjectLight>(
      compiled, &Scene::object_lights, [](ObjectLight& light) { return light.light = 0, true; },
      "a light that says that it stands in no object");
  expect_refusal<ObjectNode>(
      compiled, &Scene::object_nodes, [](ObjectNode& node) { return node.visible = 1000, true; },
      "an object that is there by a curve that is not");
  expect_refusal<Light>(
      compiled, &Scene::lights, [](Light& light) { return light.moving = 7, true; },
      "a light that moves nowhere");
  expect_refusal<Texture>(
      compiled, &Scene::textures,
      [](Texture& t) { return t.depth_px = 1u << 31, t.kind == TextureKind::array; },
      "an array deeper than its texels");
  expect_refusal<Material>(
      compiled, &Scene::materials,
      [](Material& m) { return m.kind == MaterialKind::mix && (m.parts[1] = 1000, true); },
      "a mix of no material");
  expect_refusal<Material>(
      compiled, &Scene::materials,
      [&](Material& m) {
        return m.kind == MaterialKind::mix &&
               (m.parts[0] = static_cast<uint32_t>(compiled.scene.materials.size() - 1), true);
      },
      "a mix of a later material, that may be of this one");
  expect_refusal<Material>(
      compiled, &Scene::materials,
      [](Material& m) { return m.kind == MaterialKind::mix && (m.texture = kNone, true); },
      "a mix by nothing");
  expect_refusal<SpectralColor>(
      compiled, &Scene::spectral_colors, [](SpectralColor& c) { return c.index = 1000, true; },
      "a spectrum of no material");
  expect_refusal<SpectralColor>(
      compiled, &Scene::spectral_colors, [](SpectralColor& c) { return c.node_count = 0, true; },
      "a spectrum without nodes");
  expect_refusal<SpectralColor>(
      compiled, &Scene::spectral_colors, [](SpectralColor& c) { return c.first_node = 0xfffffff0u, true; },
      "a spectrum outside of the nodes");
  expect_refusal<SpectrumNode>(
      compiled, &Scene::spectrum_nodes, [](SpectrumNode& node) { return node.wavelength_nm = 1e5, true; },
      "wavelengths that fall");
  expect_refusal<Material>(
      compiled, &Scene::materials, [](Material& m) { return m.reflections = Reflections{3}, true; },
      "reflections of a fourth kind");
  expect_refusal<Material>(
      compiled, &Scene::materials, [](Material& m) { return m.exponent = NAN, true; }, "no exponent");
  for (Color Material::*const colour : {&Material::interior, &Material::filter})
    expect_refusal<Material>(
        compiled, &Scene::materials, [colour](Material& m) { return (m.*colour).y = -1, true; },
        "light below nothing");
  expect_refusal<double>(
      compiled, &Scene::key_frames, [](double& frame) { return frame = NAN, true; }, "a key at no frame");
  expect_refusal<double>(
      compiled, &Scene::light_shares, [](double& share) { return share = -1, true; }, "a negative share");
  expect_refusal<double>(
      compiled, &Scene::environment_shares, [](double& share) { return share = NAN, true; },
      "a share that is no number");
}

TEST(SceneBlock, TreesAreNoDeeperThanATraverserCanGoAndNoNodeHasTwoParents) {
  const CompiledScene compiled =
      compile(test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"));
  ASSERT_TRUE(compiled.scene.nodes.empty());
  // The part's one leaf below a chain of nodes, each of which leads to the next `ways` times.
  const auto encode_chain = [&](uint32_t count, size_t ways) {
    LargeVector<VolumeNode> nodes(count, make_empty_node());
    Part part = compiled.scene.parts[0];
    for (uint32_t i = 0; i < count; ++i)
      for (size_t slot = 0; slot < (i + 1 < count ? ways : 1); ++slot)
        set_child(nodes[i], slot, part.collection.bounds,
                  i + 1 < count ? make_child(ChildKind::inner, i + 1) : part.collection.root);
    part.collection.root = make_child(ChildKind::inner, 0);
    Scene scene = compiled.scene;
    scene.nodes = nodes;
    scene.parts = std::span(&part, 1);
    return encode_scene(scene);
  };
  const SceneBlock deepest = encode_chain(kMostHierarchyLevels - 1, 1);
  const Scene scene = decode_scene(deepest.bytes());
  FrameState state(scene);
  EXPECT_TRUE(closest_hit(scene, state.at(0), {{0, 0, 5}, {0, 0, -1}}).is_hit());
  EXPECT_THROW(decode_scene(encode_chain(kMostHierarchyLevels, 1).bytes()), SceneBlockError);
  EXPECT_THROW(decode_scene(encode_chain(10, 2).bytes()), SceneBlockError) << "2^10 ways to one leaf";
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
