// STL in text and in bytes: facets that share no vertices become a mesh that does.
#include <bit>

#include "tests/read_in_pieces.h"
#include "tests/unit/mesh_files.h"
#include "tests/unit/pieces.h"

namespace rayfarm {
namespace {

using test::mesh_of;

test::MeshOutcome read_stl(const std::string& bytes, std::span<const size_t> borders = {},
                           Smoothing smoothing = Smoothing::flat) {
  return test::read_stl(bytes, "in.stl", borders, smoothing);
}
bool has_stl_note(const test::MeshOutcome& outcome, const std::string& text) {
  return std::any_of(outcome.notes.begin(), outcome.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

using Facet = std::array<glm::vec3, 4>;  ///< a normal and three corners

std::string stl_bytes(const std::string& head, const std::vector<Facet>& facets, uint32_t told) {
  std::string bytes = head;
  bytes.resize(80, '\0');
  const auto add = [&bytes](uint32_t word, int count) {
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(word >> 8 * i & 0xff);
  };
  add(told, 4);
  for (const Facet& facet : facets) {
    for (const glm::vec3& v : facet)
      for (int k = 0; k < 3; ++k) add(std::bit_cast<uint32_t>(v[k]), 4);
    add(0, 2);
  }
  return bytes;
}
std::string stl_facet(const std::string& normal, const std::string& a, const std::string& b,
                      const std::string& c) {
  return "facet normal " + normal + "\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
         "\n endloop\nendfacet\n";
}

/// Two triangles that share an edge.
const std::vector<Facet> kTwo{{{{0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}}},
                              {{{0, 0, 1}, {0, 0, -0.0f}, {1, 1, 0}, {0, 1, 0}}}};
const std::string kTwoText = "solid a b c\n" + stl_facet("0 0 1", "0 0 0", "1 0 0", "1 1 0") +
                             "endsolid a b c\nsolid\n" + stl_facet("0 0 1", "0 0 -0", "1 1 0", "0 1 0") +
                             "endsolid\n";

TEST(Stl, TextAndBytesAreTheSameMesh) {
  const LargeVector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::string upper = kTwoText;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string returns;
  for (const char c : kTwoText) returns += c == '\n' ? "\r\n" : std::string(1, c);
  for (const std::string& bytes :
       {kTwoText, upper, returns, "\xef\xbb\xbf" + kTwoText, stl_bytes("", kTwo, 2),
        stl_bytes("solid by hand", kTwo, 2), stl_bytes(std::string(80, ' '), kTwo, 2)}) {
    const test::MeshOutcome read = read_stl(bytes);
    EXPECT_EQ(read.error, "");
    EXPECT_TRUE(read.notes.empty()) << read.notes.front();
    EXPECT_EQ(read.mesh.positions, points) << "equal points are one, -0 and 0 too";
    EXPECT_EQ(read.mesh.triangles, (LargeVector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
  }
}

TEST(Stl, NormalsAreThoseOfTheCorners) {
  std::vector<Facet> turned = kTwo;
  turned[0][0] = {0, 0, -1};
  turned[1][0] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
  const test::MeshOutcome read = read_stl(stl_bytes("", turned, 2), {}, Smoothing::phong);
  EXPECT_TRUE(
      has_stl_note(read, "points the other way than the order of its corners, which counts, 1 times"));
  EXPECT_EQ(read.mesh.normals, LargeVector<glm::vec3>(4, {0, 0, 1}));
}

TEST(Stl, WhatIsNotUsedIsNoted) {
  std::string bytes = stl_bytes("COLOR=abcd", kTwo, 2);
  bytes[84 + 48] = 1;
  const test::MeshOutcome read = read_stl(bytes + "xyz");
  EXPECT_TRUE(has_stl_note(read, "attribute")) << read.notes.size();
  EXPECT_TRUE(has_stl_note(read, "3 bytes behind the last facet"));
  EXPECT_TRUE(has_stl_note(read, "COLOR="));
  const test::MeshOutcome text = read_stl(
      "solid\nfacet normal nan -1.#IND 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
      "0\nvertex 0 1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nendloop\nendfacet");
  EXPECT_EQ(text.error, "");
  EXPECT_EQ(text.mesh.polygons.sides, LargeVector<uint32_t>{4}) << "some programs write more corners";
  EXPECT_TRUE(has_stl_note(text, "fewer than three corners is not used, 1 times"));
  EXPECT_TRUE(has_stl_note(text, "no `endsolid`"));
}

TEST(Stl, WhatIsWrongHasAPlace) {
  const auto expect = [](const std::string& bytes, const std::string& text) {
    EXPECT_NE(read_stl(bytes).error.find(text), std::string::npos) << read_stl(bytes).error;
  };
  expect("", "this one has 0");
  expect("rubbish", "this one has 7");
  expect(std::string(90, 'x'), "but ends after 0; it was cut off");
  expect(stl_bytes("", kTwo, 3), "tells of 3 facets, but ends after 2");
  expect(stl_bytes("", kTwo, 0xffffffff), "tells of 4294967295 facets");
  expect(stl_bytes("", {}, 0), "the file has no faces");
  std::vector<Facet> wrong = kTwo;
  wrong[1][2].y = std::numeric_limits<float>::infinity();
  expect(stl_bytes("", wrong, 2), "facet 2 of 2, at byte 134: a vertex is not finite");
  expect("solid\nfacet normal 0 0 1\nvertex 0 0 0\n", "in.stl:3: expected `outer loop`, found 'vertex'");
  expect("solid\nfacet normal 0 0\n", "in.stl:2: expected a number, found the line's end");
  expect("solid\nfacet normal 0 0 1 2\n", "in.stl:2: '2' is too much here");
  expect("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", "in.stl:4: expected a number, found 'x'");
  expect("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n", "in.stl:4: the vertex is not finite");
  expect("solid\n" + stl_facet("0 0 1", "0 0 0", "1 0 0", "1 1 0") + "facet normal 0 0 1\nouter loop\n",
         "the file ends within a facet");
  expect("solid\nendsolid\n", "the file has no faces");
}

TEST(Stl, TextIsTheSameHoweverItIsCut) {
  const std::string good = stl_facet("0 0 1", "0 0 0", "1 0 0", "1 1 0");
  for (const std::string& text :
       {kTwoText, "solid\n" + good + good, "solid\n" + good + "\r\r\n" + good + "vertex 1 2 3\n" + good,
        "solid\nfacet normal 0 0 1\n" + good, "solid facet normal\n" + good + "endsolid facet\n"})
    test::expect_same_however_cut(
        text, [](const std::string& t, std::vector<size_t> borders) { return read_stl(t, borders); },
        [](const test::MeshOutcome& a, const test::MeshOutcome& b) {
          EXPECT_EQ(a.error, b.error);
          EXPECT_TRUE(test::is_same(a, b));
        });
}

/// A grid of n² vertices: as many merged ones, whose order is that of the first facet that has them.
TEST(Stl, ManyFacetsShareTheirVertices) {
  constexpr int kSide = 120;
  std::vector<Facet> facets;
  const auto point = [](int x, int y) {
    return glm::vec3(0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), 3);
  };
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x + 1 < kSide; ++x) {
      facets.push_back({{{0, 0, 1}, point(x, y), point(x + 1, y), point(x + 1, y + 1)}});
      facets.push_back({{{0, 0, 1}, point(x, y), point(x + 1, y + 1), point(x, y + 1)}});
    }
  const test::MeshOutcome read = read_stl(stl_bytes("", facets, static_cast<uint32_t>(facets.size())));
  ASSERT_EQ(read.mesh.triangles.size(), facets.size());
  EXPECT_EQ(read.mesh.positions.size(), size_t{kSide * kSide});
  for (size_t i = 0; i < facets.size(); ++i)
    for (int k = 0; k < 3; ++k)
      ASSERT_EQ(read.mesh.positions[read.mesh.triangles[i][k]], facets[i][static_cast<size_t>(k) + 1]);
}

}  // namespace
}  // namespace rayfarm
