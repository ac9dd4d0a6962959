// PLY and OFF: tables of vertices and faces, in text and in bytes.
#include <bit>

#include "common/description/formats/mesh_tables.h"
#include "common/image/pixel_format.h"
#include "tests/read_in_pieces.h"
#include "tests/unit/mesh_files.h"
#include "tests/unit/pieces.h"

namespace rayfarm {
namespace {

using test::mesh_of;

/// A scene of one mesh, smooth as the file has it.
SceneDescription load_mesh_file(const std::string& name, const std::string& bytes) {
  test::write_temporary(name, bytes);
  return test::load_yaml(test::view_text() + "scene: [{mesh: {file: " + name + "}}]\n");
}
std::string error_of_mesh_file(const std::string& name, const std::string& bytes) {
  test::write_temporary(name, bytes);
  return test::error_of(test::view_text() + "scene: [{mesh: {file: " + name + "}}]\n");
}
void expect_mesh_error(const std::string& name, const std::string& bytes, const std::string& text) {
  const std::string error = error_of_mesh_file(name, bytes);
  EXPECT_NE(error.find(text), std::string::npos) << bytes.substr(0, 400) << "\n" << error;
}

/// Numbers as the bytes of a PLY file.
class PlyBytes {
 public:
  explicit PlyBytes(std::endian endian) : endian_(endian) {}
  template <typename T>
  PlyBytes& add(T value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (endian_ != std::endian::native) std::reverse(bytes.begin(), bytes.end());
    text.append(bytes.data(), bytes.size());
    return *this;
  }
  std::string text;

 private:
  std::endian endian_;
};

std::string ply(const std::string& format, const std::string& elements, const std::string& body) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n" + body;
}
const std::string kFloats = "property float x\nproperty float y\nproperty float z\n";
const std::string kIndices = "property list uchar int vertex_indices\n";

TEST(Ply, TextAndBothOrdersOfBytesAreTheSameMesh) {
  const std::string head =
      "comment made by hand\nobj_info x\nelement vertex 4\nproperty double x\nproperty short y\nproperty "
      "float z\n"
      "property int8 spare\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 2\nproperty float quality\nproperty list uint8 uint16 vertex_index\n"
      "property list int float other\n";
  const SceneDescription text = load_mesh_file(
      "a.ply", ply("ascii", head,
                   "0 0 0 1 255 0 0\n1 0 0 1 0 255 0\n\n1 1 0.5 1 0 0 255\n 0 1\t.5 1 51 102 153 \n"
                   "0.5 3 0 1 2 0\n0.5 4 0 1 2 3 2 7 8\n"));
  const MeshShape& mesh = mesh_of(text);
  EXPECT_EQ(mesh.positions, (LargeVector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0.5f}}));
  EXPECT_EQ(mesh.triangles, LargeVector<glm::uvec3>{glm::uvec3(0, 1, 2)});
  EXPECT_EQ(mesh.polygons.sides, LargeVector<uint32_t>{4});
  EXPECT_EQ(mesh.polygons.corners, (LargeVector<uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.colors.at(0), make_vertex_color({1, 0, 0}));
  EXPECT_EQ(mesh.colors.at(3), make_vertex_color({decode_srgb8(51), decode_srgb8(102), decode_srgb8(153)}))
      << "sRGB";
  test::expect_note(text, "a.ply:5:", "of element 'vertex' is not used: `spare`");
  test::expect_note(text, "a.ply:13:", "of element 'face' is not used: `quality`, `other`");
  for (const std::endian endian : {std::endian::little, std::endian::big}) {
    PlyBytes bytes(endian);
    for (const auto& [x, y, z, r, g, b] : {std::tuple(0.0, 0, 0.0f, 255, 0, 0),
                                           {1.0, 0, 0.0f, 0, 255, 0},
                                           {1.0, 1, 0.5f, 0, 0, 255},
                                           {0.0, 1, 0.5f, 51, 102, 153}})
      bytes.add(x)
          .add(static_cast<int16_t>(y))
          .add(z)
          .add(char{1})
          .add(static_cast<uint8_t>(r))
          .add(static_cast<uint8_t>(g))
          .add(static_cast<uint8_t>(b));
    const auto index = [](int n) { return static_cast<uint16_t>(n); };
    bytes.add(0.5f).add(uint8_t{3}).add(index(0)).add(index(1)).add(index(2)).add(int32_t{0});
    bytes.add(0.5f).add(uint8_t{4}).add(index(0)).add(index(1)).add(index(2)).add(index(3));
    bytes.add(int32_t{2}).add(7.0f).add(8.0f);
    const bool is_little = endian == std::endian::little;
    const SceneDescription binary = load_mesh_file(
        "a.ply", ply(is_little ? "binary_little_endian" : "binary_big_endian", head, bytes.text));
    EXPECT_TRUE(test::is_same(mesh_of(binary), mesh)) << is_little;
    EXPECT_EQ(mesh_of(binary).colors, mesh.colors);
    // Cut off at any byte it is an error, and so it is with a byte too many a note.
    for (size_t size = 0; size < bytes.text.size(); size += 7)
      EXPECT_NE(error_of_mesh_file("a.ply", ply(is_little ? "binary_little_endian" : "binary_big_endian",
                                                head, bytes.text.substr(0, size))),
                "")
          << size;
    test::expect_note(load_mesh_file("a.ply", ply(is_little ? "binary_little_endian" : "binary_big_endian",
                                                  head, bytes.text + "x")),
                      "a.ply:", "1 bytes behind");
  }
}

