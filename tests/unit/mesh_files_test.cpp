// OBJ and MTL files: what they say is used, or noted.
#include <atomic>
#include <chrono>
#include <thread>

#include "common/scene/light.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using test::write_temporary;

const std::string kYaml = test::view_text() + "scene: [{mesh: {file: mesh.obj}}]\n";

/// Loads mesh.obj with its library mesh.mtl.
SceneDescription load_mesh(const std::string& obj, const std::string& mtl = "") {
  write_temporary("mesh.mtl", mtl);
  write_temporary("mesh.obj", obj);
  return test::load_yaml(kYaml);
}
std::string error_of_mesh(const std::string& obj, const std::string& mtl = "") {
  write_temporary("mesh.mtl", mtl);
  write_temporary("mesh.obj", obj);
  return test::error_of(kYaml);
}
std::string notes_of(const SceneDescription& scene) {
  std::string text;
  for (const std::string& line : scene.notes.lines()) text += line + "\n";
  return text;
}
void expect_note(const SceneDescription& scene, const std::string& place, const std::string& text) {
  for (const std::string& line : scene.notes.lines())
    if (line.find(place) != std::string::npos && line.find(text) != std::string::npos) return;
  ADD_FAILURE() << "no note '" << text << "' at " << place << " in:\n" << notes_of(scene);
}
const MeshShape& mesh_of(const SceneDescription& scene) {
  return std::get<MeshShape>(scene.objects.at(scene.root).primitives.at(0).shape);
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
const std::string kFace = "f 1/1 2/2 3/3\n";

/// An image of two pixels, red and green.
void write_two_colours(const std::string& name) {
  Image image{2, 1, {0, 0, 2, 1}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (const int value : {255, 0, 0, 0, 255, 0}) image.pixels.push_back(static_cast<std::byte>(value));
  write_image(write_temporary(name, ""), image, {});
}

TEST(MtlLoader, MapsOfColourAreUsed) {
  write_two_colours("two colours.png");
  const SceneDescription scene =
      load_mesh("mtllib mesh.mtl\nusemtl plain\n" + kTriangle + kFace + "usemtl moved\n" + kFace +
                    "usemtl same\n" + kFace,
                "newmtl plain\nKd 0.5 0.5 0.5\nmap_Kd .\\two colours.png\n"
                "newmtl moved\nmap_Kd -o 0.5 -s 2 -1 1 -clamp off two colours.png\n"
                "newmtl same\nKd 1 0 0\nmap_Kd two colours.png\n");
  EXPECT_EQ(notes_of(scene), "");
  EXPECT_EQ(scene.files.size(), 5u);
  ASSERT_EQ(scene.textures.size(), 2u) << "an image in the same place is read once";
  const CompiledScene compiled = compile(scene);
  const Scene& s = compiled.scene;
  const auto material = [&](size_t triangle) { return s.materials[s.triangle_shading[triangle].material]; };
  EXPECT_EQ(material(0).color, Color(0.5));
  EXPECT_EQ(material(1).color, Color(1));
  EXPECT_EQ(material(2).color, Color(1, 0, 0));
  EXPECT_EQ(material(0).texture, material(2).texture);
  const auto at = [&](size_t triangle, const Vec2& uv) {
    return eval_texture(s.textures[material(triangle).texture], s.texels, {{}, uv, 0, 0});
  };
  EXPECT_EQ(at(0, {0.25, 0.5}), Color(1, 0, 0));
  EXPECT_EQ(at(0, {0.75, 0.5}), Color(0, 1, 0));
  EXPECT_EQ(at(1, {0.125, 0.5}), Color(0, 1, 0)) << "0.125 · 2 + 0.5 = 0.75";
  EXPECT_EQ(at(1, {0.375, 0.5}), Color(1, 0, 0));
}

TEST(MtlLoader, NamesThatBeginAsNumbersDoAreNames) {
  write_two_colours("2nd.png");
  const SceneDescription scene =
      load_mesh("mtllib mesh.mtl\nusemtl a\n" + kTriangle + kFace, "newmtl a\nmap_Kd -s 2 3 2nd.png\n");
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].scale, Vec3(1.0 / 2, 1.0 / 3, 1));
}

