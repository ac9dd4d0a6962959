// Meshes of glTF files: all forms that vertices and faces have there.
#include <meshoptimizer.h>

#include "tests/unit/tiny_gltf.h"

namespace rayfarm {
namespace {

using test::area_of;
using test::meshes_of;
using test::shows;
using test::TinyGltf;

/// Expects one mesh that is the square of TinyGltf::square, seen from +z.
void expect_square(const SceneDescription& scene, const char* what) {
  const auto meshes = meshes_of(scene);
  ASSERT_EQ(meshes.size(), 1u) << what;
  Vec3 direction(0);
  EXPECT_NEAR(area_of(*meshes[0], &direction), 1, 1e-6) << what;
  EXPECT_NEAR(direction.z, 1, 1e-6) << what;
}

TEST(GltfMesh, FacesComeByEveryIndexAndTopology) {
  struct Case {
    const char* what;
    int mode;
    std::vector<uint8_t> order;
  };
  const Case cases[] = {{"triangles", 4, {0, 1, 2, 0, 2, 3}},
                        {"a strip", 5, {0, 1, 3, 2}},
                        {"strips with a seam", 5, {0, 1, 3, 3, 1, 1, 1, 2, 3}},
                        {"a fan", 6, {0, 1, 2, 3}}};
  for (const auto& [what, mode, order] : cases) {
    const auto with = [&]<typename T>(T) {
      TinyGltf file;
      const size_t positions = file.square();
      const size_t indices = file.indices(std::vector<T>(order.begin(), order.end()));
      expect_square(
          file.load(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "indices": {}, "mode": {})",
                                      positions, indices, mode))),
          what);
    };
    with(uint8_t());
    with(uint16_t());
    with(uint32_t());
    // Without indices the vertices stand in order.
    std::vector<float> positions;
    for (const uint8_t i : order)
      for (const float x : {i == 1 || i == 2 ? 1.f : 0.f, i >= 2 ? 1.f : 0.f, 0.f}) positions.push_back(x);
    TinyGltf file;
    const size_t accessor = file.vectors(positions);
    expect_square(
        file.load(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "mode": {})", accessor, mode))),
        what);
  }
}

TEST(GltfMesh, StandsInBinaryFilesAndInUris) {
  TinyGltf file;
  const size_t positions = file.square(), indices = file.indices<uint16_t>({0, 1, 2, 0, 2, 3});
  const std::string rest =
      shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "indices": {})", positions, indices));
  expect_square(load_scene(file.write_glb(rest)), "glb");
  // The positions of the square as base64.
  expect_square(
      load_scene(test::write_temporary(
          "uri.gltf",
          R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 48, "uri": "data:application/)"
          R"(octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAA"}],)"
          R"("bufferViews": [{"buffer": 0, "byteLength": 48}], "accessors": [{"bufferView": 0,)"
          R"("componentType": 5126, "type": "VEC3", "count": 4}], "nodes": [{"mesh": 0}],)"
          R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]}]})")),
      "a URI");
  expect_square(load_scene(file.write(rest, "with blank.bin", "with%20blank.bin")), "a name with a blank");
}

