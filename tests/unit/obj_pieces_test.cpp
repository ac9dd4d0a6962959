// OBJ files are read in pieces by all cores; the mesh, the notes and the errors are those of one piece.
#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>

#include "common/description/formats/obj_piece.h"
#include "tests/unit/pieces.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using Read = test::MeshOutcome;

Read read(const std::string& text, const std::vector<size_t>& borders) {
  return test::read_obj(text, test::write_temporary("pieces.obj", ""), borders);
}

void expect_same_however_cut(const std::string& text) {
  test::expect_same_however_cut(text, read, [](const Read& a, const Read& b) {
    EXPECT_EQ(a.error, b.error);
    EXPECT_EQ(a.notes, b.notes);
    EXPECT_EQ(a.materials, b.materials);
    EXPECT_TRUE(test::is_same(a, b));
  });
}

const std::string kAll =
    "# all that a file may say\r\nmtllib pieces.mtl\n\nv 0 0 0\nv 1 0 0\r\nv  1\t1 0 1\rv 0 1 0 1 .5 .5 .5\n"
    "vt 0 0\nvt 1\nvn 0 0 1\nvn 0 0 -1\ns 1\ng a b\nusemtl red\nf 1 2 3\nf 1/1/1 2/2/1 3//1 4\n"
    "usemtl green\nf -4 -3 -1\nf 1//-1 2//-2 3//-1\nstrange thing\nf 1 2\nf \nv 2 2 2e-1\r\r\ns off\n"
    "usemtl none\nf -1 \\\n 1 \\\r\n2\n# no end \\\ns 3\n  f 1/-1 2/2 3/1\nf 1 2 3 4 5\nstrange again\nf "
    "-5//1 -4//1 -3//1";

TEST(ObjPieces, EveryByteMayBeABorder) {
  test::write_temporary("pieces.mtl", "newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0\nodd 1\n");
  const Read whole = read(kAll, {});
  EXPECT_EQ(whole.error, "");
  EXPECT_EQ(whole.mesh.triangles.size(), 6u);
  EXPECT_EQ(whole.mesh.triangles[1], glm::uvec3(0, 1, 3)) << "-4 -3 -1 of four vertices";
  EXPECT_EQ(whole.mesh.triangles[3], glm::uvec3(4, 0, 1)) << "-1 of five";
  EXPECT_EQ(whole.mesh.triangle_normals[2], glm::uvec3(1, 0, 1));
  EXPECT_EQ(whole.mesh.polygons.sides, (LargeVector<uint32_t>{4, 5}));
  EXPECT_EQ(whole.mesh.materials, (LargeVector<uint32_t>{1, 2, 2, 0, 0, 0}));
  EXPECT_EQ(whole.notes.size(), 4u) << "odd; strange, twice; f 1 2, and f; material none";
  expect_same_however_cut(kAll);
}