TEST(Ply, HeadersMayEndLinesAsTheyLike) {
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kFloats +
                           "element face 1\n" + kIndices + "end_header\n";
  // The first byte of the body is a line feed, too: 0x0a of a float.
  PlyBytes bytes(std::endian::little);
  for (const uint32_t word : {0x3f80000au, 0u, 0u, 0u, 0x3f800000u, 0u, 0u, 0u, 0x3f800000u}) bytes.add(word);
  bytes.add(uint8_t{3}).add(int32_t{2}).add(int32_t{1}).add(int32_t{0});
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char c : head) text += c == '\n' ? end : std::string(1, c);
    const SceneDescription scene = load_mesh_file("a.ply", text + bytes.text);
    EXPECT_EQ(mesh_of(scene).positions.at(0).x, std::bit_cast<float>(0x3f80000au));
    EXPECT_EQ(mesh_of(scene).triangles.at(0), glm::uvec3(2, 1, 0));
  }
}

TEST(Ply, NormalsAndCoordinatesAreTheVertices) {
  const std::string head =
      "element vertex 3\n" + kFloats +
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty "
      "float t\nelement face 1\n" +
      kIndices;
  const SceneDescription scene = load_mesh_file(
      "a.ply", ply("ascii", head, "0 0 0 0 0 1 0 1\n1 0 0 0 0 2 0.5 0.25\n0 1 0 nan 0 1 inf 0\n3 0 1 2\n"));
  const MeshShape& mesh = mesh_of(scene);
  EXPECT_EQ(mesh.smoothing, Smoothing::phong) << "the file has normals";
  EXPECT_EQ(mesh.normals, (LargeVector<glm::vec3>{{0, 0, 1}, {0, 0, 2}, {0, 0, 0}}));
  EXPECT_EQ(mesh.triangle_normals, LargeVector<glm::uvec3>{glm::uvec3(0, 1, 2)});
  EXPECT_EQ(mesh.uvs, (LargeVector<glm::vec2>{{0, 1}, {0.5f, 0.25f}, {0, 0}}));
  EXPECT_EQ(mesh.triangle_uvs, LargeVector<glm::uvec3>{glm::uvec3(0, 1, 2)});
  test::expect_note(scene, "a.ply:", "normal that is not finite or has no direction is not used, 1 times");
  test::expect_note(scene, "a.ply:", "coordinate of textures that is not finite is 0, 1 times");
}