TEST(GltfMesh, ElementsMayBeApartQuantizedAndSparse) {
  {  // Interleaved with something else, from an offset.
    TinyGltf file;
    std::vector<float> both{9};
    for (const glm::vec2 p : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)})
      for (const float x : {p.x, p.y, 0.f, 7.f}) both.push_back(x);
    const size_t view = file.view(both, R"("byteStride": 16)");
    const size_t positions =
        file.accessor(5126, "VEC3", 4, fmt::format(R"("bufferView": {}, "byteOffset": 4)", view));
    expect_square(file.load(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "mode": 6)", positions))),
                  "apart");
  }
  {  // Shorts, of which 32767 is 1; and bytes as they stand, whose node makes 100 of them 1.
    TinyGltf file;
    const size_t view =
        file.view(std::vector<int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, 32767, 32767, 0, 0, 0, 32767, 0, 0},
                  R"("byteStride": 8)");
    const size_t positions =
        file.accessor(5122, "VEC3", 4, fmt::format(R"("bufferView": {}, "normalized": true)", view));
    expect_square(file.load(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "mode": 6)", positions))),
                  "normalized");
    TinyGltf bytes;
    const size_t small = bytes.view(
        std::vector<int8_t>{-50, 0, 0, 0, 50, 0, 0, 0, 50, 100, 0, 0, -50, 100, 0, 0}, R"("byteStride": 4)");
    const size_t whole = bytes.accessor(5120, "VEC3", 4, fmt::format(R"("bufferView": {})", small));
    const SceneDescription scene =
        bytes.load(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "mode": 6)", whole)));
    EXPECT_NEAR(area_of(*meshes_of(scene)[0]), 1e4, 1e-3);
  }
  for (const bool has_base : {true, false}) {  // The third and fourth vertex replace others, or zeros.
    TinyGltf file;
    const size_t base = file.view(std::vector<float>{0, 0, 0, 1, 0, 0, 5, 5, 5, 5, 5, 5}),
                 indices = file.view(std::vector<uint16_t>{1, 2, 3}),
                 values = file.view(std::vector<float>{1, 0, 0, 1, 1, 0, 0, 1, 0});
    const size_t positions = file.accessor(
        5126, "VEC3", 4,
        fmt::format(R"({}"sparse": {{"count": 3, "indices": {{"bufferView": {}, "componentType": 5123}},)"
                    R"("values": {{"bufferView": {}}}}})",
                    has_base ? fmt::format(R"("bufferView": {}, )", base) : "", indices, values));
    expect_square(file.load(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "mode": 6)", positions))),
                  "sparse");
  }
}

TEST(GltfMesh, MayBeCompressedByMeshopt) {
  const std::vector<float> corners{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<uint32_t> order{0, 1, 2, 0, 2, 3};
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(4, 12)),
      faces(meshopt_encodeIndexBufferBound(6, 4)), sequence(meshopt_encodeIndexSequenceBound(6, 4));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), corners.data(), 4, 12));
  faces.resize(meshopt_encodeIndexBuffer(faces.data(), faces.size(), order.data(), 6));
  sequence.resize(meshopt_encodeIndexSequence(sequence.data(), sequence.size(), order.data(), 6));
  const auto load = [&](const std::vector<unsigned char>& indices, const char* mode, int count) {
    TinyGltf file;
    const auto add = [&](const std::vector<unsigned char>& bytes, size_t stride, int elements,
                         const char* how) {
      return file.view(
          bytes, fmt::format(R"("extensions": {{"EXT_meshopt_compression": {{"buffer": 0, "byteOffset": {},
          "byteLength": {}, "byteStride": {}, "count": {}, "mode": "{}"}}}})",
                             file.size_after_padding(), bytes.size(), stride, elements, how));
    };
    const size_t v = add(vertices, 12, 4, "ATTRIBUTES"), i = add(indices, 4, count, mode);
    const size_t p = file.accessor(5126, "VEC3", 4, fmt::format(R"("bufferView": {})", v)),
                 o = file.accessor(5125, "SCALAR", 6, fmt::format(R"("bufferView": {})", i));
    return file.load(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "indices": {})", p, o)));
  };
  expect_square(load(faces, "TRIANGLES", 6), "triangles");
  expect_square(load(sequence, "INDICES", 6), "indices");
  EXPECT_THROW(load(sequence, "TRIANGLES", 6), InputError);
  EXPECT_THROW(load(faces, "TRIANGLES", 600'000'000), InputError);
}

