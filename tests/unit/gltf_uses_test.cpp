// What several nodes and several files make of glTF: meshes of their own, copies, clips; and what is said of
// what is there and can't be used.
#include <chrono>

#include "common/compile/compile.h"
#include "common/description/formats/gltf/file.h"
#include "common/hierarchy/frame_state.h"
#include "common/image/image_file.h"
#include "tests/unit/tiny_gltf.h"

namespace rayfarm {
namespace {

using test::meshes_of;
using test::square_and;
using test::TinyGltf;

std::string all_notes(const SceneDescription& scene) {
  std::string all;
  for (const std::string& line : scene.notes.lines()) all += line + "\n";
  return all;
}
void expect_words(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << "'" << text << "' lacks '" << words << "'";
}

/// `nodes` that hang one mesh of `triangles` on a skin of `joints` joints, `at_once` of them in its list.
struct Crowd {
  Crowd(int nodes, int triangles, int joints = 1) {
    std::vector<uint32_t> indices;
    for (int i = 0; i < 3 * triangles; ++i) indices.push_back(static_cast<uint32_t>(i % 3));
    const size_t p = file.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0}), i = file.indices(indices),
                 w = file.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4),
                 named = file.accessor(
                     5121, "VEC4", 3,
                     fmt::format(R"("bufferView": {})", file.view(std::vector<uint8_t>(12, 0))));
    std::string list = "{}";
    for (int n = 0; n < nodes; ++n) list += R"(,{"mesh":0,"skin":0})";
    std::string bones = "0";
    for (int j = 1; j < joints; ++j) bones += ",0";
    rest = fmt::format(
        R"("nodes": [{}], "skins": [{{"joints": [{}]}}], "meshes": [{{"primitives": [{{"attributes":
        {{"POSITION": {}, "JOINTS_0": {}, "WEIGHTS_0": {}}}, "indices": {}}}]}}])",
        list, bones, p, named, w, i);
  }
  TinyGltf file;
  std::string rest;
};

TEST(GltfUses, ThirtyNodesMayBendALargeMesh) {
  const Crowd crowd(30, 50'000);
  const SceneDescription scene = crowd.file.load(crowd.rest);
  EXPECT_EQ(meshes_of(scene).size(), 30u);
  EXPECT_EQ(meshes_of(scene).back()->triangles.size(), 50'000u);
}

TEST(GltfUses, MeshesOfTheirOwnAreRefusedBeforeTheyAreMade) {
  const auto begin = std::chrono::steady_clock::now();
  const Crowd many(100'000, 50'000), jointed(100'000, 1, 100'000);
  for (const Crowd* crowd : {&many, &jointed}) {
    const std::string error = crowd->file.error(crowd->rest);
    expect_words(error, "nodes[");
    expect_words(error, "bends a copy of its mesh of its own");
    expect_words(error, "use fewer such nodes");
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(GltfUses, MeshesThatBendAreGivenUpWhenTheyAreCompiled) {
  TinyGltf file;
  const size_t p = file.square(), target = file.vectors({0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0}),
               times = file.scalars({0, 1}), weights = file.scalars({0, 1});
  // The first bends from frame to frame, the second is bent once and for all.
  SceneDescription scene = file.load(fmt::format(
      R"("nodes": [{{"mesh": 0}}, {{"mesh": 0, "weights": [0.5]}}],
      "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}, "mode": 6, "targets": [{{"POSITION": {}}}]}}]}}],
      "animations": [{{"samplers": [{{"input": {}, "output": {}}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "weights"}}}}]}}])",
      p, target, times, weights));
  const CompiledScene kept = compile(scene);
  ASSERT_EQ(meshes_of(scene).size(), 2u);
  ASSERT_TRUE(meshes_of(scene)[0]->deformation);
  const CompiledScene given_up = compile_away(scene);
  for (const MeshShape* mesh : meshes_of(scene)) {
    EXPECT_TRUE(mesh->positions.empty());
    EXPECT_TRUE(mesh->triangles.empty());
    EXPECT_EQ(mesh->deformation, nullptr);
  }
  EXPECT_TRUE(std::ranges::equal(kept.block.bytes(), given_up.block.bytes()));
}

