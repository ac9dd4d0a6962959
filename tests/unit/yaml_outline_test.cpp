// Long lists of numbers in YAML are read apart from the rest; the scene, the places of all in it and the
// errors are those of a text that is read as a whole.
#include "common/description/formats/yaml_outline.h"

#include "common/description/formats/yaml_reader.h"
#include "common/description/formats/yaml_scene.h"
#include "common/files/read_file.h"
#include "tests/scene_text.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

constexpr const char* kPath = "lists.yaml";

std::string read_whole(const std::string& text) {
  try {
    return test::text_of_scene(read_yaml_whole(text, kPath));
  } catch (const InputError& e) {
    return std::string("error: ") + e.what();
  }
}

/// True if lists of any length were read apart; then the scene is that of the whole text.
bool is_read_apart(const std::string& text) {
  const std::optional<SceneDescription> scene = read_yaml_outline(text, kPath, 0);
  if (!scene) return false;
  EXPECT_TRUE(test::text_of_scene(*scene) == read_whole(text)) << text;
  return true;
}

const std::string kView = test::view_text();
/// A mesh of `lists` for points, triangles and more.
std::string mesh(const std::string& lists) {
  return kView + "scene:\n  - triangles:\n" + lists;
}
const std::string kPoints = "      points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\n";
const std::string kTriangles = "      triangles: [[0, 1, 2], [0, 2, 3]]\n";

TEST(YamlOutline, IsOfScenesAsPeopleAndProgramsWriteThem) {
  for (const std::string& text : {
           mesh(kPoints + kTriangles),
           mesh(kPoints + kTriangles + "      normals: [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]]\n"),
           // Over lines, with commas at their ends, spaces, signs and exponents.
           mesh(
               "      points:\n        [\n  [0, 0, 0],\n[ +1.5e0 , -.0,0. ],\n\n    [0,1,-2E-3], ] # four\n" +
               std::string("      triangles: [[0,\n1,\n2,]]\n")),
           mesh(
               "      points: [[0, 0, 0],\r\n [1, 0, 0],\r\n [0, 1, 0]]\r\n      triangles: [[0, 1, 2]]\r\n"),
           // In flow maps, with and without quotes, several on a line.
           kView +
               "scene: [{triangles: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles: [[0, 1, 2]]}}, "
               "{sphere: {center: [0, 0, 0], radius: 1}, name: ball}]\n",
           kView +
               "scene: [{\"polygons\": {\"points\": [[0, 0, 0], [1, 0, 0],\n [0, 1, 0]], 'faces': [[0, 1, "
               "2]], \"smooth\": \"flat\"}}, {name: 'a # b', sphere: {center: [0, 0, 0], radius: 1}}]\n",
           kView + "scene:\n- {polygons: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 2, 0]],\n"
                   "   faces: [[0, 1, 2], [0, 1, 2, 3], [2, 1, 4]], smooth: phong}, name: all}\n",
           kView + "scene:\n- polygon: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], normals: [[0, 0, 1], [0, "
                   "0, 2], [0, 1, 1]]}\n  name: it\n",
           // Comments may hold anything.
           "# it's \"a\" | comment > with points: [1, 2] & é\n" +
               mesh("# ' \n" + kPoints + "   # \" *\n" + kTriangles),
           kView +
               "textures: {t: {kind: array, size: [2, 1, 2], values: [0, .5, 1, 0.25,]}}\nscene: [{sphere: "
               "{center: [0, 0, 0], radius: 1}}]\n",
           // One list has a comment or a text in it and is read with the rest.
           mesh(
               "      points: [[0, 0, 0], # one\n [1, 0, 0], [0, \"1\", 0]]\n      triangles: [[0, 1, 2]]\n"),
           "--- # one document\n" + mesh(kPoints + kTriangles) + "...\n",
       })
    EXPECT_TRUE(is_read_apart(text)) << text;
}

