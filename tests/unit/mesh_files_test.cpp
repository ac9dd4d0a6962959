// OBJ files: what they say is used, or noted.
#include "tests/unit/mesh_files.h"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

namespace rayfarm {
namespace {

using test::error_of_mesh;
using test::expect_note;
using test::kFace;
using test::kTriangle;
using test::load_mesh;
using test::mesh_of;
using test::notes_of;
using test::write_temporary;

TEST(ObjLoader, ALibraryThatIsMissingIsNoted) {
  const SceneDescription scene = load_mesh("mtllib none.mtl\n" + kTriangle + "usemtl a\n" + kFace);
  expect_note(scene, "mesh.obj:1:8:", "none.mtl: no such file");
  expect_note(scene, "mesh.obj:8:", "`usemtl`");
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
  for (const char* wrong : {"0", "x", "/1", "1/x", "1/1/1/1", "1.5", "+-1", "9"}) {
    const std::string error = error_of_mesh(kTriangle + "\r\n# a comment\nf 1 2 3\nf 1 2 " + wrong + "\n");
    EXPECT_NE(error.find("mesh.obj:10:"), std::string::npos) << wrong << ": " << error;
  }
}

TEST(ObjLoader, OddFormsAreRead) {
  const SceneDescription scene = load_mesh(
      "v 0 0 3.1+e2\nv 1 \\\n0 0 \\\r\n1\nv 0 1 0 # three\n# a comment \\\nf +1/ 2// 3/1 # none\nvt 0 0\nfo "
      "1 \\\n 2 3\n");
  EXPECT_EQ(mesh_of(scene).positions.size(), 3u);
  EXPECT_EQ(mesh_of(scene).positions[0], glm::vec3(0, 0, 3.1f));
  EXPECT_EQ(mesh_of(scene).positions[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(mesh_of(scene).triangles.size(), 2u);
  expect_note(scene, "mesh.obj:1:", "an exponent whose sign stands before its `e`");
  EXPECT_EQ(scene.notes.lines().size(), 1u) << notes_of(scene);
  const std::string error = error_of_mesh("v 0 0 0\nv 1 \\\n 0 \\\n  x\nf 1 1 1\n");
  EXPECT_NE(error.find("mesh.obj:4:3: expected a finite number, found 'x'"), std::string::npos) << error;
}

TEST(ObjLoader, VerticesMayHaveColours) {
  const std::string faces = "v 1 1 1\nf 1 2 3\nf 1 2 4\n";
  const SceneDescription scene = load_mesh("v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0\nv 0 1 0 1 1 1\n" + faces);
  EXPECT_EQ(notes_of(scene), "");
  const MeshShape& mesh = mesh_of(scene);
  ASSERT_EQ(mesh.colors.size(), 4u);
  EXPECT_EQ(mesh.colors[0], make_vertex_color({1, decode_srgb(0.5), 0}));
  EXPECT_EQ(mesh.colors[3], kWhiteVertex) << "of vertices without one";
  const SceneDescription bytes = load_mesh("v 1 1 1\nv 0 0 0 255 127.5 0\nv 1 0 0 0 0 0\n" + faces);
  EXPECT_EQ(mesh_of(bytes).colors[1], mesh.colors[0]);
  EXPECT_EQ(mesh_of(bytes).colors[0], kWhiteVertex);
}

/// Two squares that meet at a right angle, each as two triangles.
TEST(ObjLoader, SmoothingGroupsAreObeyed) {
  const std::string corner = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 0 1 1\n";
  const std::string floor = "f 1 2 3 4\n", wall = "f 1 4 6\nf 1 6 5\n";
  const SceneDescription apart = load_mesh(corner + "s 1\n" + floor + "s 2\n" + wall);
  const MeshShape& sharp = mesh_of(apart);
  EXPECT_EQ(sharp.smoothing, Smoothing::phong) << "as the file says";
  EXPECT_EQ(sharp.normals[sharp.polygons.normals[0]], glm::vec3(0, 0, 1));
  EXPECT_EQ(sharp.normals[sharp.triangle_normals[0].x], glm::vec3(1, 0, 0));
  const SceneDescription together = load_mesh(corner + "s 1\n" + floor + wall);
  const MeshShape& round = mesh_of(together);
  const glm::vec3 edge = round.normals[round.polygons.normals[0]];
  EXPECT_NEAR(edge.x, std::sqrt(0.5f), 1e-6) << "however the wall is cut";
  EXPECT_NEAR(edge.z, std::sqrt(0.5f), 1e-6);
  EXPECT_EQ(round.triangle_normals[0].x, round.polygons.normals[0]);
  const MeshShape flat = mesh_of(load_mesh(corner + "s 1\n" + floor + "s off\n" + wall));
  EXPECT_EQ(flat.triangle_normals[0].x, ~0u);
  EXPECT_EQ(mesh_of(load_mesh(corner + floor + wall)).smoothing, Smoothing::flat);
  EXPECT_EQ(mesh_of(load_mesh(corner + "s 0\n" + floor + wall)).smoothing, Smoothing::flat);
  EXPECT_EQ(mesh_of(load_mesh(corner + "vn 0 0 1\nf 1//1 2//1 3//1\n")).smoothing, Smoothing::phong);
}

TEST(ObjLoader, ObjectsAndGroupsAreNamed) {
  const SceneDescription scene = load_mesh("o body\n" + kTriangle + kFace + kFace + "g head hair\n" + kFace +
                                           "o empty\no body\n" + kFace);
  const std::vector<NamedFaces>& names = mesh_of(scene).names;
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[0].name, "body");
  EXPECT_EQ(names[0].faces, 3u);
  EXPECT_EQ(names[1].name, "head hair");
  EXPECT_EQ(names[1].faces, 1u);
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
  write_temporary("mesh.obj", kTriangle + "s off\n" + kFace);
  const std::string smooth = test::view_text() + "scene: [{mesh: {file: mesh.obj, smooth: phong}}]\n";
  expect_note(test::load_yaml(smooth), "mesh.obj:", "the file says `s off`");
}

TEST(ObjLoader, ANodesMaterialReplacesTheFilesIfItIsAskedTo) {
  write_temporary("mesh.mtl", "newmtl red\nKd 1 0 0\n");
  write_temporary("mesh.obj", "mtllib mesh.mtl\nusemtl red\n" + kTriangle + kFace);
  const std::string head = test::view_text() + "materials: {blue: {color: [0, 0, 1]}}\nscene:\n  - ";
  for (const char* node :
       {"{material: blue, override: true, mesh: {file: mesh.obj}}",
        "{material: blue, mesh: {file: mesh.obj, override: true}}",
        "{material: blue, zones: 0.5, group: [{override: true, mesh: {file: mesh.obj}}]}"}) {
    const SceneDescription scene = test::load_yaml(head + node + "\n");
    EXPECT_EQ(notes_of(scene), "") << node;
    const PrimitiveDescription& mesh = scene.objects[scene.root].primitives.at(0);
    EXPECT_EQ(scene.materials[mesh.material].name, "blue");
    EXPECT_TRUE(std::get<MeshShape>(mesh.shape).materials.empty());
  }
  EXPECT_NE(test::error_of(head + "{override: true, mesh: {file: mesh.obj}}\n").find("give that, too"),
            std::string::npos);
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

/// Files that nobody here wrote, where they are.
std::string obj_asset(const std::string& name) {
  return std::string(RAYFARM_SOURCE) + "/../shared/assets/" + name;
}
SceneDescription load_obj_asset(const std::string& name) {
  return test::load_yaml(test::view_text() + "scene: [{mesh: {file: '" + obj_asset(name) + "'}}]\n");
}

TEST(ObjLoader, FilesOfOtherProgramsAreRead) {
  if (!std::filesystem::exists(obj_asset("obj/spider.obj"))) GTEST_SKIP() << "no ../shared/assets";
  const SceneDescription spider = load_obj_asset("obj/spider.obj");
  EXPECT_EQ(mesh_of(spider).triangles.size() + mesh_of(spider).polygons.sides.size(), 1368u);
  EXPECT_EQ(spider.textures.size(), 5u) << "named with a backslash";
  EXPECT_EQ(mesh_of(spider).names.size(), 19u);
  EXPECT_EQ(mesh_of(spider).smoothing, Smoothing::phong);
  const SceneDescription colors = load_obj_asset("obj/cube_with_vertexcolors_uni.obj");
  EXPECT_EQ(mesh_of(colors).colors.size(), 8u);
  EXPECT_EQ(mesh_of(colors).colors[1],
            make_vertex_color({1, decode_srgb(double(0.6f)), decode_srgb(double(0.3f))}));
  const SceneDescription numbers = load_obj_asset("obj/number_formats.obj");
  EXPECT_EQ(mesh_of(numbers).positions[1], glm::vec3(1, 2, 3));
  EXPECT_EQ(mesh_of(numbers).positions[2], glm::vec3(1, 2, 3));
  EXPECT_EQ(mesh_of(numbers).positions[5], glm::vec3(100, 20, 310));
  const SceneDescription spaces = load_obj_asset("obj/space_in_material_name.obj");
  EXPECT_EQ(spaces
                .materials[mesh_of(spaces).materials.empty() ? mesh_of(spaces).polygons.materials.at(0)
                                                             : mesh_of(spaces).materials.at(0)]
                .name,
            "Hard Shiny Plastic White");
  load_obj_asset("obj/cube_usemtl.obj");
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

TEST(Loading, TextInUtf16IsRefusedByName) {
  for (const auto& [name, text] :
       {std::pair<std::string, std::string>{"wide.ply", "ply\nformat ascii 1.0\n"},
        {"wide.stl",
         "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
         "endfacet\nendsolid\n"},
        {"wide.off", "OFF\n3 1 0\n"},
        {"wide.obj", "v 0 0 0\n"}})
    for (const bool has_mark : {true, false}) {
      std::string wide = has_mark ? "\xff\xfe" : "";
      for (const char c : text) wide += {c, '\0'};
      const std::string error = test::error_of(wide, name);
      EXPECT_NE(error.find("the file is in UTF-16; save it as UTF-8"), std::string::npos) << name << error;
    }
}

TEST(Loading, FilesThatAreNotThereAreLookedForWhereTheyWouldBe) {
  for (const auto& [path, hint] :
       {std::pair{"/nowhere/a.obj", "/nowhere/a.obj: no such file; check the path"},
        {"nowhere/a.obj", "check the path (it is relative to /"}})
    try {
      load_scene(path);
      ADD_FAILURE();
    } catch (const IoError& e) {
      EXPECT_NE(std::string(e.what()).find(hint), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find("relative") == std::string::npos, path[0] == '/') << e.what();
    }
}

TEST(ObjLoader, ALibraryWithBlanksInItsNameIsMissedOnce) {
  const SceneDescription scene = load_mesh("mtllib no such file.mtl\n" + kTriangle + kFace);
  expect_note(scene, "mesh.obj:1:8:", "no such file.mtl: no such file");
  EXPECT_EQ(scene.notes.lines().size(), 1u) << notes_of(scene);
}

TEST(ObjLoader, NormalsWithoutADirectionLeaveFacesFlat) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 0\nvn 0 0 2\n",
                    rest = "f 1//2 2//2 3//2\nf 1//2 2//2 3//2 4//2\n";
  const SceneDescription scene = load_mesh(points + "f 1//1 2//2 3//2\nf 1//2 2//2 3//2 4//1\n" + rest);
  expect_note(scene, "mesh.obj:5:", "a normal without a direction, at which faces are flat, is not used");
  const CompiledScene compiled = compile(scene);
  const Scene& s = compiled.scene;
  ASSERT_EQ(s.triangle_shading.size(), 2u);
  EXPECT_EQ(s.triangle_shading[0].normals[1], kNone);
  EXPECT_NE(s.triangle_shading[1].normals[1], kNone);
  ASSERT_EQ(s.mesh_faces.size(), 2u);
  EXPECT_EQ(s.mesh_faces[0].first_normal, kNone);
  EXPECT_NE(s.mesh_faces[1].first_normal, kNone);
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
  const std::string scene = write_temporary("stopped.yaml", test::kMeshYaml);
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