TEST(GltfUses, CopiesOfAMorphedMeshShareItsShape) {
  TinyGltf file;
  const size_t p = file.square(), target = file.vectors({0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0}),
               times = file.scalars({0, 1}), weights = file.scalars({0, 1}),
               places = file.vectors({0, 0, 0, 5, 0, 0, 9, 0, 0});
  const SceneDescription scene = file.load_alone(fmt::format(
      R"("nodes": [{{"mesh": 0, "translation": [0, 7, 0], "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes": {{"TRANSLATION": {}}}}}}}}}],
      "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}, "mode": 6, "targets": [{{"POSITION": {}}}]}}]}}],
      "animations": [{{"samplers": [{{"input": {}, "output": {}}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "weights"}}}}]}}])",
      places, p, target, times, weights));
  const CompiledScene compiled = compile(scene);
  EXPECT_EQ(compiled.scene.deforming_parts.size(), 1u);
  ASSERT_EQ(compiled.scene.instances.size(), 3u);
  FrameState state(compiled.scene);
  const auto pose = state.at(24);
  for (uint32_t i = 0; i < 3; ++i) {
    const Box& box = pose[i].bounds;
    EXPECT_NEAR(box.lo.y, 7, 1e-5);
    EXPECT_NEAR(box.hi.z, 3, 1e-5) << "bent as all are";
    EXPECT_NEAR(box.lo.x, (std::array{0.0, 5.0, 9.0})[i], 1e-5);
  }
}

TEST(GltfUses, CopiesOfASkinnedMeshAreNamed) {
  Crowd crowd(1, 1);
  const size_t places = crowd.file.vectors({0, 0, 0, 5, 0, 0});
  crowd.rest.replace(
      crowd.rest.find(R"("skin":0)"), 8,
      fmt::format(
          R"("skin":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":{}}}}}}})",
          places));
  const SceneDescription scene = crowd.file.load(crowd.rest);
  EXPECT_EQ(meshes_of(scene).size(), 1u);
  expect_words(all_notes(scene), "1 copies that EXT_mesh_gpu_instancing makes of meshes with skins");
}

/// A file whose square moves by clips of these names and lengths, in seconds.
void write_clips(const std::string& name, const std::vector<std::pair<std::string, float>>& clips) {
  TinyGltf file;
  std::string list;
  for (const auto& [clip, seconds] : clips)
    list += fmt::format(
        R"({}{{"name": "{}", "samplers": [{{"input": {}, "output": {}}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}}]}})",
        list.empty() ? "" : ", ", clip,
        file.accessor(5126, "SCALAR", 2,
                      fmt::format(R"("bufferView": {}, "max": [{}])",
                                  file.view(std::vector<float>{0, seconds}), seconds)),
        file.vectors({0, 0, 0, 8, 0, 0}));
  const std::string rest = square_and(
      file, R"("nodes": [{"mesh": 0}])" + (list.empty() ? "" : fmt::format(R"(, "animations": [{}])", list)));
  std::filesystem::rename(file.write(rest, name + ".bin", name + ".bin"),
                          test::write_temporary(name + ".gltf", ""));
}

SceneDescription load_clips(const std::string& before, const std::string& clip = "") {
  LoadOptions options;
  options.clip = clip;
  return load_scene(
      test::write_temporary("clips.yaml", test::view_text() + before +
                                              "scene: [{mesh: {file: a.gltf}}, {mesh: {file: b.gltf}}, "
                                              "{mesh: {file: still.gltf}}]\n"),
      options);
}