/// Whatever stands there, the whole text is read, and tells what it always told.
TEST(YamlOutline, LeavesWhatIsOddToTheWholeText) {
  const std::string faces = "      triangles: [[0, 0, 0]]\n";
  for (const std::string points : {"[[0, 0, 0], [1, 0, 0], [0, 1]]",
                                   "[[0, 0, 0], [1, 0, 0], [0, 1, 0, 0]]",
                                   "[]",
                                   "[ ]",
                                   "[,]",
                                   "[[]]",
                                   "[[0, 0, 0], , [1, 0, 0]]",
                                   "[[0, 0, 0] [1, 0, 0]]",
                                   "[[0, 0, 0], [1 0, 0, 0]]",
                                   "[[0, 0, +-1]]",
                                   "[[0, 0, 1e400]]",
                                   "[[0, 0, 1e-400]]",
                                   "[[0, 0, 1e16]]",
                                   "[[0, 0, 1.2.3]]",
                                   "[[0, 0, -]]",
                                   "[[0, 0, 1-1]]",
                                   "[0, 0, 0]",
                                   "[[[0, 0, 0]]]",
                                   "[[0, 0, 0], 1]",
                                   "[1, [0, 0, 0]]",
                                   "[[0, 0, .nan]]",
                                   "[[0, 0, ~]]",
                                   "[[0, 0, 0x1]]",
                                   "[[0, 0, 1_0]]",
                                   "[[0, 0, 0]",
                                   "[[0, 0, 0]]]",
                                   "[[0, 0, 0]] 1",
                                   "[[0, 0, 0]]: 1",
                                   "[[0, 0, 0]]\n      : 1",
                                   "[[0,\t0, 0]]",
                                   "&a [[0, 0, 0]]",
                                   "!!seq [[0, 0, 0]]",
                                   "| [[0, 0, 0]]",
                                   "[[0, 0, 0],\n--- ,\n[1, 0, 0]]",
                                   "[[0, 0, 0]\r, [1, 0, 0]]",
                                   "[[0, 0, 0],\n...\n[1, 0, 0]]",
                                   "[- 1]",
                                   "[[0, 0, 0]], points: [[0, 0, 0]]",
                                   "[[0, 0, 0]]\n      points: [[0]]",
                                   "[[0, 0, 0]]\n      values: [1, 2, 3]",
                                   "[[0, 0, 0]]\n      smooth: [1, 2]"})
    EXPECT_FALSE(is_read_apart(mesh("      points: " + points + "\n" + faces))) << points;
  for (const std::string triangles : {"[[0, 1, 4]]", "[[0, 1, -1]]", "[[0, 1, 1.5]]", "[[0, 1]]",
                                      "[[0, 1, 2, 3]]", "[0, 1, 2]", "[[0, 1, 1e15]]"})
    EXPECT_FALSE(is_read_apart(mesh(kPoints + "      triangles: " + triangles + "\n"))) << triangles;
  for (const std::string& text : {
           mesh(kPoints + kTriangles + "      normals: [[0, 0, 1], [0, 0, 0], [0, 0, 1], [0, 0, 1]]\n"),
           mesh(kPoints + kTriangles + "      normals: [[0, 0, 1]]\n"),
           // What seems to be a list stands within a scalar.
           mesh(kPoints + kTriangles) + "    name: |\n      points: [1, 2, 3]\n",
           mesh(kPoints + kTriangles) + "    name: >-\n      points: [1, 2, 3]\n",
           mesh(kPoints + kTriangles) + "    name: \"a\n      points: [1, 2, 3]\"\n",
           mesh(kPoints + kTriangles) + "    name: it's points: [1, 2, 3]\n",
           mesh(kPoints + kTriangles) + "    name: a, \"b: \" points: [1, 2, 3]\n",
           mesh(kPoints + kTriangles) + "    name: \"a \\\" points: [1, 2, 3]\"\n",
           "materials:\n  a, \"b: \" points: [1, 2, 3],\n  \" # \"\n" + mesh(kPoints + kTriangles),
           // Nobody reads it.
           mesh(kPoints + kTriangles) + "...\npoints: [1 2]\n",
           mesh(kPoints + kTriangles) + "points: [1, 2]\n",
           "objects: {points: [[1, 2], [3]]}\n" + mesh(kPoints + kTriangles),
           "materials: {values: [1, 2]}\n" + mesh(kPoints + kTriangles),
           "textures: {t: {kind: array, size: [2, 1, 1], values: [[0], [1]]}}\n" + mesh(kPoints + kTriangles),
           "textures: {t: {kind: array, size: [2, 1, 1], values: [0, 2]}}\n" + mesh(kPoints + kTriangles),
           "textures: {t: {kind: array, size: [2, 1, 1], values: [0, 1, 0]}}\n" + mesh(kPoints + kTriangles),
           "\xef\xbb\xbf" + mesh(kPoints + kTriangles),
           mesh(kPoints + kTriangles) + "    name: \xc3\xa9\n",
       })
    EXPECT_FALSE(is_read_apart(text)) << text;
}