TEST(GltfMesh, VerticesThatNoFaceUsesAreLeftOut) {
  TinyGltf file;
  std::vector<float> positions(3000, 3);
  const std::vector<float> corners{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  for (size_t v = 0; v < 4; ++v)
    std::copy_n(corners.begin() + 3 * static_cast<int>(v), 3, &positions[3 * (100 + 200 * v)]);
  std::vector<float> uvs(2000);
  for (size_t i = 0; i < uvs.size(); ++i) uvs[i] = static_cast<float>(i / 2);
  const size_t p = file.vectors(positions), t = file.floats("VEC2", uvs, 2),
               i = file.indices<uint16_t>({100, 300, 500, 100, 500, 700});
  const SceneDescription scene = file.load(
      shows(fmt::format(R"("attributes": {{"POSITION": {}, "TEXCOORD_0": {}}}, "indices": {})", p, t, i)));
  expect_square(scene, "few of many");
  const MeshShape& mesh = *meshes_of(scene)[0];
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.uvs[2], glm::vec2(500, 1 - 500));
}

TEST(GltfMesh, PointsAndLinesAreCounted) {
  TinyGltf file;
  const size_t p = file.square();
  const auto primitive = [&](int mode) {
    return fmt::format(R"({{"attributes": {{"POSITION": {}}}, "mode": {}}})", p, mode);
  };
  std::string all;
  for (int mode = 0; mode < 4; ++mode) all += primitive(mode) + ", ";
  const SceneDescription scene = file.load(
      fmt::format(R"("nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{}{}]}}])", all, primitive(6)));
  expect_square(scene, "beside points");
  const std::string notes = test::notes_of(compile(scene));
  EXPECT_NE(notes.find("4 points left out"), std::string::npos) << notes;
  EXPECT_NE(notes.find("9 lines left out"), std::string::npos) << notes;  // 2, 4 and 3
}

TEST(GltfMesh, HasNormalsColoursAndCoordinates) {
  TinyGltf file;
  const size_t p = file.square();
  const size_t n = file.vectors({0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1});
  const size_t colors =
      file.view(std::vector<uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 51, 255, 255, 255, 255});
  const size_t c =
      file.accessor(5121, "VEC4", 4, fmt::format(R"("bufferView": {}, "normalized": true)", colors));
  const size_t t = file.floats("VEC2", {0, 1, 1, 1, 1, 0, 0, 0}, 2);
  const SceneDescription scene = file.load(shows(fmt::format(
      R"("attributes": {{"POSITION": {}, "NORMAL": {}, "COLOR_0": {}, "TEXCOORD_0": {}, "TEXCOORD_7": {}}}, "mode": 6)",
      p, n, c, t, t)));
  const MeshShape& mesh = *meshes_of(scene)[0];
  EXPECT_EQ(mesh.smoothing, Smoothing::phong);
  EXPECT_EQ(mesh.normals[1], glm::vec3(0, 0, 2));
  EXPECT_EQ(mesh.normals[2], glm::vec3(0, 0, 1)) << "without a direction: the face's";
  EXPECT_EQ(mesh.colors[2], (VertexColor{0, 0, 65535, 13107}));
  EXPECT_EQ(mesh.uvs[0], glm::vec2(0, 0)) << "Rayfarm's v runs up";
  EXPECT_EQ(mesh.uvs[2], glm::vec2(1, 1));
  const std::string notes = test::notes_of(compile(scene));
  EXPECT_NE(notes.find("1 normal without a direction"), std::string::npos) << notes;
  EXPECT_NE(notes.find("not used of vertices: TEXCOORD_7"), std::string::npos) << notes;
  // White ones say nothing.
  TinyGltf white;
  const size_t q = white.square(), ones = white.vectors(std::vector<float>(12, 1));
  const SceneDescription plain = white.load(
      shows(fmt::format(R"("attributes": {{"POSITION": {}, "COLOR_0": {}}}, "mode": 6)", q, ones)));
  EXPECT_TRUE(meshes_of(plain)[0]->colors.empty());
  TinyGltf wild;
  const size_t r = wild.square(), wild_colors = wild.vectors({NAN, 0, 0, 1, 5, 1, 1, 1, -1, 1, 1, 1});
  EXPECT_NE(
      test::notes_of(compile(wild.load(shows(fmt::format(
                         R"("attributes": {{"POSITION": {}, "COLOR_0": {}}}, "mode": 6)", r, wild_colors)))))
          .find("3 colours of vertices that are not from 0 to 1"),
      std::string::npos);
}

}  // namespace
}  // namespace rayfarm