TEST(GltfUses, ClipsAreListedWithTheirLengths) {
  write_clips("a", {{"walk", 1}, {"run", 3}});
  write_clips("b", {{"", 0.5}});
  write_clips("still", {});
  const std::vector<ClipDescription> clips = load_clips("", "run").clips;
  ASSERT_EQ(clips.size(), 3u);
  EXPECT_EQ(clips[0].name, "walk");
  EXPECT_EQ(clips[0].last_s, 1);
  EXPECT_FALSE(clips[0].is_played);
  EXPECT_EQ(clips[1].number, 1u);
  EXPECT_EQ(clips[1].last_s, 3);
  EXPECT_TRUE(clips[1].is_played);
  EXPECT_EQ(clips[2].name, "");
  EXPECT_TRUE(clips[2].file.ends_with("b.gltf")) << clips[2].file;
  EXPECT_FALSE(clips[2].is_played) << "it has no 'run'";
}

TEST(GltfUses, FramesAreThoseOfTheLongestClip) {
  write_clips("a", {{"walk", 1}});
  write_clips("b", {{"run", 3}});
  write_clips("still", {});
  EXPECT_EQ(*load_clips("").frames, (std::array{0, 72}));
  EXPECT_EQ(*load_clips("frames: [2, 5]\n").frames, (std::array{2, 5})) << "the scene has the last word";
}

TEST(GltfUses, OneFileMustHaveTheClip) {
  write_clips("a", {{"walk", 1}});
  write_clips("b", {{"run", 3}});
  write_clips("still", {});
  const SceneDescription scene = load_clips("", "run");
  EXPECT_EQ(*scene.frames, (std::array{0, 72}));
  expect_words(all_notes(scene), "a.gltf: it has no clip 'run', and stands as it does without one");
  EXPECT_EQ(all_notes(scene).find("still.gltf: it has no clip"), std::string::npos) << "it never moves";
  const CompiledScene compiled = compile(scene);
  FrameState state(compiled.scene);
  size_t moved = 0;
  for (uint32_t i = 0; i < compiled.scene.instances.size(); ++i)
    moved += state.at(72)[i].bounds.lo.x > 7.9 ? 1 : 0;
  EXPECT_EQ(moved, 1u);
  try {
    load_clips("", "rum");
    ADD_FAILURE();
  } catch (const InputError& e) {
    const std::string error = e.what();
    expect_words(error, "a.gltf: there is no clip 'rum' (it has 0 'walk')");
    expect_words(error, "b.gltf: there is no clip 'rum' (it has 0 'run'); did you mean 'run'?");
  }
}

TEST(GltfUses, WhatContradictsTheSpecificationIsNamed) {
  TinyGltf file;
  const size_t times = file.scalars({0, 1}), places = file.vectors({0, 0, 0, 8, 0, 0}),
               weights = file.scalars({0, 1});
  const SceneDescription scene = file.load_alone(square_and(file, fmt::format(R"("nodes": [
      {{"mesh": 0, "matrix": [1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  5, 0, 0, 1]}},
      {{"mesh": 0, "weights": [1], "matrix": [1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  5, 0, 0, 1], "scale": [2, 2, 2]}},
      {{"mesh": 0, "skin": 0}}], "skins": [{{"joints": []}}],
      "animations": [{{"samplers": [{{"input": {0}, "output": {1}}}, {{"input": {0}, "output": {2}}}], "channels": [
        {{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}},
        {{"sampler": 1, "target": {{"node": 1, "path": "weights"}}}}]}}])",
                                                                              times, places, weights)));
  const std::string notes = all_notes(scene);
  expect_words(notes, "nodes[0]: its `matrix` is not used, as the clip changes its translation");
  expect_words(notes, "nodes[1]: the clip changes weights of its morph targets, but it has none");
  expect_words(notes, "`weights` of 1 nodes are not used");
  expect_words(notes, "translation, rotation or scale of 1 nodes is not used");
  expect_words(notes, "skins[0] has no joints");
  EXPECT_EQ(compile(scene).scene.instances.size(), 3u);
}

