// Objects compiled once, into files that scenes use: "the construction of objects into a volume hierarchy is
// done only once when the object is originally created. For a given animation sequence, the designer will
// build an object hierarchy using these objects from a library" (thesis 4.2.2, Figure 4.5).
#include "common/description/part_file.h"

#include <cstring>

#include "common/image/image_file.h"
#include "common/scene/array_offsets.h"
#include "tests/render_little.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

const char* kMaterials = R"(
  painted: {color: 0.7, reflect: 0.1, texture: image, bump: {texture: boards, height: 0.01}}
  glass: {dielectric: glass}
  lamp: {luminaire: {emission: 3, ies: lamp.ies}}
  red: {color: {spectrum: [[450, 0.1], [650, 0.9]]}, reflect: 0.1}
  tiles: {mix: {a: red, b: painted, by: cloud}}
  leaf: {principled: {base_color: boards, metallic: {texture: image, channel: b}, opacity: cloud}}
)";
const char* kPair =
    "  pair: [{material: glass, sphere: {center: [0, 0, 0], radius: 0.3}}, {material: lamp, sphere: {center: "
    "[1, 0, 0], "
    "radius: 0.1}}]\n";

/// Something in every array.
std::string nodes() {
  std::string text = R"(
  - {material: painted, mesh: {file: mesh.obj, smooth: phong}}
  - {mesh: {file: flag.gltf}}
  - {material: lamp, polygon: {points: [[-1, 2, 0], [1, 2, 0], [1, 2, 1], [-1, 2, 1]]}}
  - {material: glass, quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -0.2], planes: [[0, 1, 0, 0]]}}
  - material: painted
    polygon: {points: [[-3, -1, -3], [3, -1, -3], [3, -1, 3], [0, -1, 0], [-3, -1, 3]],
              normals: [[0, 1, 0], [0, 1, 0], [0, 1, 0], [0, 1, 0.1], [0, 1, 0]]}
  - {use: pair, transform: [{rotate: {axis: [0, 0, 1], degrees: {0: 0, 4: 90}}}, {translate: [0, 1, 0]}]}
  - {use: pair, transform: {translate: [0, -2, 0]}, visible: {0: true, 3: false}}
  - {light: {position: [0, 3, 0], falloff: true}, transform: {translate: {0: [0, 0, 0], 4: [1, 0, 0]}}}
  - {name: bulb, light: {position: [1, 3, 0], ies: lamp.ies}}
  - {light: {position: [-1, 3, 0], color: {spectrum: [[400, 0.3], [500, 0.1], [700, 0.4]]}}}
  - {material: leaf, cylinder: {base: [2, -2, 1], top: [2, 0, 1], radius: 0.3}}
  - {material: tiles, cylinder: {base: [0, -2, 1], top: [0, 0, 1], radius: 0.3}}
  - structure: {thesis: {volumes: spheres, clip: always, max_primitives: 1}}
    group:
      - {material: glass, sphere: {center: [0, 1, -3], radius: 0.3}}
      - {material: red, polygon: {points: [[0, 1, -2], [1, 1, -2], [1, 2, -2], [0, 2, -2]]}}
  - structure: {adaptive: {max_primitives: 1, depth: 4}}
    group:
      - {material: glass, sphere: {center: [0, 0, -3], radius: 0.3}}
      - {material: red, polygon: {points: [[0, 0, -2], [1, 0, -2], [1, 1, -2], [0, 1, -2]]}}
  - structure: {regular: {cells: 2}}
    group:
      - {material: glass, sphere: {center: [0, 0, -2], radius: 0.3}}
      - {material: red, polygon: {points: [[0, 0, -2], [1, 0, -2], [1, 1, -2], [0, 1, -2]]}}
      - {structure: thesis, material: red, cylinder: {base: [1, 1, -2], top: [1, 1, -3], radius: 0.3}}
  - structure: object
    group:
      - {name: vase, material: red, lathe: {profile: [[0, 0], [0.3, 0.4], [0, 0.8]], sides: 6}}
      - {name: bulb, bound: [sphere, box], material: glass, sphere: {center: [2, 0, -2], radius: 0.3}}
)";
  for (int i = 0; i < 12; ++i)
    text += fmt::format("  - {{material: glass, sphere: {{center: [{}, {}, -1], radius: 0.2}}}}\n",
                        i % 4 - 1.5, i / 4 - 1.5);
  return text;
}