TEST(Ply, CornersMayHaveCoordinatesOfTheirOwn) {
  const SceneDescription scene =
      load_mesh_file("a.ply", ply("ascii",
                                  "comment TextureFile wood.png\nelement vertex 4\n" + kFloats +
                                      "element face 3\n" + kIndices + "property list uchar float texcoord\n",
                                  "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 .1 .2 .3 .4 .5 .6\n3 0 2 3 0\n"
                                  "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n"));
  const MeshShape& mesh = mesh_of(scene);
  const auto uv = [&](const glm::uvec3& t, int k) { return mesh.uvs.at(t[k]); };
  EXPECT_EQ(uv(mesh.triangle_uvs.at(0), 2), glm::vec2(0.5f, 0.6f));
  EXPECT_EQ(uv(mesh.triangle_uvs.at(1), 2), glm::vec2(0));
  EXPECT_EQ(mesh.uvs.at(mesh.polygons.uvs.at(2)), glm::vec2(1, 1));
  test::expect_note(scene, "a.ply:", "are not two for each corner has none, 1 times");
  test::expect_note(scene, "a.ply:3:", "the image 'wood.png' is not used");
}

TEST(Ply, StripsTurnEverySecondTriangleOver) {
  const SceneDescription scene =
      load_mesh_file("a.ply", ply("ascii",
                                  "element vertex 5\n" + kFloats +
                                      "element tristrips 1\nproperty list int int "
                                      "vertex_indices\n",
                                  "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 2 3 4 4\n"));
  EXPECT_EQ(mesh_of(scene).triangles, (LargeVector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}}));
}

TEST(Ply, ElementsOfAnyKindMayStandAnywhere) {
  const SceneDescription scene = load_mesh_file(
      "a.ply", ply("ascii",
                   "element edge 2\nproperty int a\nproperty list uchar int b\nelement face 1\n" + kIndices +
                       "element empty 1000000000000\nelement vertex 3\n" + kFloats +
                       "element camera 1\nproperty "
                       "float f\n",
                   "1 2 3 4\n2 0\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n2.5\nmore\n"));
  EXPECT_EQ(mesh_of(scene).triangles.size(), 1u);
  test::expect_note(scene, "a.ply:3:", "element 'edge' is not used (2 of it)");
  test::expect_note(scene, "a.ply:", "1 lines behind the last row");
}

TEST(Ply, WhatIsWrongHasAPlace) {
  const std::string vertices = "element vertex 3\n" + kFloats, faces = "element face 1\n" + kIndices,
                    points = "0 0 0\n1 0 0\n0 1 0\n";
  expect_mesh_error("a.ply", "", "begins with a line `ply`");
  expect_mesh_error("a.ply", "ply\nformat ascii 1.0\n", "ends before `end_header`");
  expect_mesh_error("a.ply", "ply\nformat ascii 2.0\n", "a.ply:2:");
  expect_mesh_error("a.ply", "ply\nformt ascii 1.0\n", "did you mean 'format'?");
  expect_mesh_error("a.ply", ply("ascii", "element vertex 3\nproperty flot x\n", ""),
                    "did you mean 'float'?");
  expect_mesh_error("a.ply", ply("ascii", "element vertex -3\n", ""), "a.ply:3:");
  expect_mesh_error("a.ply", ply("ascii", "property float x\n", ""), "behind its element");
  expect_mesh_error("a.ply", ply("ascii", "element vertex 3\nproperty float x\nproperty float x\n", ""),
                    "twice");
  expect_mesh_error("a.ply", ply("ascii", "element vertex 3\nproperty float x\n", ""), "lack x, y or z");
  expect_mesh_error("a.ply", ply("ascii", faces, ""), "no element 'vertex'");
  expect_mesh_error("a.ply", ply("ascii", vertices, points), "points alone");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, points + "3 0 1 3\n"),
                    "a.ply:13: it names vertex 3");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, points + "3 0 1 -1\n"),
                    "a.ply:13: it names vertex -1");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, points + "3 0 1 1.5\n"),
                    "a whole number, found '1.5'");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, points + "-3 0 1 2\n"), "can't have -3 numbers");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, points + "4 0 1 2\n"), "a.ply:13: ");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, points), "ends after 0 of the 1 rows of `face`");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"),
                    "a.ply:11: the vertex");
  expect_mesh_error("a.ply", ply("ascii", vertices + faces, "0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n"),
                    "a.ply:11: the vertex");
  // Claims that no memory would hold.
  for (const char* count : {"4000000000", "99999999999999999999", "18446744073709551615"})
    for (const char* format : {"ascii", "binary_little_endian"})
      for (const std::string& element : {"element vertex " + std::string(count) + "\n" + kFloats,
                                         vertices + "element face " + count + "\n" + kIndices,
                                         vertices + "element other " + count + "\nproperty double a\n"})
        EXPECT_NE(error_of_mesh_file("a.ply", ply(format, element, points)), "") << element;
}

