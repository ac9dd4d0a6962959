// Meshes without a scene: what is added to them, how large they are, and where they are smooth.
#include "common/description/quick_look.h"

#include <numbers>

#include "common/description/formats/mesh_normals.h"
#include "common/description/formats/mesh_scene.h"
#include "common/description/scene_bounds.h"
#include "tests/unit/mesh_files.h"

namespace rayfarm {
namespace {

const std::string kCubeOff =
    "OFF\n8 6 12\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n4 3 2 1 0\n4 4 5 6 7\n"
    "4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 3 0 4 7\n";

TEST(QuickLook, TheWholeModelIsInThePictureWhateverItsShape) {
  for (const Vec3& extent : {Vec3(1, 1, 1), Vec3(10, 0.1, 1), Vec3(0.1, 10, 1), Vec3(1, 0.2, 30),
                             Vec3(1, 1, 0), Vec3(0, 0, 0), Vec3(1e-7, 1e-7, 1e-7), Vec3(1e9, 1e9, 1e9)}) {
    const Vec3 center(3, -7, 100);
    const Box box{center - 0.5 * extent, center + 0.5 * extent};
    const QuickLook look = make_quick_look(box);
    const Vec3 forward = normalized(look.look_at - look.location);
    const Vec3 right = normalized(glm::cross(forward, Vec3(0, 1, 0))), up = glm::cross(right, forward);
    const double half = std::tan(0.5 * look.field_of_view * std::numbers::pi / 180);
    double most = 0;
    for (const Vec3& corner : corners_of(box)) {
      const Vec3 p = corner - look.location;
      ASSERT_GT(glm::dot(p, forward), 0);
      const double x = glm::dot(p, right) / glm::dot(p, forward) / half,
                   y = glm::dot(p, up) / glm::dot(p, forward) / half * (4.0 / 3);
      most = std::max({most, std::abs(x), std::abs(y)});
    }
    EXPECT_LE(most, 0.8801);
    if (max_component(extent) > 1e-3) {
      EXPECT_GT(most, 0.5) << "and fills it";
    }
    for (const Vec3& corner : look.ground) EXPECT_LT(corner.y, box.lo.y);
    EXPECT_GT(look.lamp.y - look.lamp_radius, box.hi.y);
  }
}

TEST(QuickLook, ScenesKeepTheViewAndTheLightsThatTheyHave) {
  SceneDescription lit =
      test::load_yaml(test::view_text() +
                      "lights: [{position: [1, 2, 3]}]\nscene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n");
  const size_t objects = lit.objects.size();
  add_quick_look(lit, make_quick_look(bounds_of(lit)));
  EXPECT_EQ(lit.objects.size(), objects);
  EXPECT_EQ(Vec3(lit.view.location.values[0]), Vec3(0, 0, 5));
  EXPECT_TRUE(lit.render.empty());
  SceneDescription dark =
      test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n");
  add_quick_look(dark, make_quick_look(bounds_of(dark)));
  EXPECT_EQ(Vec3(dark.view.location.values[0]), Vec3(0, 0, 5));
  EXPECT_EQ(compile(dark).scene.lights.size(), 1u);
  EXPECT_EQ(dark.render.size(), 2u);
}

TEST(QuickLook, TheSceneThatIsWrittenIsTheOneThatIsShown) {
  const std::string coloured =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty uchar "
      "red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int "
      "vertex_index\nend_header\n0.1 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0.3 0 0 255\n3 0 1 2\n";
  const std::string stl =
      "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 5\nendloop\nendfacet\n"
      "endsolid\n";
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>("it's.off", kCubeOff), {"a.ply", coloured}, {"a.stl", stl}}) {
    const std::string path = test::write_temporary(name, bytes);
    const CompiledScene shown = compile(load_scene(path));
    const CompiledScene written =
        compile(load_scene(test::write_temporary("written.yaml", yaml_of_mesh_scene(path, name, {}))));
    const auto same = [](const auto& a, const auto& b) {
      return a.size_bytes() == b.size_bytes() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
    };
    EXPECT_TRUE(same(shown.scene.triangle_blocks, written.scene.triangle_blocks)) << name;
    EXPECT_TRUE(same(shown.scene.key_values, written.scene.key_values)) << name;
    EXPECT_TRUE(same(shown.scene.normals, written.scene.normals)) << name;
    EXPECT_EQ(shown.scene.lights.size(), written.scene.lights.size());
    EXPECT_EQ(shown.scene.materials.size(), written.scene.materials.size());
  }
  const Box up = bounds_of(load_scene(test::write_temporary("up.stl", stl)));
  EXPECT_GE(up.hi.y, 5) << "in STL z is up";
}