TEST(YamlOutline, IsTheSameSceneForAllScenesOfTheRepository) {
  int apart = 0;
  for (const char* folder : {"/scenes", "/tests/golden/scenes"})
    for (const auto& entry : std::filesystem::directory_iterator(std::string(RAYFARM_SOURCE) + folder)) {
      if (entry.path().extension() != ".yaml") continue;
      const std::string path = entry.path(), text = read_file(path, limits::kYamlFileBytes);
      const std::optional<SceneDescription> scene = read_yaml_outline(text, path, 0);
      if (!scene) continue;
      ++apart;
      EXPECT_TRUE(test::text_of_scene(*scene) == test::text_of_scene(read_yaml_whole(text, path))) << path;
    }
  EXPECT_GE(apart, 3);
}

TEST(YamlOutline, IsTheSameSceneOrNoneForTextsChangedAtRandom) {
  const std::string seed =
      kView + "# a comment\nscene:\n  - triangles:\n" + kPoints + kTriangles + "    name: it\n" +
      "  - {polygons: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], \"faces\": [[0, 1, 2]]}, name: 'b'}\n";
  const std::vector<std::string> words{"[",  "]",  "{",    "}",      ",",    ": ",  ":",  "#",
                                       " #", "\n", "\r\n", " ",      "\"",   "'",   "-",  "+",
                                       ".",  "1",  "e",    "\t",     "|",    "&a ", "*a", "points: [",
                                       "]]", "? ", "\n- ", "[1, 2]", "\n  ", "---", "..."};
  std::mt19937 random(1);
  int apart = 0;
  for (int i = 0; i < 10'000; ++i) {
    std::string text = seed;
    for (auto changes = 1 + random() % 3; changes > 0; --changes) {
      const size_t at = random() % text.size();
      const std::string& word = words[random() % words.size()];
      text.replace(at, random() % 3, word);
    }
    apart += is_read_apart(text);
    if (HasFailure()) return;
  }
  EXPECT_GT(apart, 250);  // most changes are errors
}

/// An error at the end of a long list, and one behind it, are told at their places.
TEST(YamlOutline, KeepsLinesAndColumnsOfErrors) {
  std::string points = "[[0, 0, 0], [1, 0, 0], [0, 1, 0]";
  for (int i = 0; i < 1000; ++i) points += fmt::format(",\n [{}, 1, 0.5]", i);
  const auto error_of_list = [&](const std::string& end) {
    return test::error_of(kView + "scene:\n- triangles: {points: " + points + end, "long.yaml");
  };
  const auto expect_place = [](const std::string& error, const std::string& place) {
    EXPECT_NE(error.find("long.yaml:" + place + ":"), std::string::npos) << error;
  };
  expect_place(error_of_list(",\n  [1, 2]], triangles: [[0, 1, 2]]}\n"), "1004:3");
  expect_place(error_of_list(",\n  [1, 2, x]], triangles: [[0, 1, 2]]}\n"), "1004:10");
  expect_place(error_of_list("], triangles: [[0, 1, 2000]]}\n"), "1003:37");
  expect_place(error_of_list("], triangles: [[0, 1, 2]]}\n  colour: red\n"), "1004:3");
  // What is wrong with the scene as a whole is found after it was read apart.
  const std::string flat = kView + "scene:\n- triangles: {points: " + points +
                           "], triangles: [[0, 1, 2]]}\n" + "- sphere: {center: [0, 0, 0], radius: -1}\n";
  ASSERT_TRUE(is_read_apart(flat));
  expect_place(test::error_of(flat, "long.yaml"), "1004:11");
}

