// Documents that include others, what is described where it is used, and several errors at a time.
#include "common/description/formats/yaml_document.h"
#include "common/description/formats/yaml_scene.h"
#include "common/materials/illuminants.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using test::error_of;
using test::load_yaml;
using test::view_text;
using test::write_temporary;

size_t count_lines(const std::string& text) {
  return text.empty() ? 0 : 1 + static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(YamlDocuments, MaterialsAndTexturesMayBeDescribedWhereTheyAreUsed) {
  const SceneDescription in_place = load_yaml(view_text() + R"(
materials:
  dust: {mix: {a: {color: [1, 0, 0]}, b: {conductor: gold}, by: {kind: noise}}}
scene:
  - {material: {color: '#ff8000', texture: {kind: wood, scale: 2}}, sphere: {center: [0, 0, 0], radius: 1}}
  - {material: {principled: {base_color: {kind: checker}, roughness: {texture: {kind: noise}, factor: 0.5}}}, sphere: {center: [2, 0, 0], radius: 1}}
  - {material: dust, sphere: {center: [4, 0, 0], radius: 1}}
)");
  const SceneDescription by_name = load_yaml(view_text() + R"(
textures: {t: {kind: noise}, wood: {kind: wood, scale: 2}, checks: {kind: checker}}
materials:
  red: {color: [1, 0, 0]}
  gold: {conductor: gold}
  dust: {mix: {a: red, b: gold, by: t}}
  orange: {color: [1, 0.21586050011389926, 0], texture: wood}
  checked: {principled: {base_color: checks, roughness: {texture: t, factor: 0.5}}}
scene:
  - {material: orange, sphere: {center: [0, 0, 0], radius: 1}}
  - {material: checked, sphere: {center: [2, 0, 0], radius: 1}}
  - {material: dust, sphere: {center: [4, 0, 0], radius: 1}}
)");
  ASSERT_EQ(in_place.materials.size(), by_name.materials.size());
  const CompiledScene a = compile(in_place), b = compile(by_name);
  for (size_t sphere = 0; sphere < 3; ++sphere) {
    const Material &x = a.scene.materials[a.scene.spheres[sphere].material],
                   &y = b.scene.materials[b.scene.spheres[sphere].material];
    EXPECT_EQ(x.kind, y.kind) << sphere;
    EXPECT_LT(max_magnitude(x.color - y.color), 1e-12) << sphere;
    EXPECT_EQ(x.texture == kNone, y.texture == kNone) << sphere;
    if (x.texture != kNone) {
      EXPECT_EQ(a.scene.textures[x.texture].kind, b.scene.textures[y.texture].kind);
      EXPECT_EQ(a.scene.textures[x.texture].scale, b.scene.textures[y.texture].scale);
    }
  }
}

TEST(YamlDocuments, AnAliasOfWhatIsDescribedInPlaceIsTheSame) {
  const SceneDescription scene = load_yaml(view_text() + R"(
scene:
  - {material: &red {color: [1, 0, 0]}, sphere: {center: [0, 0, 0], radius: 1}}
  - {material: *red, sphere: {center: [2, 0, 0], radius: 1}}
)");
  EXPECT_EQ(scene.materials.size(), 2u) << "the default's, and one";
  const auto& primitives = scene.objects[scene.root].primitives;
  EXPECT_EQ(primitives[0].material, primitives[1].material);
}

TEST(YamlDocuments, ARotationByThreeAnglesTurnsAboutXThenYThenZ) {
  const CompiledScene compiled = compile(load_yaml(view_text() + R"(
scene:
  - {transform: {rotate: [90, 90, 0]}, sphere: {center: [0, 0, 0], radius: 1}}
  - {transform: {rotate: {0: [0, 0, 0], 10: [0, 0, 100]}}, sphere: {center: [0, 0, 0], radius: 1}}
)"));
  // (0, 1, 0) about x by 90° is (0, 0, 1), and that about y by 90° (1, 0, 0).
  const Vec3 p = compiled.scene.poses[0].world_from_object.vector(Vec3(0, 1, 0));
  EXPECT_NEAR(glm::length(p - Vec3(1, 0, 0)), 0, 1e-12);
  const SceneDescription moving = load_yaml(view_text() + R"(
scene: [{transform: {rotate: {0: [0, 0, 0], 10: [0, 0, 100]}}, sphere: {center: [0, 0, 0], radius: 1}}]
)");
  const std::vector<TransformStep>& steps = moving.objects[moving.root].children[0].transform;
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[2].axis, Vec3(0, 0, 1));
  EXPECT_EQ(steps[2].curve.values[1].x, 100);
  EXPECT_EQ(steps[0].curve.values[1].x, 0);
}

TEST(YamlDocuments, IncludedFilesComeFirstOnceAndTheirFilesLieBesideThem) {
  const auto folder = std::filesystem::path(write_temporary("included.txt", "")).parent_path() / "library";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "tri.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "materials.yaml") << "materials: {red: {color: [1, 0, 0]}}\nambient: 0.5\n"
                                              "render: {samples: 4, lighting: path}\n";
  std::ofstream(folder / "room.yaml")
      << "include: materials.yaml\nobjects: {tri: {mesh: {file: tri.obj}}}\n"
         "background: 0.25\nscene: [{material: red, sphere: {center: [0, 0, 0], radius: 1}}]\n";
  const SceneDescription scene = load_yaml(view_text() + R"(
include: [library/room.yaml, library/materials.yaml]
background: 0.75
render: {samples: 9}
scene: [{use: tri}, {material: red, sphere: {center: [2, 0, 0], radius: 1}}]
)");
  EXPECT_EQ(scene.files.size(), 4u) << "three documents and a mesh";
  EXPECT_EQ(scene.objects[scene.root].primitives.size(), 2u);
  EXPECT_EQ(scene.objects[scene.root].children.size(), 1u);
  EXPECT_EQ(scene.background, Color(0.75)) << "what includes has the last word";
  EXPECT_EQ(scene.ambient, Color(0.5));
  ASSERT_EQ(scene.render.size(), 2u);
  EXPECT_EQ(scene.render[0].name, "lighting");
  EXPECT_EQ(scene.render[1].value, "9");
}

TEST(YamlDocuments, WhatIsWrongInAnIncludedFileHasItsPlace) {
  write_temporary("wrong.yaml", "materials:\n  red: {colour: [1, 0, 0]}\n");
  EXPECT_NE(error_of("include: wrong.yaml\n" + view_text() + "scene: []\n")
                .find("wrong.yaml:2:9: unknown key 'colour'"),
            std::string::npos);
  EXPECT_NE(error_of("include: nowhere.yaml\n" + view_text() + "scene: []\n").find("scene.yaml:1:10: "),
            std::string::npos);
  write_temporary("twice.yaml", "materials: {red: {}}\n");
  EXPECT_NE(error_of("include: twice.yaml\n" + view_text() + "materials: {red: {}}\nscene: []\n")
                .find("scene.yaml:3:13: material 'red' is defined twice"),
            std::string::npos);
}

TEST(YamlDocuments, FilesThatIncludeEachOtherAreAnError) {
  const std::string rest = view_text() + "scene: []\n";
  write_temporary("other.yaml", "include: third.yaml\nmaterials: {red: {}}\n");
  write_temporary("third.yaml", "materials: {blue: {}}\ninclude: [scene.yaml]\n");
  EXPECT_NE(error_of("include: other.yaml\n" + rest)
                .find("third.yaml:2:11: scene.yaml includes other.yaml includes third.yaml includes "
                      "scene.yaml: files can't include each other in a circle"),
            std::string::npos)
      << error_of("include: other.yaml\n" + rest);
  EXPECT_NE(
      error_of("include: scene.yaml\n" + rest).find("scene.yaml:1:10: scene.yaml includes scene.yaml: "),
      std::string::npos);
  // Two that include the same are no circle.
  write_temporary("third.yaml", "materials: {blue: {}}\n");
  write_temporary("second.yaml", "include: third.yaml\n");
  EXPECT_EQ(load_yaml("include: [other.yaml, second.yaml]\n" + rest).files.size(), 4u);
}

TEST(YamlDocuments, WhatIsNoYamlIsNotIncluded) {
  const std::string rest = view_text() + "scene: []\n";
  EXPECT_NE(error_of("include: [x.gltf, y.rfp]\n" + rest)
                .find("scene.yaml:1:11: `include` takes scenes in YAML; a model is shown by "
                      "`scene: [{mesh: {file: x.gltf}}]`"),
            std::string::npos)
      << error_of("include: [x.gltf, y.rfp]\n" + rest);
  EXPECT_EQ(count_lines(error_of("include: [x.gltf, y.rfp]\n" + rest)), 2u);
}

TEST(YamlDocuments, AFileThatSeveralDocumentsNameIsReadOnce) {
  const std::string model = RAYFARM_SOURCE "/tests/golden/scenes/tube.gltf";
  write_temporary("first.yaml", "objects: {a: {mesh: {file: " + model + "}}}\n");
  write_temporary("second.yaml", "objects: {b: {mesh: {file: " + model + "}}}\n");
  const SceneDescription scene =
      load_yaml("include: [first.yaml, second.yaml]\n" + view_text() +
                "scene: [{use: a}, {use: b, transform: {translate: [5, 0, 0]}}]\n");
  EXPECT_EQ(std::count(scene.files.begin(), scene.files.end(), model), 1);
}

TEST(YamlDocuments, SeveralFilesThatAreMissingAreToldTogether) {
  const std::string error =
      error_of("include: [nowhere.yaml, nor_here.yaml]\n" + view_text() + "scene: []\n");
  EXPECT_EQ(count_lines(error), 2u) << error;
}

TEST(YamlDocuments, LongListsOfIncludedFilesAreReadApart) {
  std::string points, faces;
  for (int i = 0; i < 300; ++i) {
    points += fmt::format("{}[{}, {}, 0]", i ? ", " : "", i, i % 7);
    if (i > 1) faces += fmt::format("{}[{}, {}, {}]", i > 2 ? ", " : "", i - 2, i - 1, i);
  }
  write_temporary(
      "mesh.yaml",
      fmt::format("objects: {{m: {{triangles: {{points: [{}], triangles: [{}]}}}}}}\n", points, faces));
  const std::string text = "include: mesh.yaml\n" + view_text() + "scene: [{use: m}]\n";
  const std::string path = write_temporary("scene.yaml", text);
  const auto apart = read_yaml_outline(text, path, 256);
  ASSERT_TRUE(apart);
  const SceneDescription whole = read_yaml_whole(text, path);
  const auto mesh_of = [](const SceneDescription& scene) -> const MeshShape& {
    return std::get<MeshShape>(scene.objects[0].primitives[0].shape);
  };
  EXPECT_EQ(mesh_of(*apart).triangles.size(), 298u);
  EXPECT_TRUE(std::equal(mesh_of(whole).positions.begin(), mesh_of(whole).positions.end(),
                         mesh_of(*apart).positions.begin(), mesh_of(*apart).positions.end()));
}

TEST(YamlDocuments, SeveralErrorsAreToldTogetherEachOnceAndNoneThatFollowsFromAnother) {
  const std::string error = error_of(view_text() + R"(
lights: [{colour: 1, position: [0, 0, 1]}, {position: [0, 0, 1], intensity: -1}]
textures: {t: {kind: checkers}}
materials: {red: {color: [1, 0, 0], difuse: 1}, blue: {texture: t}}
scene:
  - {material: red, sphere: {center: [0, 0], radius: 1}}
  - {material: blue, group: [{sphere: {center: [0, 0, 0]}}, {cube: {}}]}
)");
  EXPECT_EQ(count_lines(error), 7u) << error;
  for (const char* place : {":3:11: ", ":3:77: ", ":4:22: ", ":5:37: ", ":7:38: ", ":8:39: ", ":8:62: "})
    EXPECT_NE(error.find(place), std::string::npos) << place << " in\n" << error;
}

TEST(YamlDocuments, ErrorsEndAtTwenty) {
  std::string text = view_text() + "scene:\n";
  for (int i = 0; i < 1000; ++i) text += fmt::format("  - {{sphere: {{center: {}}}}}\n", i);
  EXPECT_EQ(count_lines(error_of(text)), 21u);
}

TEST(YamlDocuments, IlluminantsHaveTheirNames) {
  const SceneDescription scene = load_yaml(view_text() + R"(
lights: [{position: [0, 0, 1], color: {spectrum: D65, scale: 3}}, {position: [0, 0, 1], color: {spectrum: A}}]
scene: []
)");
  EXPECT_NEAR(luminance(scene.lights[0].color), 3, 1e-9);
  EXPECT_NEAR(luminance(scene.lights[1].color), 1, 1e-9);
  EXPECT_GT(scene.lights[1].color.x, 1.5) << "a filament's light is warm";
  EXPECT_NE(error_of(view_text() + "ambient: {spectrum: D56}\nscene: []\n")
                .find("unknown illuminant 'D56' (known: A, D65, E)"),
            std::string::npos);
}

/// CIE 15:2004, Table T.3 (2° observer): A (0.44758, 0.40745), D65 (0.31272, 0.32903). White of our colours
/// is E; what differs from it is to lie where those differ from (1/3, 1/3).
TEST(YamlDocuments, IlluminantsHaveTheirChromaticities) {
  // Rec. 709's primaries about a white of E, as the colours of spectra are defined here.
  const double x[3] = {0.64, 0.30, 0.15}, y[3] = {0.33, 0.60, 0.06};
  Mat3 primaries;
  for (int c = 0; c < 3; ++c) primaries[c] = Vec3(x[c] / y[c], 1, (1 - x[c] - y[c]) / y[c]);
  const Vec3 amounts = glm::inverse(primaries) * Vec3(1);
  const auto chromaticity = [&](const char* name) {
    const auto nodes = find_illuminant(name);
    const Vec3 xyz = primaries * (amounts * rgb_of(*nodes));
    return Vec2(xyz.x, xyz.y) / (xyz.x + xyz.y + xyz.z);
  };
  EXPECT_NEAR(glm::length(chromaticity("E") - Vec2(1 / 3.0)), 0, 0.002);
  EXPECT_NEAR(glm::length(chromaticity("A") - Vec2(0.44758, 0.40745)), 0, 0.004);
  EXPECT_NEAR(glm::length(chromaticity("D65") - Vec2(0.31272, 0.32903)), 0, 0.004);
}

TEST(YamlAdvice, ColoursWithoutQuotesAreComments) {
  const std::string error = error_of(view_text() +
                                     "materials:\n  red: {color: #ff0000, diffuse: 0.5}\n  blue: {color: "
                                     "[0, 0, 1]}\nscene: []\n");
  EXPECT_NE(error.find("what follows a # is a comment: put '#ff0000' in quotes"), std::string::npos) << error;
  EXPECT_EQ(error_of(view_text() + "materials: {red: {color: '#f00'} # reds\nscene: [\n").find("comment"),
            std::string::npos);
  EXPECT_NE(advice_on_yaml("a: {b: #fff}\nc: 1\n", 1, "").find("in line 1, "), std::string::npos);
  for (const char* const other : {"a: [1] #fff\nb: {\n", "a: {b: '#fff'\n", "a: {b: x#fff\n", "a: { #ffff\n",
                                  "a: {  # fff\n", "a: { #fffg\n"})
    EXPECT_EQ(advice_on_yaml(other, 1, ""), "") << other;
}

TEST(YamlAdvice, TabsThatIndentAreNamed) {
  const std::string error = error_of("view:\n\tlocation: [0, 0, 5]\n\tlook_at: [0, 0, 0]\nscene: []\n");
  EXPECT_NE(error.find("is indented by a tab: YAML takes blanks alone"), std::string::npos) << error;
}

TEST(YamlAdvice, BackslashesInDoubleQuotesAreEscapes) {
  for (const char* const path : {R"("C:\models\b.obj")", R"("C:\users\b.obj")"}) {
    const std::string error = error_of(view_text() + "scene: [{mesh: {file: " + path + "}}]\n");
    EXPECT_NE(error.find("in double quotes a \\ begins an escape"), std::string::npos) << error;
  }
}

TEST(YamlAdvice, AMisspeltKeyOfTheViewIsNotAMissingOne) {
  const std::string error = error_of("view: {location: [0, 0, 5], lookat: [0, 0, 0]}\nscene: []\n");
  EXPECT_NE(error.find("unknown key 'lookat' in view"), std::string::npos) << error;
  EXPECT_NE(error.find("did you mean 'look_at'?"), std::string::npos) << error;
}

}  // namespace
}  // namespace rayfarm