TEST(Ply, SmallFacesAreNotedWithTheirNumber) {
  const SceneDescription scene =
      load_mesh_file("a.ply", ply("ascii", "element vertex 3\n" + kFloats + "element face 4\n" + kIndices,
                                  "0 0 0 7\n1 0 0 7 7\n0 1 0\n2 0 1\n3 0 1 2\n0\n1 2\n"));
  EXPECT_EQ(mesh_of(scene).triangles.size(), 1u);
  test::expect_note(scene, "a.ply:", "fewer than three corners is not used, 3 times");
  test::expect_note(scene, "a.ply:", "of a vertex is not used, 2 times");
}

TEST(MeshTables, AreTheSameHoweverTextIsCut) {
  const std::string head = ply(
      "ascii", "element vertex 3\n" + kFloats + "element face 3\nproperty list int int vertex_index\n", "");
  for (const std::string body :
       {"0 0 0\n1 0 0 # a point\r\n\r\n# none\n0 1 0 5\r3 0 1 2\n4 0 1 2 1\n2 0 1\nend\n",
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n3 0 1 9\n3 0 0 0\n", "", "\r\n\r",
        "0 0 0\n\n\n\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1\n3 2 1 0"})
    test::expect_same_however_cut(
        head + body,
        [](const std::string& text, std::vector<size_t> borders) {
          return test::read_ply(text, "in.ply", borders);
        },
        [](const test::MeshOutcome& a, const test::MeshOutcome& b) {
          EXPECT_EQ(a.error, b.error);
          EXPECT_TRUE(test::is_same(a, b));
        });
}

TEST(MeshTables, ManyChunksAreOneMesh) {
  // A strip of 200,000 quadrilaterals: more rows than a chunk has.
  constexpr uint32_t kCount = 200'000;
  PlyBytes bytes(std::endian::big);
  for (uint32_t i = 0; i < 2 * kCount + 2; ++i)
    bytes.add(static_cast<float>(i / 2)).add(static_cast<float>(i % 2)).add(0.0f);
  for (uint32_t i = 0; i < kCount; ++i) {
    bytes.add(uint8_t{static_cast<uint8_t>(i % 3 == 0 ? 3 : 4)});
    for (const uint32_t corner : {2 * i, 2 * i + 2, 2 * i + 3}) bytes.add(corner);
    if (i % 3 != 0) bytes.add(2 * i + 1);
  }
  const SceneDescription scene = load_mesh_file(
      "a.ply", ply("binary_big_endian",
                   fmt::format("element vertex {}\n{}element face {}\nproperty list uchar uint "
                               "vertex_indices\n",
                               2 * kCount + 2, kFloats, kCount),
                   bytes.text));
  const MeshShape& mesh = mesh_of(scene);
  EXPECT_EQ(mesh.triangles.size(), (kCount + 2) / 3);
  EXPECT_EQ(mesh.polygons.sides.size(), kCount - (kCount + 2) / 3);
  for (uint32_t i = 0; i < kCount; i += 3)
    ASSERT_EQ(mesh.triangles[i / 3], glm::uvec3(2 * i, 2 * i + 2, 2 * i + 3));
  EXPECT_EQ(mesh.polygons.corners.back(), 2 * (kCount - 1) + 1);
  EXPECT_EQ(mesh.positions.back(), glm::vec3(kCount, 1, 0));
}