void write_assets() {
  Image picture{4, 2, {0, 0, 4, 2}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (int i = 0; i < 24; ++i) picture.pixels.push_back(static_cast<std::byte>(10 * i));
  write_image(test::write_temporary("picture.png", ""), picture, {});
  test::write_temporary("lamp.ies", "TILT=NONE\n1 1 1 2 1 1 1 0 0 0\n1 1 1\n0 180\n0\n5 7\n");
  test::write_temporary("mesh.obj",
                        "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0.2 1 1 0\nvt 0 0\nvt 1 0\nvt 1 "
                        "1\nf 1/1 2/2 3/3\nf 1/1 "
                        "3/3 4/2\nv 0 -1 0 1 1 1\nv 1 -1 0 0 1 1\nf 5/1 6/2 2/3 1/1\n");
  // A triangle with two sets of coordinates, three points and then three pairs.
  test::write_temporary(
      "flag.gltf",
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)"
      "AAAAAAAAAAAAAIDAAACAPwAAAAAAAIDAAAAAAAAAgD8AAIDAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/"
      R"("}],"bufferViews":[{"buffer":0,"byteLength":60}],"accessors":[)"
      R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,-4],"max":[1,1,-4]},)"
      R"({"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC2"}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":1},"material":0}]}],)"
      R"("images":[{"uri":"picture.png"}],"textures":[{"source":0}],"materials":[{"pbrMetallicRoughness":)"
      R"({"baseColorTexture":{"index":0,"texCoord":1}}}],)"
      R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})");
}

const std::string kTextures =
    "textures: {image: {kind: image, file: picture.png}, boards: {kind: boards}, cloud: {kind: array, "
    "size: [2, 2, 1], values: [0, 1, 0.3, 0.9]}}\n";
const std::string kHead =
    "view: {location: [0, 0.5, 7], look_at: [0, 0, 0]}\nframes: [0, 4]\nlights: [{position: [4, 5, 6], "
    "color: 0.4}]\n";

/// Compiles the nodes into part.rfp.
CompiledScene compile_part() {
  write_assets();
  const std::string path = test::write_temporary(
      "part.yaml", kTextures + "materials:" + kMaterials + "objects:\n" + kPair + "scene:" + nodes());
  CompiledScene part = compile(load_scene(path), {}, Purpose::library);
  write_part_file(test::write_temporary("part.rfp", ""), part.block, path);
  return part;
}

/// A scene that uses the nodes twice, moved: from the file, or as they are written. A material stands in the
/// place of the one that the file has as its first.
std::string scene_with_file(bool is_library, const std::string& more = "") {
  const std::string use = is_library ? "{file: part.rfp}" : "part";
  std::string text = kHead;
  if (!is_library)
    text += kTextures + "materials:\n  first: {}" + kMaterials + "objects:\n  part:" +
            [] {
              std::string indented;
              for (const char c : nodes()) indented += c == '\n' ? std::string("\n  ") : std::string(1, c);
              return indented;
            }() +
            "\n" + kPair;
  return text + "scene:\n" + more + "  - {use: " + use +
         ", transform: {translate: {0: [0, 0, 0], 4: [0, 1, 0]}}}\n" + "  - {use: " + use +
         ", transform: [{scale: 0.5}, {translate: [2, 0, 0]}], visible: {0: true, 2: false}}\n";
}

TEST(PartFile, ScenesHaveTheArraysOfTheSameObjectsWrittenInThem) {
  compile_part();
  const CompiledScene inlined = compile(test::load_yaml(scene_with_file(false))),
                      used = compile(test::load_yaml(scene_with_file(true)));
  std::map<std::string, std::string> arrays;
  for_each_array(inlined.scene, [&](const char* name, auto array) {
    const auto bytes = std::as_bytes(array);
    arrays[name].assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  });
  for_each_array(used.scene, [&](const char* name, auto array) {
    const auto bytes = std::as_bytes(array);
    EXPECT_EQ(bytes.size(), arrays[name].size()) << name;
    EXPECT_TRUE(bytes.size() == arrays[name].size() &&
                (bytes.empty() || std::memcmp(bytes.data(), arrays[name].data(), bytes.size()) == 0))
        << name;
  });
  // Nothing of that is empty that comes from the file: what were forgotten would show.
#define RAYFARM_ARRAY(element, name, role) \
  EXPECT_TRUE(ArrayRole::role == ArrayRole::remade || !used.scene.name.empty()) << #name;
#include "common/scene/scene_arrays.inc"
#undef RAYFARM_ARRAY
}

