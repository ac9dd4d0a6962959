// NFF files are read in pieces by all cores; the scene, the notes and the errors are those of one piece.
#include "tests/unit/pieces.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using test::primitives_of;

std::vector<std::string> read(const std::string& text, const std::vector<size_t>& borders) {
  return test::read_nff(text, "pieces.nff", borders);
}

void expect_same_however_cut(const std::string& text) {
  test::expect_same_however_cut(text, read, [](const auto& a, const auto& b) { EXPECT_EQ(a, b); });
}

const std::string kView = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 9 9\n";
const std::string kAll =
    "# s 0 0 0 1\ns 1 0 0 .5\n" + kView +
    "b .1 .2 .3\nl 1 2 3 # f\nl 1\n2\n3\nf 1 .5 .25 .8 .3 10 .1 1.5\np 3\n0 0 0\n1 0 0\n0 1 0\n"
    "p 3 0 0 0 0 1 0 0 0 1 # p\n  p 3\n0 0 0\n0 0 0\n1 1 1\n\tp 3 0.1 0 0 1 0 0 1 1 0 s 0 0 0 1\nf 1 1 1 1 0 "
    "0 0 0\n"
    "p 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\npp 3 0 0 0 0 0 1 1 0 0 0 .1 1\n0 1 0 0 0 1\np 3 0 0 0 1 0 0 0 0 2\n"
    "c 0 0 0 -.5\n0 1 0 .25\ns 0 0 0 -2 l 7 8 9 .5 .25 .125\nb 1 1 1\n" +
    kView + "f 0 0 1 1 0 0 0 0\ns 0 1 0 -1#";

std::string with_crlf(std::string text) {
  for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  return text;
}

TEST(NffPieces, EveryLineMayBeABorder) {
  const std::vector<std::string> whole = read(kAll, {});
  EXPECT_EQ(whole.size(), 23u) << "12 primitives, the view, 4 materials, 3 lights, 3 notes";
  EXPECT_EQ(whole[0], "of 0: 2:1 sphere(1 0 0)0.5");
  EXPECT_EQ(whole[1], "of 1: triangle(0 0 0)(1 0 0)(0 1 0)");
  EXPECT_EQ(whole[3], "of 1: 21:3 polygon(0 0 0)(0 0 0)(1 1 1)") << "no area: it keeps its place";
  EXPECT_EQ(whole[11], "of 3: 47:1 sphere(0 1 0)1");
  expect_same_however_cut(kAll);
  EXPECT_EQ(read(with_crlf(kAll), {}), whole);
  expect_same_however_cut(with_crlf(kAll));
  expect_same_however_cut("p 3 0 0 0 1 0 0 0 1 0\n" + kView + "f 1 1 1 1 0 0 0 0\n");
  expect_same_however_cut(kView);
}

TEST(NffPieces, WhatIsWrongIsFoundAtItsPlaceHoweverTheFileIsCut) {
  const std::string good = kView + "s 0 0 0 1\nf 1 1 1 1 0 0 0 0\n";
  for (const auto& [wrong, message] : std::vector<std::pair<std::string, std::string>>{
           {"s 0 x 0 1\n", "pieces.nff:10:5: expected a number (centre), found 'x'"},
           {"s 0 0 0\n", "pieces.nff:11:1: expected a number (radius), found 'v'"},
           {"s 0 0 0\nq 1\n", "pieces.nff:11:1: expected a number (radius), found 'q'"},
           {"\n  q 1\n", "pieces.nff:11:3: unknown record 'q'"},
           {"p 2\n0 0 0\n1 0 0\n", "pieces.nff:10:3: number of vertices must be a whole number from 3"},
           {"p 3\n0 0 0\n1 0 0\n", "pieces.nff:13:1: expected a number (vertex), found 'v'"},
           {"p 3\n0 0 0\n1 0 0\n0 1 1e16\n", "pieces.nff:13:5: vertex is larger than 1e+15"},
           {"v\nfrom 0 0 5\nat 0 0 0\nl 1 1 1\n", "pieces.nff:13:1: expected 'up', found 'l'"},
           {"s 0 nan 0 1\nq\n", "pieces.nff:10:5: centre is not a finite number"},
           {"pp\ns\n", "pieces.nff:11:1: expected a number (number of vertices), found 's'"},
           {std::string("s 0 0 0 1\0\n", 11), "pieces.nff:10:9: expected a number (radius)"}}) {
    SCOPED_TRACE(wrong);
    const std::string text = good + wrong + good;
    EXPECT_NE(read(text, {}).at(0).find(message), std::string::npos) << read(text, {}).at(0);
    expect_same_however_cut(text);
    EXPECT_EQ(read(with_crlf(text), {}), read(text, {}));
  }
  EXPECT_NE(read(good + "s 0 0\n", {}).at(0).find("pieces.nff:10:5: the file ends where centre"),
            std::string::npos)
      << read(good + "s 0 0\n", {}).at(0);
  expect_same_however_cut(good + "s 0 0\n");
  expect_same_however_cut("s 0 0 0 1\n");
  expect_same_however_cut("\r\n");
  expect_same_however_cut("");
}