TEST(MtlLoader, WrongMapsEndInAnErrorAtTheirPlace) {
  const auto expect = [](const std::string& mtl, const std::string& place, const std::string& problem) {
    const std::string error = error_of_mesh("mtllib mesh.mtl\n" + kTriangle + kFace, mtl);
    EXPECT_NE(error.find(place), std::string::npos) << mtl << error;
    EXPECT_NE(error.find(problem), std::string::npos) << error;
  };
  expect("newmtl a\nmap_Kd -s 2 2 2 none.png\n", "mesh.mtl:2:17:", "none.png: no such file");
  expect("newmtl a\nmap_Kd -s 0 1 1 none.png\n", "mesh.mtl:2:", "must not be 0");
  expect("newmtl a\nmap_Kd -z 1 none.png\n", "mesh.mtl:2:8:", "unknown option '-z'");
  expect("newmtl a\nmap_Kd\n", "mesh.mtl:2:", "names no file");
  expect("newmtl a\nKd 1 x 0\n", "mesh.mtl:2:6:", "found 'x'");
  expect("newmtl a\nKd spectral a.rfl\n", "mesh.mtl:2:4:", "spectral");
  expect("newmtl a\nNs -1\n", "mesh.mtl:2:4:", "0 or more");
  const std::string missing = error_of_mesh("mtllib none.mtl\n" + kTriangle + kFace);
  EXPECT_NE(missing.find("mesh.obj:1:8:"), std::string::npos) << missing;
  EXPECT_NE(missing.find("none.mtl: no such file"), std::string::npos) << missing;
}

TEST(MtlLoader, WhatIsNotUsedIsNotedOnce) {
  const SceneDescription scene = load_mesh("mtllib mesh.mtl\n" + kTriangle + kFace,
                                           "Kd 1 1 1\n"            // 1
                                           "newmtl a\n"            // 2
                                           "Kd 1 1 1\n"            // 3
                                           "Ka 1 1 1\n"            // 4
                                           "map_Bump b.png\n"      // 5
                                           "Pr 0.5\n"              // 6
                                           "Kdd 1 1 1\n"           // 7
                                           "d 0.5\n"               // 8
                                           "Ke 0 0 0\nTf 1 1 1\n"  // 9, 10
                                           "newmtl b\n"            // 11
                                           "Kd 1 1 1\n"            // 12
                                           "Ka 1 1 1\n"            // 13
                                           "d 0.5\nTr 0.4\n"       // 14, 15
                                           "illum 7\n"             // 16
                                           "Ks 1 0.5 0\n"          // 17
                                           "map_d b.png\n"         // 18
                                           "newmtl a\n"            // 19
                                           "newmtl black\n");      // 20
  expect_note(scene, "mesh.mtl:1:", "before the first `newmtl`");
  expect_note(scene, "mesh.mtl:2:", "is opaque");
  expect_note(scene, "mesh.mtl:4:", "`Ka` is not used");
  expect_note(scene, "mesh.mtl:5:", "`map_Bump` is not used");
  expect_note(scene, "mesh.mtl:6:", "`Pr` is not used");
  expect_note(scene, "mesh.mtl:7:", "did you mean 'Kd'?");
  expect_note(scene, "mesh.mtl:11:", "`Tr` 0.4 of material 'b' is not used");
  expect_note(scene, "mesh.mtl:17:", "the colour of `Ks` is not used");
  expect_note(scene, "mesh.mtl:18:", "`map_d` is not used");
  expect_note(scene, "mesh.mtl:19:", "material 'a' is defined twice");
  expect_note(scene, "mesh.mtl:20:", "has no `Kd`");
  EXPECT_EQ(notes_of(scene).find("mesh.mtl:13:"), std::string::npos);
  EXPECT_EQ(notes_of(scene).find("`Ke` is"), std::string::npos);
  EXPECT_EQ(notes_of(scene).find("`Tf`"), std::string::npos);
}

TEST(MtlLoader, WhatShinesIsALight) {
  const CompiledScene compiled = compile(load_mesh("mtllib mesh.mtl\nusemtl lamp\n" + kTriangle + kFace,
                                                   "newmtl lamp\nKd 0.5 0.5 0.5\nKe 3 2 1\n"));
  ASSERT_EQ(compiled.scene.lights.size(), 1u);
  EXPECT_EQ(compiled.scene.lights[0].kind, LightKind::luminaire);
  EXPECT_EQ(compiled.scene.materials[compiled.scene.lights[0].material].emission, Color(3, 2, 1));
}