TEST(PartFile, PicturesAreThoseOfTheSameObjectsWrittenInTheScene) {
  compile_part();
  // Objects of the scene's own before them: every index moves.
  std::string more =
      "  - {triangles: {points: [[-3, -2, 1], [3, -2, 1], [0, 3, -4]], triangles: [[0, 1, 2]], normals: "
      "[[0, 0, 1], [0, 0.1, 1], [0.1, 0, 1]]}}\n"
      "  - {cylinder: {base: [-2, 0, 0], top: [-2, 2, 0], radius: 0.2}}\n"
      "  - polygon: {points: [[-3, -1.5, -3], [3, -1.5, -3], [3, -1.5, 3], [0, -1.5, 0], [-3, -1.5, 3]]}\n";
  for (int i = 0; i < 12; ++i)
    more += fmt::format("  - {{sphere: {{center: [{}, 1.5, -2], radius: 0.2}}}}\n", 0.5 * i - 3);
  const CompiledScene inlined = compile(test::load_yaml(scene_with_file(false, more))),
                      used = compile(test::load_yaml(scene_with_file(true, more)));
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    RenderSettings settings = test::picture_settings(40, 30, model);
    settings.colour = model == LightingModel::whitted ? ColourModel::meyer4 : ColourModel::rgb;
    settings.samples = 2;
    settings.max_depth = 4;
    settings.shutter = 0.5;
    for (const int frame : {0, 3})
      EXPECT_EQ(Renderer(used.scene, settings).render(frame, settings.crop, [] {}).pixels,
                Renderer(inlined.scene, settings).render(frame, settings.crop, [] {}).pixels)
          << static_cast<int>(model);
  }
}

TEST(PartFile, AFileIsReadAndStoredOnceHoweverOftenItIsUsed) {
  const CompiledScene part = compile_part();
  const SceneDescription twice = test::load_yaml(scene_with_file(true));
  EXPECT_EQ(twice.libraries.size(), 1u);
  EXPECT_EQ(compile(twice).scene.parts.size(), part.scene.parts.size());
  EXPECT_EQ(std::count_if(twice.files.begin(), twice.files.end(),
                          [](const std::string& file) { return file.ends_with("part.rfp"); }),
            1);
}

TEST(PartFile, AFileMayHoldOthers) {
  compile_part();
  const std::string path = test::write_temporary(
      "outer.yaml",
      "scene:\n  - {use: {file: part.rfp}, transform: {translate: [1, 0, 0]}}\n  - {sphere: {center: [0, 5, "
      "0], radius: 1}}\n");
  const CompiledScene outer = compile(load_scene(path), {}, Purpose::library);
  write_part_file(test::write_temporary("outer.rfp", ""), outer.block, path);
  const auto spheres = [](const std::string& file) {
    return compile(test::load_yaml(test::view_text() + "scene: [{use: {file: " + file + "}}]\n"))
        .scene.spheres.size();
  };
  EXPECT_EQ(spheres("outer.rfp"), spheres("part.rfp") + 1);
}

