// Right scenes load as meant; wrong ones end in an error with a place, a problem and what to do.
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using test::error_of;
using test::load_yaml;
using test::view_text;

void expect_error(const std::string& text, const std::string& place, const std::string& problem) {
  const std::string error = error_of(text);
  EXPECT_NE(error.find(place), std::string::npos) << "no place " << place << " in: " << error;
  EXPECT_NE(error.find(problem), std::string::npos) << "no '" << problem << "' in: " << error;
}

TEST(YamlLoader, EveryKindOfShape) {
  const SceneDescription scene = load_yaml(view_text() + R"(
materials: {m: {color: [1, 0, 0], diffuse: 0.5, reflect: 0.5}}
objects: {pair: [{sphere: {center: [0, 0, 0], radius: 1}}, {sphere: {center: [2, 0, 0], radius: 1}}]}
scene:
  - {material: m, polygon: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]}}
  - {box: {min: [0, 0, 0], max: [1, 1, 1]}}
  - {cylinder: {base: [0, 0, 0], top: [0, 1, 0], radius: 1}}
  - {cone: {base: [0, 0, 0], apex: [0, 1, 0], base_radius: 1}}
  - {quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -1], planes: [[0, 1, 0, 0]]}}
  - {triangles: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles: [[0, 1, 2]]}}
  - {use: pair, transform: [{scale: 2}, {rotate: {axis: [0, 1, 0], degrees: 90}}, {translate: [1, 2, 3]}]}
  - {use: pair}
)");
  const CompiledScene compiled = compile(scene);
  EXPECT_EQ(compiled.scene.polygons.size(), 7u);
  EXPECT_EQ(compiled.scene.quadrics.size(), 3u);
  EXPECT_EQ(compiled.scene.spheres.size(), 2u) << "a shared object is stored once";
  EXPECT_EQ(compiled.scene.instances.size(), 3u);
  EXPECT_EQ(compiled.scene.materials[1].reflect, 0.5);
  // The steps are applied in their order: (1, 0, 0) → (2, 0, 0) → (0, 0, -2) → (1, 2, 1).
  const Vec3 p = compiled.scene.poses[1].world_from_object.point(Vec3(1, 0, 0));
  EXPECT_NEAR(glm::length(p - Vec3(1, 2, 1)), 0, 1e-12);
}

TEST(YamlLoader, ErrorsSayWhereWhatAndWhatToDo) {
  expect_error("view: [\n", "scene.yaml:", "not valid YAML");
  expect_error(view_text(), "scene.yaml:1:1", "needs the key 'scene'");
  expect_error(view_text() + "scene: []\nligths: []\n", "scene.yaml:3:1", "did you mean 'lights'?");
  expect_error(
      view_text() +
          "materials: {glas: {}}\nscene:\n  - {material: glass, sphere: {center: [0, 0, 0], radius: 1}}\n",
      "scene.yaml:4:16", "did you mean 'glas'?");
  expect_error(view_text() + "scene: [{sphere: {center: [0, 0], radius: 1}}]\n", "scene.yaml:2:27",
               "three numbers");
  expect_error(view_text() + "scene: [{sphere: {center: [0, 0, x], radius: 1}}]\n", "scene.yaml:2:34",
               "must be a number, not 'x'");
  expect_error(view_text() + "scene: [{sphere: {center: [0, 0, .inf], radius: 1}}]\n", "scene.yaml:2:34",
               "number");
  expect_error(view_text() + "scene: [{sphere: {center: [0, 0, 1e300], radius: 1}}]\n", "scene.yaml:2:34",
               "larger than");
  expect_error(view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: -1}}]\n", "scene.yaml:2",
               "above 0");
  expect_error(view_text() + "scene: [{sphere: {center: [0, 0, 0]}}]\n", "scene.yaml:2:18",
               "needs the key 'radius'");
  expect_error(view_text() + "scene: [{use: nothing}]\n", "scene.yaml:2:15", "unknown object 'nothing'");
  expect_error(view_text() + "scene: [{}]\n", "scene.yaml:2:9", "needs one of");
  expect_error(view_text() + "scene: [{polygon: {points: [[0, 0, 0], [1, 0, 0]]}}]\n", "scene.yaml:2",
               "at least 3");
  expect_error(view_text() + "scene: [{polygon: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0.4], [0, 1, 0]]}}]\n",
               "scene.yaml:2", "not planar");
  expect_error(view_text() + "scene: [{quadric: {coefficients: [1, 1, 0, 0, 0, 0, 0, 0, 0, -1]}}]\n",
               "scene.yaml:2", "infinity");
  expect_error(view_text() + "scene: [{mesh: {file: none.obj}}]\n", "scene.yaml:2:23", "no such file");
  expect_error(view_text() + "scene: [{group: [], transform: {scale: 0}}]\n", "scene.yaml:2",
               "must not be 0");
  expect_error(view_text() + "scene: [{group: [], transform: {translate: {a: [0, 0, 0]}}}]\n", "scene.yaml:2",
               "frame");
  expect_error("view: {location: [0, 0, 0], look_at: [0, 0, 1], direction: [0, 0, 1]}\nscene: []\n",
               "scene.yaml:1", "not both");
  expect_error(view_text() + "scene: []\nscene: []\n", "scene.yaml:3:1", "twice");
}