TEST(GltfUses, TexturesAreMovedByNumbersThatArePossible) {
  const auto with = [](const char* transform) {
    TinyGltf file;
    test::write_temporary("two.png", "");
    write_image(test::write_temporary("two.png", ""),
                Image{1, 1, {0, 0, 1, 1}, make_pixel_layout(PixelFormat::rgb8), std::vector<std::byte>(3)},
                {});
    return file.error(square_and(file,
                                 fmt::format(R"("nodes": [{{"mesh": 0}}], "images": [{{"uri": "two.png"}}],
      "textures": [{{"source": 0}}], "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0,
      "extensions": {{"KHR_texture_transform": {{{}}}}}}}}}}}])",
                                             transform),
                                 R"(, "material": 0)"));
  };
  EXPECT_EQ(with(R"("scale": [-1000000, 0], "offset": [7, 0])"), "");
  expect_words(with(R"("scale": [1e300, 1])"), "KHR_texture_transform.scale: numbers from -1e+06 to 1e+06");
  expect_words(with(R"("offset": [0, -1e7])"), "KHR_texture_transform.offset: numbers from");
  expect_words(with(R"("offset": [0, 1e999])"), "");
  EXPECT_NE(with(R"("offset": [0, 1e999])"), "");
}

TEST(GltfUses, TangentsAreMissedWhereThereIsAMapOfNormals) {
  write_image(test::write_temporary("two.png", ""),
              Image{1, 1, {0, 0, 1, 1}, make_pixel_layout(PixelFormat::rgb8), std::vector<std::byte>(3)}, {});
  const auto notes_with = [](const char* key) {
    TinyGltf file;
    const size_t t = file.floats("VEC2", {0, 1, 1, 1, 1, 0, 0, 0}, 2),
                 tangents = file.floats("VEC4", std::vector<float>(16, 1), 4), p = file.square();
    return all_notes(file.load(fmt::format(
        R"("nodes": [{{"mesh": 0}}], "images": [{{"uri": "two.png"}}], "textures": [{{"source": 0}}],
      "materials": [{{"{}": {{"index": 0}}}}], "meshes": [{{"primitives": [{{"attributes":
      {{"POSITION": {}, "TEXCOORD_0": {}, "TANGENT": {}}}, "mode": 6, "material": 0}}]}}])",
        key, p, t, tangents)));
  };
  expect_words(notes_with("normalTexture"), "1 primitive whose TANGENT is not read");
  EXPECT_EQ(notes_with("occlusionTexture").find("TANGENT"), std::string::npos);
}

TEST(GltfUses, AFileThatShowsNothingIsAnError) {
  TinyGltf file;
  expect_words(file.error(R"("nodes": [{}])"), "there is nothing in it to look at");
  // In a scene of other things it may be empty.
  const std::string path = file.write(R"("nodes": [{}])");
  EXPECT_TRUE(
      meshes_of(test::load_yaml(test::view_text() + "scene: [{mesh: {file: " + path + "}}]\n")).empty());
}

TEST(GltfUses, PathsOfOtherMachinesAreNamed) {
  const auto with = [](const char* uri) {
    TinyGltf file;
    return file.error(square_and(
        file,
        fmt::format(R"("nodes": [{{"mesh": 0}}], "images": [{{"uri": "{}"}}], "textures": [{{"source": 0}}],
      "materials": [{{"normalTexture": {{"index": 0}}}}])",
                    uri),
        R"(, "material": 0)"));
  };
  for (const char* uri : {"C:/textures/none.png", "/nowhere/none.png", R"(textures\\none.png)"}) {
    expect_words(with(uri), "images[0].uri");
    expect_words(with(uri), "; a URI here is a path from this file on");
  }
  EXPECT_EQ(with("none.png").find("a URI here"), std::string::npos);
  expect_words(with("none.png"), "no such file");
}

TEST(GltfUses, DataInUrisIsDecodedOnce) {
  TinyGltf tiny;
  const GltfFile file(
      tiny.write(R"("images": [{"uri": "data:a;base64,AAAA"}, {"uri": "data:a;base64,AAAA"}])"), {});
  const GltfValue uri = file.item("images", 0).at("uri");
  EXPECT_EQ(file.bytes_of_uri(uri).data(), file.bytes_of_uri(uri).data());
  EXPECT_EQ(file.bytes_of_uri(uri).size(), 3u);
  EXPECT_NE(file.bytes_of_uri(uri).data(), file.bytes_of_uri(file.item("images", 1).at("uri")).data());
}

}  // namespace
}  // namespace rayfarm