TEST(NffPieces, LightsOfAllPiecesCountAgainstTheirLimit) {
  std::string text = kView;
  for (size_t i = 0; i < limits::kLights; ++i) text += "l 1 2 3\n";
  const std::vector<size_t> borders{1000, text.size() / 2, text.size() - 20};
  EXPECT_GT(read(text, borders).size(), limits::kLights);
  text += "l 1 2 3\nl x\n";
  EXPECT_EQ(read(text, {}).at(0), "pieces.nff:10008:1: too many lights");
  EXPECT_EQ(read(text, borders), read(text, {}));
}

TEST(NffPieces, AFileOfSeveralPiecesIsTheSceneOfOne) {
  std::string text = kView;
  for (int i = 0; i < 40'000; ++i)
    text +=
        fmt::format("{}p 3\n{} {:.6f} {:e}\n{} 0 1\n0 {} {:.5f}\n",
                    i % 7000 == 0 ? "f 1 0 0 1 0 0 0 0\n" : "", i, i * 0.37, i * 1.7e-3, i + 1, i, i * .01);
  ASSERT_GT(text.size(), size_t{3 << 19}) << "two pieces at least";
  const SceneDescription scene = load_scene(test::write_temporary("many.nff", text));
  EXPECT_EQ(scene.materials.size(), 6u);
  EXPECT_TRUE(primitives_of(scene) == primitives_of(read_nff_scene(text, "many.nff", {})));
}

TEST(NffPieces, TrianglesAreTheSameOneByOneAndAsAMesh) {
  std::string text = kView;
  for (int i = 0; i < 300; ++i)
    text += fmt::format("{}p 3 {} 0.{} 1 0.3 {} 0 0 {} .7\n", i % 50 == 9 ? "s 1 2 3 .1\n" : "", i,
                        i * 7 % 91, i, i * 3 % 7);
  const SceneDescription scene = read_nff_scene(text, "mesh.nff", {});
  SceneDescription single = read_nff_scene(text, "mesh.nff", {});
  std::vector<PrimitiveDescription>& primitives = single.objects[single.root].primitives;
  primitives.clear();
  for (const PrimitiveDescription& p : scene.objects[scene.root].primitives) {
    const auto* mesh = std::get_if<MeshShape>(&p.shape);
    if (!mesh) primitives.push_back(p);
    for (size_t i = 0; mesh && i < mesh->triangles.size(); ++i) {
      PolygonShape polygon;
      for (int k = 0; k < 3; ++k) polygon.points.emplace_back(mesh->positions[mesh->triangles[i][k]]);
      primitives.push_back({polygon, p.material, p.place});
    }
  }
  EXPECT_EQ(primitives.size(), 306u);
  EXPECT_LT(scene.objects[scene.root].primitives.size(), 15u);
  const CompiledScene a = compile(scene), b = compile(single);
  EXPECT_TRUE(std::ranges::equal(a.block.bytes(), b.block.bytes()));
}

}  // namespace
}  // namespace rayfarm