TEST(ObjLoader, NumbersMayHaveASign) {
  const SceneDescription scene = load_mesh("v +1 +2. +3e0\nv -1 .5 0\nv +.5 0 0\nf 1 2 3\n");
  EXPECT_EQ(mesh_of(scene).positions[0], glm::vec3(1, 2, 3));
  EXPECT_EQ(mesh_of(scene).positions[2], glm::vec3(0.5f, 0, 0));
  for (const char* wrong : {"+-1", "++1", "+", "1+", "0x1", "1e999", "nan", "-inf", ""}) {
    const std::string error = error_of_mesh(fmt::format("v 0 0 0\nv 1 0 {}\nv 1 1 0\nf 1 2 3\n", wrong));
    EXPECT_NE(error.find("mesh.obj:2:"), std::string::npos) << wrong << ": " << error;
  }
}

TEST(ObjLoader, WrongCornersHaveAPlace) {
  for (const char* wrong : {"0", "x", "1/", "1//", "1/x", "1/1/1/1", "1.5", "9"}) {
    const std::string error = error_of_mesh(kTriangle + "\r\n# a comment\nf 1 2 3\nf 1 2 " + wrong + "\n");
    EXPECT_NE(error.find("mesh.obj:10:"), std::string::npos) << wrong << ": " << error;
  }
}

TEST(ObjLoader, MaterialsAreFoundByTheirWholeNames) {
  write_temporary("second one.mtl", "newmtl Hard Plastic\nKd 0 1 0\n");
  write_temporary("other.mtl", "");
  const SceneDescription scene = load_mesh(
      "mtllib second one.mtl\nmtllib other.mtl mesh.mtl\n" + kTriangle + kFace + "usemtl  Hard Plastic \n" +
          kFace + "usemtl red\n" + kFace + "usemtl rd\n" + kFace + kFace + "f 1 2\nusemtl red\n" + kFace,
      "newmtl red\nKd 1 0 0\n");
  std::vector<std::string> names;
  for (const uint32_t m : mesh_of(scene).materials) names.push_back(scene.materials[m].name);
  EXPECT_EQ(names, (std::vector<std::string>{"default", "Hard Plastic", "red", "default", "default", "red"}));
  expect_note(scene, "mesh.obj:14:", "material 'rd', which no `mtllib` defines; did you mean 'red'?");
  expect_note(scene, "mesh.obj:17:", "fewer than three corners");
  EXPECT_EQ(scene.notes.lines().size(), 2u) << notes_of(scene);
  expect_note(load_mesh(kTriangle + "usemtl red\n" + kFace + "usemtl blue\n" + kFace), "mesh.obj:7:",
              "`usemtl`, as no `mtllib` before it defines a material, is not used, here and 1 times more");
}

TEST(ObjLoader, RecordsThatAreNotUsedAreNotedWithTheirNumber) {
  const SceneDescription scene =
      load_mesh("o thing\ng part\ns off\n" + kTriangle + kFace + "l 1 2\nl 2 3\ncurv 0 1 1 2\np 1\nl 3 1\n");
  expect_note(scene, "mesh.obj:11:", "`l` is not used, here and 2 times more");
  expect_note(scene, "mesh.obj:13:", "`curv` is not used");
  expect_note(scene, "mesh.obj:14:", "`p` is not used");
  EXPECT_EQ(scene.notes.lines().size(), 3u) << notes_of(scene);
  expect_note(load_mesh("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n"),
              "mesh.obj:1:", "colour is not used, here and 2 times more");
  write_temporary("mesh.obj", kTriangle + "s 1\n" + kFace + "s 2\n" + kFace);
  const std::string smooth = test::view_text() + "scene: [{mesh: {file: mesh.obj, smooth: phong}}]\n";
  expect_note(test::load_yaml(smooth), "mesh.obj:", "`s` is not used");
}