TEST(ObjPieces, WhatIsWrongIsFoundAtItsLineHoweverTheFileIsCut) {
  const std::string good = "v 0 0 0\r\nv 1 0 0\rv 0 1 0\nf 1 2 3\n";
  test::write_temporary("wrong.mtl", "newmtl a\nKd 1 0\n");
  for (const auto& [wrong, message] : std::vector<std::pair<std::string, std::string>>{
           {"v 1 x 2\n" + good, "pieces.obj:5:5: expected a finite number, found 'x'"},
           {"f 1 2 3/x\nv 1\n", "pieces.obj:5:7: expected a corner"},
           {"f 1 \\\n 2 x\n", "pieces.obj:6:4: expected a corner"},
           {"f 1 2 0\n", "pieces.obj:5:7: expected a corner"},
           {"v 1 2 1e39\n", "pieces.obj:5:7: the number is beyond"},
           {"v 1 2 2e15\n" + good, "vertex 4 is not finite or beyond 1e+15"},
           {good + "f 1 2 7\nf 1 2 9\n",
            "pieces.obj:9: the face names vertex 7 and normal 0, but the file has 6"},
           {"f 1 2 -4\n", "pieces.obj:5: the face counts back beyond the file's first vertex"},
           {"vn 0 0 1\nf 1 2 3\nf 1//-1 2//-1 3//-2\n", "pieces.obj:7: the face counts back beyond"},
           {"vt 0 0\nvt 0 1\nf 1/-1 2/-2 3/-3\n", "pieces.obj:7: the face counts back beyond"},
           {"mtllib wrong.mtl\nv y\n", "wrong.mtl:2:"},
           {"v y\nmtllib wrong.mtl\n", "pieces.obj:5:3:"},
           {"\nmtllib missing.mtl\nv y\n", "pieces.obj:7:3:"},
           {std::string("f 1 2 3\0 1\n", 11), "pieces.obj:5:7: expected a corner"},
           {std::string("v 1 2 \0003\n", 9), "pieces.obj:5:7: expected a finite number"}}) {
    const std::string text = good + wrong;
    SCOPED_TRACE(wrong);
    EXPECT_NE(read(text, {}).error.find(message), std::string::npos) << read(text, {}).error;
    expect_same_however_cut(text);
  }
  expect_same_however_cut("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  expect_same_however_cut("\r\n\r");
  expect_same_however_cut("");
  expect_same_however_cut(std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n\0\0 1\nf 1 2 3\n", 36));
}

TEST(ObjPieces, LinesMayBeLongerThanPieces) {
  std::string text = "# " + std::string(3 << 20, '#') + "\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf";
  constexpr size_t kCorners = 400'000;  // 2.4 MB
  for (size_t i = 0; i < kCorners; ++i) text += i % 2 ? " 1 " : " -4 ";
  text += "\nf 1 2 3";
  test::write_temporary("long.obj", text);
  const SceneDescription scene = test::load_yaml(test::view_text() + "scene: [{mesh: {file: long.obj}}]\n");
  const auto& mesh = std::get<MeshShape>(scene.objects[scene.root].primitives[0].shape);
  EXPECT_EQ(mesh.polygons.sides, LargeVector<uint32_t>{kCorners});
  EXPECT_EQ(mesh.triangles, LargeVector<glm::uvec3>{glm::uvec3(0, 1, 2)});
}

TEST(ObjPieces, AFileOfSeveralPiecesIsTheMeshOfOne) {
  std::string text;
  for (int i = 0; i < 60'000; ++i)
    text += fmt::format("v {} {:.6f} {:e}\n{}f {} {} {}\n", i, i * 0.37, i * 1.7e-3,
                        i % 7000 == 0 ? "usemtl a\n" : "", i + 1, i % 3 ? -1 : 1, 60'000 - i);
  ASSERT_GT(text.size(), size_t{2 << 20}) << "two pieces at least";
  test::write_temporary("many.obj", text);
  const SceneDescription scene =
      test::load_yaml(test::view_text() + "scene: [{mesh: {file: many.obj, smooth: phong}}]\n");
  const auto& mesh = std::get<MeshShape>(scene.objects[scene.root].primitives[0].shape);
  const Read whole = read(text, {});
  EXPECT_TRUE(mesh.positions == whole.mesh.positions && mesh.triangles == whole.mesh.triangles &&
              mesh.normals == whole.mesh.normals && mesh.materials == whole.mesh.materials);
}

TEST(ObjPieces, NumbersAreRoundedCorrectly) {
  const Read read_numbers = read(
      "v 1e-05 0.1 +16777217\nv .3333333333333333 -7.0064923216240854e-46 1\n"
      "v 3.4028234663852886e38 1 1\nf 1 2 1\n",
      {});
  EXPECT_NE(read_numbers.error.find("vertex 3"), std::string::npos) << "a float, but beyond 1e15";
  const Read small = read("v 1e-05 0.1 +16777219\nv .3333333333333333 1e-45 1.\nf 1 2 1\n", {});
  EXPECT_EQ(small.mesh.positions[0], glm::vec3(1e-05f, 0.1f, 16777220.0f));
  EXPECT_EQ(small.mesh.positions[1], glm::vec3(1.0f / 3, std::numeric_limits<float>::denorm_min(), 1));
}

/// Numbers halfway between two floats, and next to it by less than a double tells apart, among them those of
/// few bits (below 1.2e-38), of 0 and the largest float.
TEST(ObjPieces, NumbersNextToHalfwayAreRoundedAsTheLibraryDoes) {
  std::mt19937 random(1);
  std::vector<std::string> words{"1e-400", "-1e-400", "+0.0001e-9999999999999999999",
                                 "3.4028235677973366e38"};
  for (uint32_t i = 0; i < 34'000; ++i) {
    // Every eighth is small, for all others are so too seldom.
    const auto bits = static_cast<uint32_t>(random() % (i % 8 == 0 ? 0x00a00000u : 0x7f7fffffu));
    const double below = std::bit_cast<float>(bits), above = std::bit_cast<float>(bits + 1);
    std::array<char, 256> exact{};
    std::snprintf(exact.data(), exact.size(), "%s%.170e", random() % 2 ? "-" : "", (below + above) / 2);
    const std::string tie = exact.data();
    const size_t e = tie.find('e'), last = tie.find_last_not_of("0.", e - 1);
    words.push_back(tie);
    std::string more = tie, less = tie;
    more[e - 1] = '1';
    --less[last];  // the last digit that is not 0: nines take its place behind it
    for (size_t at = last + 1; at < e; ++at)
      if (less[at] == '0') less[at] = '9';
    words.push_back(more);
    words.push_back(less);
  }
  while (words.size() % 3 != 0) words.emplace_back("0.5");
  std::string text;
  std::vector<glm::vec3> expected;
  for (size_t i = 0; i < words.size(); i += 3) {
    text += "vn " + words[i] + " " + words[i + 1] + " " + words[i + 2] + "\n";
    const auto value = [&](size_t n) {
      const float v = std::strtof(words[n].c_str(), nullptr);
      return std::isfinite(v) ? v : 0.5f;
    };
    expected.emplace_back(value(i), value(i + 1), value(i + 2));
  }
  // What is rounded to infinity is an error.
  for (const std::string& word : words)
    if (!std::isfinite(std::strtof(word.c_str(), nullptr))) {
      EXPECT_NE(read("vn 0 0 " + word + "\n", {}).error.find("beyond what a mesh holds"), std::string::npos)
          << word;
      for (size_t at = 0; (at = text.find(" " + word, at)) != std::string::npos;)
        text.replace(at, word.size() + 1, " 0.5");
    }
  ObjPiece piece;
  read_obj_piece(text, "hard.obj", 0, {}, piece);
  ASSERT_EQ(piece.normals.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(std::bit_cast<uint32_t>(piece.normals[i][axis]), std::bit_cast<uint32_t>(expected[i][axis]))
          << words[3 * i + static_cast<size_t>(axis)];
}

TEST(ObjPieces, NumbersThatNoFloatHoldsAreZeroOrAnError) {
  const Read small = read("v 1e-400 -1e-46 0.00001e-99999999999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {});
  EXPECT_EQ(small.error, "");
  EXPECT_EQ(small.mesh.positions[0], glm::vec3(0));
  for (const char* large : {"1e400", "-1e39", "3.40282356779733662e38", "100000e99999999999", "inf", "nan"})
    EXPECT_NE(read(std::string("v 0 0 ") + large + "\n", {}).error.find("pieces.obj:1:7: "),
              std::string::npos)
        << large;
}

TEST(ObjPieces, LibrariesAreNamedBetweenSpacesAndTabs) {
  test::write_temporary("tab_a.mtl", "newmtl a\n");
  test::write_temporary("tab_b.mtl", "newmtl b\n");
  const Read both =
      read("mtllib tab_a.mtl\t \ttab_b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl b\nf 1 2 3\n", {});
  EXPECT_EQ(both.error, "");
  EXPECT_EQ(both.materials.size(), 3u);
}

}  // namespace
}  // namespace rayfarm