/// Values that are read apart count as others do.
TEST(YamlOutline, CountsAllValuesOfTheDocument) {
  const std::string text = "points: [[1, 2, 3], [4, 5]]\n";
  const std::string path = kPath;
  const auto is_within = [&](size_t nodes, YamlOutline* outline) {
    YamlBudget budget;
    budget.nodes_left = nodes;
    budget.outline = outline;
    try {
      YamlMap map(YamlValue(YAML::Load(outline ? outline->text() : text), "it", path, budget));
      const YamlValue points = map.require("points");
      if (const auto list = points.items_apart()) {
        points.take_all(*list, [](size_t, size_t, std::span<const double>) {});
      } else {
        for (const YamlValue& item : points.items()) item.numbers();
      }
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  std::optional<YamlOutline> outline = outline_of(text, 0);
  ASSERT_TRUE(outline);
  EXPECT_EQ(outline->text(), "points: []\n");
  for (size_t nodes = 0; nodes < 20; ++nodes)
    EXPECT_EQ(is_within(nodes, nullptr), is_within(nodes, &*outline)) << nodes;
  EXPECT_FALSE(is_within(9, &*outline));  // map, key, list, 2 items, 5 numbers
  EXPECT_TRUE(is_within(10, &*outline));
}

/// Long lists that can't be read apart are named, once, with their place; short ones are not worth a word.
TEST(YamlOutline, SlowListsAreSaid) {
  const auto notes_of = [](size_t points, const std::string& comment) {
    std::string text = test::view_text() + "# a scene\nscene:\n  - triangles:\n      points: [" + comment;
    for (size_t i = 0; i < points; ++i) text += fmt::format("[{}, {}, 0], ", i, i % 2);
    text += "[0, 0, 1]]\n      triangles: [[0, 1, 2]]\n";
    return test::load_yaml(text).notes.lines();
  };
  EXPECT_TRUE(notes_of(20'000, "").empty());
  EXPECT_TRUE(notes_of(2'000, "# mine\n").empty());
  const std::vector<std::string> lines = notes_of(20'000, "# mine\n");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find(":5:15: this list of 20001 items is read one by one"), lines[0].npos) << lines[0];
}

/// Cut into pieces, one a core, a list is what it is in one.
TEST(YamlOutline, ReadsLongListsInPieces) {
  std::string text;
  std::vector<double> numbers;
  while (text.size() < (3u << 20)) {
    numbers.push_back(static_cast<double>(numbers.size()) / 8);
    text += fmt::format("{}[{}, {}{}]", numbers.size() % 7 == 0 ? "\n " : " ", numbers.back(),
                        -numbers.back(), numbers.size() % 3 == 0 ? ", 7" : "");
    text += ",";
  }
  const NumberList list(text, {});
  EXPECT_GT(list.piece_count(), 2u);
  ASSERT_EQ(list.size(), numbers.size());
  std::vector<std::vector<double>> items(list.size());
  list.for_each([&](size_t, size_t i, std::span<const double> v) { items[i].assign(v.begin(), v.end()); });
  for (size_t i = 0; i < items.size(); ++i) {
    ASSERT_EQ(items[i].size(), i % 3 == 2 ? 3u : 2u);
    ASSERT_EQ(items[i][1], -numbers[i]);
  }
  text.back() = ' ';
  std::replace(text.begin(), text.end(), '[', ' ');
  std::replace(text.begin(), text.end(), ']', ' ');
  const NumberList flat(text, {});
  EXPECT_FALSE(flat.is_nested());
  size_t expected = 0;
  for (const auto& item : items) expected += item.size();
  EXPECT_EQ(flat.size(), expected);
  std::atomic<double> sum = 0;
  EXPECT_EQ(flat.for_each([&](size_t, size_t, std::span<const double> v) { sum += v[0]; }), expected);
  EXPECT_EQ(sum, 7 * static_cast<double>(numbers.size() / 3));
}

}  // namespace
}  // namespace rayfarm