TEST(Off, AllKindsOfVerticesAreRead) {
  const std::string faces = "3 0 1 2\n4 0 1 2 3 # four\n";
  const auto load = [&](const std::string& head, const std::string& rest) {
    std::string text = head + "\n";
    for (const char* p : {"0 0 0", "1 0 0", "1 1 0", "0 1 0"}) text += std::string(p) + rest + "\n";
    return load_mesh_file("a.off", text + faces);
  };
  for (const char* head :
       {"OFF\n4 2 5", "OFF 4 2 5", "# x\nOFF # y\n\n# z\n4 2 0", "4 2 0", "OFF4 2 0", "OFF\r\n4 2"}) {
    const SceneDescription scene = load(head, "");
    EXPECT_EQ(mesh_of(scene).positions.size(), 4u) << head;
    EXPECT_EQ(mesh_of(scene).triangles.size(), 1u) << head;
    EXPECT_EQ(mesh_of(scene).polygons.corners, (LargeVector<uint32_t>{0, 1, 2, 3})) << head;
  }
  const SceneDescription all = load("STCNOFF\n4 2 0", " 0 0 1  0.5 1 0.25 0.5  0.1 0.2");
  EXPECT_EQ(mesh_of(all).normals.at(3), glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh_of(all).smoothing, Smoothing::phong);
  EXPECT_EQ(mesh_of(all).colors.at(3), make_vertex_color({decode_srgb(0.5), 1, decode_srgb(0.25)}, 0.5));
  EXPECT_EQ(mesh_of(all).uvs.at(3), glm::vec2(0.1f, 0.2f));
  EXPECT_EQ(mesh_of(load("COFF\n4 2 0", " 255 51 0")).colors.at(1),
            make_vertex_color({1, decode_srgb8(51), 0}));
  EXPECT_EQ(mesh_of(load("COFF\n4 2 0", " 1 0 0 1")).colors.at(1), make_vertex_color({1, 0, 0}));
  EXPECT_EQ(mesh_of(load("NOFF\n4 2 0", " 0 0 -1")).normals.at(0), glm::vec3(0, 0, -1));
  test::write_temporary("a.off", "");
  const SceneDescription colours =
      load_mesh_file("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 1 2 1\n");
  test::expect_note(colours, "a.off:", "the colour of a face is not used, 2 times");
}

TEST(Off, WhatIsWrongHasAPlace) {
  expect_mesh_error("a.off", "\n", "the file is empty");
  expect_mesh_error("a.off", "off\n1 1 1\n", "a.off:1: an OFF file begins with OFF");
  expect_mesh_error("a.off", "4OFF\n1 1 1\n", "other than three coordinates");
  expect_mesh_error("a.off", "OFF BINARY\n1 1 1\n", "binary form");
  expect_mesh_error("a.off", "OFF\n-1 1 1\n", "a.off:2: there can't be -1");
  expect_mesh_error("a.off", "OFF\n3 x 1\n", "a.off:2: expected a whole number, found 'x'");
  expect_mesh_error("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n# c\n0 1\n3 0 1 2\n", "a.off:6: expected a number");
  expect_mesh_error("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off:6: it names vertex 3");
  expect_mesh_error("a.off", "OFF\n4000000000 4000000000 0\n0 0 0\n", "of `vertex`");
}

}  // namespace
}  // namespace rayfarm