TEST(SceneBounds, AreThoseOfEachObjectInTheWorld) {
  const SceneDescription scene =
      test::load_yaml(test::view_text() +
                      "objects: {ball: {sphere: {center: [1, 0, 0], radius: 2}}}\n"
                      "scene:\n"
                      "  - {name: turned, transform: {rotate: {axis: [0, 0, 1], degrees: 45}}, box: {min: "
                      "[0, 0, 0], max: [1, 1, 1]}}\n"
                      "  - {name: pipe, cylinder: {base: [0, 0, 0], top: [0, 0, 4], radius: 0.5}}\n"
                      "  - {use: ball, transform: {scale: [1, 2, 1]}}\n"
                      "  - {use: ball, transform: {translate: [10, 0, 0]}}\n");
  const std::vector<Box> bounds = bounds_of_objects(scene);
  const auto of = [&](const std::string& name) {
    for (size_t i = 0; i < scene.objects.size(); ++i)
      if (scene.objects[i].name == name) return bounds[i];
    return Box();
  };
  EXPECT_NEAR(of("turned").lo.x, -std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(of("turned").hi.y, std::sqrt(2), 1e-12);
  EXPECT_EQ(of("pipe").hi, Vec3(0.5, 0.5, 4));
  EXPECT_EQ(of("pipe").lo, Vec3(-0.5, -0.5, 0));
  EXPECT_EQ(of("ball").lo, Vec3(-1, -4, -2));
  EXPECT_EQ(of("ball").hi, Vec3(13, 4, 2));
}

TEST(Creases, PartSurfacesThatMeetAtLargerAngles) {
  test::write_temporary("cube.off", kCubeOff);
  const auto normals = [](const std::string& keys) {
    return test::mesh_of(
        test::load_yaml(test::view_text() + "scene: [{mesh: {file: cube.off" + keys + "}}]\n"));
  };
  EXPECT_TRUE(normals("").normals.empty());
  EXPECT_EQ(normals(", smooth: phong").normals.size(), 8u);
  EXPECT_EQ(normals(", crease: 100").normals.size(), 8u) << "edges of 90° are smooth";
  const MeshShape sharp = normals(", crease: 40");
  EXPECT_EQ(sharp.smoothing, Smoothing::phong);
  EXPECT_EQ(sharp.normals.size(), 24u);
  for (size_t face = 0, at = 0; face < 6; ++face)
    for (size_t k = 0; k < 4; ++k, ++at)
      EXPECT_EQ(sharp.normals[sharp.polygons.normals[at]], sharp.normals[sharp.polygons.normals[4 * face]]);
  EXPECT_NE(
      test::error_of(test::view_text() + "scene: [{mesh: {file: cube.off, smooth: flat, crease: 40}}]\n")
          .find("`crease` belongs to a smooth mesh"),
      std::string::npos);
}

TEST(QuickLook, SpecksAreNamed) {
  const auto notes_with = [](const char* size) {
    const std::string path =
        test::write_temporary("speck.obj", fmt::format("v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nf 1 2 3\n", size));
    std::string all;
    const SceneDescription scene = load_scene(path);
    for (const std::string& line : scene.notes.lines()) all += line;
    return all;
  };
  EXPECT_NE(notes_with("1e-30").find("speck.obj: the model is too small to be shown by itself"),
            std::string::npos);
  EXPECT_EQ(notes_with("1e-12"), "");
}

}  // namespace
}  // namespace rayfarm