TEST(ObjLoader, AMaterialThatCanNotShowIsNoted) {
  const std::string yaml =
      test::view_text() +
      "materials: {blue: {color: [0, 0, 1]}}\nscene:\n  - {material: blue, mesh: {file: mesh.obj}}\n";
  write_temporary("mesh.mtl", "newmtl red\nKd 1 0 0\n");
  write_temporary("mesh.obj", "mtllib mesh.mtl\nusemtl red\n" + kTriangle + kFace);
  expect_note(test::load_yaml(yaml), "scene.yaml:4:16:", "material 'blue' is not used");
  write_temporary("mesh.obj", "mtllib mesh.mtl\n" + kTriangle + kFace + "usemtl red\n" + kFace);
  EXPECT_EQ(notes_of(test::load_yaml(yaml)), "");
}

/// Of all the triangles that rays are tested against, which must not reach into `hole`.
double area_of(const CompiledScene& compiled, const Box& hole = {}) {
  double sum = 0;
  for (const TriangleBlock& block : compiled.scene.triangle_blocks)
    for (size_t lane = 0; lane < 8; ++lane) {
      if (block.primitives[lane] == kNoPrimitive) continue;
      std::array<Vec3, 3> v;
      for (size_t k = 0; k < 3; ++k)
        v[k] = Vec3(block.vertices[k][0][lane], block.vertices[k][1][lane], block.vertices[k][2][lane]);
      sum += 0.5 * glm::length(glm::cross(v[1] - v[0], v[2] - v[0]));
      const Vec3 middle = (v[0] + v[1] + v[2]) / 3.0;
      EXPECT_FALSE(middle.x > hole.lo.x && middle.x < hole.hi.x && middle.y > hole.lo.y &&
                   middle.y < hole.hi.y);
    }
  return sum;
}

TEST(ObjLoader, FacesAreCutIntoTrianglesThatCoverThemOnce) {
  // An L whose inner corner the fan from its first corner would cover: 3 squares.
  const CompiledScene l = compile(
      load_mesh("v 1 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\nv 0 1 2\nv 1 1 2\nf 4 5 6 1 2 3\nf 5 6 1 2 3 4\n"));
  EXPECT_NEAR(area_of(l), 6, 1e-12);
  // A ring: an outer and an inner square, joined by a bridge there and back.
  const CompiledScene ring = compile(load_mesh(
      "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\nf 1 2 3 4 1 5 6 7 8 5\n"));
  EXPECT_NEAR(area_of(ring, {{1, 1, 0}, {3, 3, 0}}), 12, 1e-12);
  EXPECT_EQ(ring.scene.parts[0].polygon_count, 1u);
}

TEST(Loading, StopsSoonAfterItIsAsked) {
  // A net of half a million triangles.
  std::string obj;
  constexpr int kSide = 500;
  const auto out = std::back_inserter(obj);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) fmt::format_to(out, "v {} {} 0.5\n", x, y);
  for (int y = 1; y < kSide; ++y)
    for (int x = 1; x < kSide; ++x) {
      const int corner = (y - 1) * kSide + x;
      fmt::format_to(out, "f {} {} {}\nf {} {} {}\n", corner, corner + 1, corner + kSide, corner + 1,
                     corner + kSide + 1, corner + kSide);
    }
  write_temporary("mesh.obj", obj);
  const std::string scene = write_temporary("stopped.yaml", kYaml);
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  load_scene(scene);
  const Clock::duration whole = Clock::now() - begin;
  int stopped = 0;
  for (const double part : {0.05, 0.25, 0.5}) {
    std::stop_source stop;
    std::atomic<Clock::duration> asked{};
    std::jthread asker([&] {
      std::this_thread::sleep_for(part * whole);
      asked = Clock::now().time_since_epoch();
      stop.request_stop();
    });
    try {
      load_scene(scene,
                 {.stop = stop.get_token()});  // on a machine that is less busy by now it may end first
    } catch (const Stopped&) {
      ++stopped;
    }
    asker.join();
    const Clock::duration late = Clock::now().time_since_epoch() - asked.load();
    EXPECT_LT(std::chrono::duration<double>(late).count(), 0.5) << part;
  }
  EXPECT_GT(stopped, 0);
}

}  // namespace
}  // namespace rayfarm