TEST(YamlLoader, HabitsOfOtherProgramsGetTheWayToWriteIt) {
  expect_error(view_text() + "background: #ff8000\nscene: []\n", "scene.yaml:2:1", "is a comment");
  expect_error(view_text() + "background: red\nscene: []\n", "scene.yaml:2:13", "[red, green, blue]");
  expect_error(view_text() + "background: 1x\nscene: []\n", "scene.yaml:2:13", "must be a number, not '1x'");
  expect_error(view_text() + "scene: [{group: [], transform: {rotate: 90}}]\n", "scene.yaml:2:41",
               "`{axis: [0, 1, 0], degrees: 90}`");
  expect_error("camera: {location: [0, 0, 5]}\nscene: []\n", "scene.yaml:1:1", "`view: {location:");
  expect_error(view_text() + "scene: [{mesh: {file: fox.fbx}}]\n", "scene.yaml:2:23",
               "a mesh is read from .obj, .off, .ply, .stl, .glb or .gltf; export it as one");
}

TEST(Loading, AdviceForOtherFormatsWorks) {
  const auto advice = [](const std::string& name) {
    try {
      load_scene(name);
    } catch (const IoError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(
      advice("a/fox.FBX").find("unknown scene format '.fbx'; Rayfarm reads .yaml and .nff, meshes (.obj, "),
      std::string::npos)
      << advice("a/fox.FBX");
  EXPECT_NE(advice("a/fox.FBX").find("; export it as .glb"), std::string::npos);
  EXPECT_EQ(advice("picture.png").find("export"), std::string::npos);
}

/// ASCII in a wider encoding of `bytes` each.
std::string widened(const std::string& text, size_t bytes, bool is_big_endian, const std::string& mark) {
  std::string wide = mark;
  for (const char c : text) {
    std::string one(bytes, '\0');
    one[is_big_endian ? bytes - 1 : 0] = c;
    wide += one;
  }
  return wide;
}

TEST(Loading, EncodingsAreRecognised) {
  using namespace std::string_literals;
  const std::string nff = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 9 9\n";
  EXPECT_EQ(error_of("\xef\xbb\xbf" + nff, "marked.nff"), "");
  for (const std::string& mark : {""s, "\xff\xfe"s})
    EXPECT_NE(error_of(widened(nff, 2, false, mark), "wide.nff").find("UTF-16"), std::string::npos);
  for (const std::string& mark : {""s, "\xfe\xff"s})
    EXPECT_NE(error_of(widened(nff, 2, true, mark), "wide.nff").find("UTF-16"), std::string::npos);
  for (const std::string& mark : {""s, "\xff\xfe\0\0"s})
    EXPECT_NE(error_of(widened(nff, 4, false, mark), "wide.nff").find("UTF-32"), std::string::npos);
  for (const std::string& mark : {""s, "\0\0\xfe\xff"s})
    EXPECT_NE(error_of(widened(nff, 4, true, mark), "wide.nff").find("UTF-32"), std::string::npos);
  test::write_temporary("wide.obj", widened("v 0 0 0\n", 2, false, "\xff\xfe"));
  expect_error(view_text() + "scene: [{mesh: {file: wide.obj}}]\n", "wide.obj", "UTF-16");
  // YAML may be in any of them.
  const std::string yaml = view_text() + "scene: []\n";
  EXPECT_EQ(error_of("\xef\xbb\xbf" + yaml), "");
  EXPECT_EQ(error_of(widened(yaml, 2, false, "\xff\xfe")), "");
}

TEST(NffLoader, WhatIsNotUsedIsNoted) {
  const std::string view = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 9 9\n";
  const SceneDescription scene = load_scene(test::write_temporary(
      "notes.nff", view + "b 0 0 0\nb 1 1 1\ns 0 0 0 1\ns 0 0 0 -1\ns 0 0 0 -2\n" + view));
  ASSERT_EQ(scene.notes.lines().size(), 3u);
  EXPECT_NE(scene.notes.lines()[0].find("notes.nff:9:1: this background"), std::string::npos);
  EXPECT_NE(scene.notes.lines()[1].find("notes.nff:11:1: the sign of a negative radius"), std::string::npos);
  EXPECT_NE(scene.notes.lines()[2].find("notes.nff:13:1: this view"), std::string::npos);
}

TEST(YamlLoader, HostileInputEndsInAnError) {
  expect_error(view_text() + "objects: {a: [{use: b}], b: [{use: a}]}\nscene: [{use: a}]\n", "scene.yaml:2",
               "contains itself: a → b → a");
  std::string explosion = view_text() + "objects:\n  o0: [{sphere: {center: [0, 0, 0], radius: 1}}]\n";
  for (int i = 1; i < 30; ++i)
    explosion += "  o" + std::to_string(i) + ": [{use: o" + std::to_string(i - 1) + "}, {use: o" +
                 std::to_string(i - 1) + "}]\n";
  expect_error(explosion + "scene: [{use: o29}]\n", "scene.yaml", "expands to more than");
  std::string deep = view_text() + "scene: ";
  for (int i = 0; i < 300; ++i) deep += "[{group: ";
  EXPECT_NE(error_of(deep), "");
  std::string nested = view_text() + "objects:\n  o0: [{sphere: {center: [0, 0, 0], radius: 1}}]\n";
  for (int i = 1; i < 1200; ++i)
    nested += "  o" + std::to_string(i) + ": [{use: o" + std::to_string(i - 1) + "}]\n";
  expect_error(nested + "scene: [{use: o1199}]\n", "scene.yaml", "nested more than");
  std::string brackets(100000, '[');
  EXPECT_NE(error_of("scene: " + brackets), "");
  // Anchors that multiply: 10^9 values in a few lines.
  std::string laughs = view_text() + "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    laughs += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int j = 0; j < 9; ++j) laughs += ", " + before;
    laughs += "]\n";
  }
  EXPECT_NE(error_of(laughs + "scene: *a8\n"), "");
}

TEST(YamlLoader, DamagedScenesNeverCrash) {
  // Every prefix and many single-byte changes of a scene that uses everything.
  std::ifstream in(std::string(RAYFARM_SOURCE) + "/scenes/animation.yaml");
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  ASSERT_GT(text.size(), 1000u);
  std::mt19937 random(5);
  int errors = 0;
  for (int i = 0; i < 400; ++i) {
    std::string damaged = text;
    if (i % 4 == 0)
      damaged.resize(random() % text.size());
    else
      damaged[random() % text.size()] = static_cast<char>(random() % 256);
    try {
      compile(load_yaml(damaged));
    } catch (const InputError&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 100);
}

TEST(NffLoader, EveryRecord) {
  const std::string path = test::write_temporary("all.nff", R"(# a comment
b 0.1 0.2 0.3
v
from 0 0 5
at 0 0 0
up 0 1 0
angle 45
hither 1
resolution 64 32
l 1 2 3
l 4 5 6 0.5 0.25 0.125
f 1 0.5 0.25 0.8 0.3 10 0.1 1.5  # trailing comment
s 0 0 0 1
c
0 0 0 0.5
0 1 0 0.25
p 4
0 0 0
1 0 0
1 1 0
0 1 0
pp 3
0 0 0 0 0 1
1 0 0 0 0.1 1
0 1 0 0 0 1
)");
  const SceneDescription scene = load_scene(path);
  EXPECT_EQ(scene.background, Color(0.1, 0.2, 0.3));
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_DOUBLE_EQ(scene.lights[0].color.x, std::sqrt(2.0) / 4);
  EXPECT_EQ(scene.lights[1].color, Color(0.5, 0.25, 0.125));
  EXPECT_EQ((*scene.view.resolution_px)[1], 32);
  EXPECT_EQ(scene.materials[0].transmit, 0.1);
  const CompiledScene compiled = compile(scene);
  EXPECT_EQ(compiled.scene.spheres.size(), 1u);
  EXPECT_EQ(compiled.scene.quadrics.size(), 1u);
  EXPECT_EQ(compiled.scene.polygons.size(), 1u);
  EXPECT_EQ(compiled.scene.triangle_shading.size(), 1u);
  EXPECT_NE(compiled.scene.triangle_shading[0].normals[0], kNone);
}

TEST(NffLoader, ErrorsHaveAPlace) {
  EXPECT_NE(error_of("s 0 0 0 1\n", "a.nff").find("no view"), std::string::npos);
  EXPECT_NE(error_of("b 1 2\n", "a.nff").find("ends where"), std::string::npos);
  EXPECT_NE(error_of("# x\n  q 1\n", "a.nff").find("a.nff:2:3: unknown record 'q'"), std::string::npos);
  EXPECT_NE(error_of("b 1 2 three\n", "a.nff").find("a.nff:1:7: expected a number"), std::string::npos);
  EXPECT_NE(error_of("p 999999999\n", "a.nff").find("a.nff:1:3: number of vertices must be"),
            std::string::npos);
  EXPECT_NE(error_of("s 0 0 nan 1\n", "a.nff").find("a.nff:1:7: "), std::string::npos);
}

TEST(ObjLoader, QuadsNormalsMaterialsAndFaults) {
  test::write_temporary("m.mtl", "newmtl red\nKd 1 0 0\nnewmtl mirror\nKd 0 0 0\nKs 0.5 0.5 0.5\nillum 3\n");
  const std::string yaml = test::view_text() + "scene: [{mesh: {file: q.obj, smooth: phong}}]\n";
  test::write_temporary(
      "q.obj",
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3 4\nusemtl mirror\nf -3 -2 -1\n");
  const SceneDescription scene = test::load_yaml(yaml);
  EXPECT_EQ(scene.files.size(), 3u);
  const CompiledScene compiled = compile(scene);
  ASSERT_EQ(compiled.scene.triangle_shading.size(), 1u);
  ASSERT_EQ(compiled.scene.mesh_faces.size(), 1u);
  EXPECT_EQ(compiled.scene.materials[compiled.scene.mesh_faces[0].material].color, Color(1, 0, 0));
  EXPECT_EQ(compiled.scene.materials[compiled.scene.triangle_shading[0].material].reflect, 0.5);
  EXPECT_NE(compiled.scene.triangle_shading[0].normals[0], kNone) << "averaged normals";
  EXPECT_NE(compiled.scene.mesh_faces[0].first_normal, kNone) << "averaged normals";
  test::write_temporary("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n");
  EXPECT_NE(error_of(yaml).find("q.obj:4"), std::string::npos) << error_of(yaml);
  test::write_temporary("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\n");
  EXPECT_NE(error_of(yaml).find("no faces"), std::string::npos);
  test::write_temporary("q.obj", "v 0 0 0\nv 1 0 nan\nv 1 1 0\nf 1 2 3\n");
  EXPECT_NE(error_of(yaml), "");
}

TEST(YamlLoader, SecondaryLightThatMakesNoSenseIsRefused) {
  const auto error = [](const std::string& material) {
    return test::error_of(test::view_text() + "materials:\n  m: {" + material + "}\nscene: []\n");
  };
  EXPECT_NE(error("interior: 0.5").find("scene.yaml:3:17: `interior` weighs what `transmit`"),
            std::string::npos)
      << error("interior: 0.5");
  EXPECT_NE(error("exponent: 5").find("scene.yaml:3:17: `exponent` spreads"), std::string::npos);
  EXPECT_NE(error("diffuse: 0, transmit: 1, interior: 1.5").find("1.5 times the light"), std::string::npos);
  EXPECT_NE(error("diffuse: 0, transmit: 1, interior: [0.5, -1, 0]").find("interior"), std::string::npos);
  EXPECT_NE(error("reflections: specular-only").find("specular"), std::string::npos);
  EXPECT_EQ(error("diffuse: 0.5, transmit: 1, interior: 0.5"), "");  // 0.5 + 1 × 0.5
  const SceneDescription scene =
      test::load_yaml(test::view_text() +
                      "materials: {a: {diffuse: 0, reflect: 1, exponent: 50}, b: {diffuse: 0, reflect: 1, "
                      "exponent: 50, shininess: 7}}\nscene: []\n");
  const auto shininess = [&](const char* name) {
    return std::find_if(scene.materials.begin(), scene.materials.end(),
                        [&](const auto& m) { return m.name == name; })
        ->shininess;
  };
  EXPECT_EQ(shininess("a"), 50);  // highlights fit the lobe
  EXPECT_EQ(shininess("b"), 7);
}

}  // namespace
}  // namespace rayfarm