/// The error of a scene that uses the file after `damage`.
std::string error_after(const std::function<void(std::string&)>& damage) {
  compile_part();
  const std::string path = test::write_temporary("unused", "");
  const std::string file = std::filesystem::path(path).parent_path() / "part.rfp";
  std::ifstream in(file, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  damage(bytes);
  std::ofstream(file, std::ios::binary) << bytes;
  return test::error_of(test::view_text() + "scene:\n  - {use: {file: part.rfp}}\n");
}

void expect_error(const std::string& error, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(error.find(word), std::string::npos) << word << "\n" << error;
}

TEST(PartFile, OtherBuildsAndDamageEndInErrorsThatSayWhatToDo) {
  const std::string place = "scene.yaml:3:18: ";
  expect_error(
      error_after([](std::string& s) { s[20] ^= 1; }),
      {place, "part.rfp: was compiled by another build of Rayfarm", "`rayfarm compile ", "part.yaml -o "});
  expect_error(error_after([](std::string& s) { s[0] = 'x'; }),
               {place, "is no file of compiled objects", "rayfarm compile part.yaml -o part.rfp"});
  expect_error(error_after([](std::string& s) { s.resize(300); }), {place, "is no file of compiled objects"});
  expect_error(error_after([](std::string& s) { s.resize(s.size() - 1); }),
               {place, "is damaged: it has ", "copy it again, or compile it again"});
  expect_error(error_after([](std::string& s) { s += 'x'; }), {place, "is damaged: it has "});
  expect_error(error_after([](std::string& s) { s[s.size() / 2] ^= 4; }),
               {place, "is damaged: its checksum is another"});
  expect_error(error_after([](std::string& s) { s[150] = '\x1b', s[20] ^= 1; }), {"another build"});
}

TEST(PartFile, WhatIsNoneIsRefusedWithItsPlace) {
  const auto error = [](const std::string& use) {
    return test::error_of(test::view_text() + "scene:\n  - {use: " + use + "}\n");
  };
  expect_error(error("{file: none.rfp}"), {"scene.yaml:3:18: ", "none.rfp: no such file"});
  expect_error(error("{file: mesh.obj}"),
               {"scene.yaml:3:18: ", "`rayfarm compile part.yaml -o part.rfp`", "`mesh: "});
  expect_error(error("part.rfp"), {"unknown object 'part.rfp'", "`use: {file: part.rfp}`"});
  expect_error(error("{files: a.rfp}"), {"did you mean 'file'"});
}

TEST(PartFile, DamageThatTheChecksumDoesNotShowEndsInAnErrorOrInAScene) {
  const CompiledScene part = compile_part();
  std::vector<std::pair<size_t, size_t>> arrays;
  for_each_array(part.scene, [&](const char*, auto array) {
    if (!array.empty())
      arrays.emplace_back(reinterpret_cast<const std::byte*>(array.data()) - part.block.data.get(),
                          array.size_bytes());
  });
  const std::string scene = test::write_temporary("scene.yaml", scene_with_file(true));
  const std::string file = std::filesystem::path(scene).parent_path() / "part.rfp";
  std::mt19937 random(5);
  int errors = 0, rendered = 0;
  for (int i = 0; i < 250; ++i) {
    SceneBlock damaged;
    damaged.size = part.block.size;
    damaged.data.reset(static_cast<std::byte*>(std::aligned_alloc(64, damaged.size)));
    std::memcpy(damaged.data.get(), part.block.data.get(), damaged.size);
    for (int k = 0; k <= i % 5; ++k) {
      const auto [begin, size] = arrays[random() % arrays.size()];
      static constexpr uint32_t kValues[] = {0, 1, 0xffffffffu, 0x7fffffffu, 0x7ff80000u, 0x3ff00000u};
      const uint32_t value = random() % 2 ? kValues[random() % 6] : static_cast<uint32_t>(random());
      const size_t at = random() % size / 4 * 4;
      std::memcpy(damaged.data.get() + begin + at, &value, std::min<size_t>(size - at, random() % 2 ? 4 : 1));
    }
    write_part_file(file, damaged, "part.yaml");
    try {
      test::render_little(compile(load_scene(scene)).scene, 1, 8, 6);
      ++rendered;
    } catch (const InputError&) {
      ++errors;
    } catch (const IoError&) {
      ++errors;
    } catch (const std::domain_error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 20);
  EXPECT_GT(rendered, 20);
}

TEST(PartFile, WhatBelongsToASceneIsLeftOutAndTold) {
  const auto notes = [](const std::string& text) {
    std::string all;
    const CompiledScene compiled = compile(test::load_yaml(text), {}, Purpose::library);
    for (const std::string& line : compiled.notes.lines()) all += line + "\n";
    EXPECT_TRUE(compiled.scene.lights.empty());
    return all;
  };
  const std::string ball = "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n";
  EXPECT_EQ(notes(ball), "");
  expect_error(notes(test::view_text() + "lights: [{position: [1, 2, 3]}]\nambient: 0.5\n" + ball),
               {"`view`, `lights`, `ambient`: left out"});
  compile_part();
  BuildOptions thesis;
  thesis.hierarchy = Hierarchy::thesis;
  const CompiledScene compiled = compile(test::load_yaml(scene_with_file(true)), thesis);
  ASSERT_FALSE(compiled.notes.lines().empty());
  expect_error(compiled.notes.lines().back(), {"part.rfp", "its volumes stay as they were built"});
}

TEST(PartFile, AFileIsASceneToLookAt) {
  compile_part();
  const std::string path = test::write_temporary("unused", "");
  const SceneDescription scene = load_scene(std::filesystem::path(path).parent_path() / "part.rfp");
  ASSERT_TRUE(scene.frames);
  EXPECT_EQ(*scene.frames, (std::array{0, 4}));
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.width_px = 16;
  settings.height_px = 12;
  settings.crop = {0, 0, 16, 12};
  EXPECT_GT(Renderer(compiled.scene, settings).render(0, settings.crop, [] {}).eye_hits, 5u);
}

}  // namespace
}  // namespace rayfarm
