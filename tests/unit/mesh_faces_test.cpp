// Meshes of polygons that share corners (thesis 2.3.3: the unique nodes in a linear list, a polygon a list of
// nodes; 4.3.2: sharing of nodes and edges in polygonal meshes), and solids that are made of them.
#include <map>
#include <numbers>

#include "common/description/primitive_counts.h"
#include "common/lighting/textured.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

const std::string kCube =
    "{points: [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1]], "
    "faces: [[3,2,1,0],[4,5,6,7],[0,1,5,4],[2,3,7,6],[1,2,6,5],[3,0,4,7]]";

struct World {
  explicit World(const std::string& shape)
      : compiled(compile(test::load_yaml(test::view_text() + "scene:\n  - " + shape + "\n"))),
        state(compiled.scene),
        pose(state.at(0)) {}
  Hit hit(const Ray& ray) const { return closest_hit(compiled.scene, pose, ray); }
  Surface surface(const Ray& ray) const { return eval_surface(compiled.scene, pose, ray, hit(ray)); }
  CompiledScene compiled;
  FrameState state;
  Pose pose;
};

TEST(MeshFaces, ShareTheirCornersAndAreOnePrimitiveEach) {
  const World world("{polygons: " + kCube + "}}");
  const Scene& s = world.compiled.scene;
  EXPECT_EQ(s.mesh_points.size(), 8u);
  EXPECT_EQ(s.mesh_faces.size(), 6u);
  EXPECT_TRUE(s.triangle_shading.empty() && s.polygon_points.empty());
  EXPECT_EQ(s.parts[0].polygon_count, 6u);
  EXPECT_TRUE(world.compiled.notes.lines().size() <= 1) << "but of the dark";
  // Rays on both sides of the diagonal, and on it, meet the same primitive.
  for (const Vec3 p : {Vec3(0.5, -0.2, 5), Vec3(-0.2, 0.5, 5), Vec3(0.3, 0.3, 5), Vec3(-0.4, 0.4, 5)}) {
    const Ray ray{p, Vec3(0, 0, -1)};
    ASSERT_TRUE(world.hit(ray).is_hit());
    EXPECT_EQ(world.hit(ray).primitive, make_primitive_id(PrimitiveKind::face, 1));
    EXPECT_EQ(world.surface(ray).geometric_normal, Vec3(0, 0, 1));
    EXPECT_TRUE(world.surface(ray).is_front);
  }
}

TEST(MeshFaces, ANodesNormalIsTheAverageOfThePolygonsThatContainIt) {
  // Thesis 2.3.5, Gouraud's first step. Each corner of a cube belongs to three squares: triangles that the
  // squares are cut into would count some of them twice.
  const World world("{polygons: " + kCube + ", smooth: phong}}");
  ASSERT_EQ(world.compiled.scene.normals.size(), 8u);
  for (const glm::vec3& n : world.compiled.scene.normals)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(n[k]), std::sqrt(1.0 / 3), 1e-7);
}

TEST(MeshFaces, AreShadedAsThePolygonsThatTheyAre) {
  // A concave polygon of nine corners with normals, as one of its own and as a face: the same surface.
  const std::string points = "[[0,0,0],[2,0,0],[2,1,0],[3,1,0],[3,3,0],[2,4,0],[1,2,0],[0.5,3,0],[-1,1,0]]",
                    normals =
                        "[[-1,-1,2],[1,-1,2],[1,0,2],[1,0,3],[1,1,2],[0,1,1],[0,0,1],[-1,1,3],[-1,0,1]]";
  for (const char* smooth : {"phong", "center", "gouraud"}) {
    const World own(
        fmt::format("{{polygon: {{points: {}, normals: {}, smooth: {}}}}}", points, normals, smooth)),
        face(
            fmt::format("{{polygons: {{points: {}, normals: {}, smooth: {}, faces: [[0,1,2,3,4,5,6,7,8]]}}}}",
                        points, normals, smooth));
    ASSERT_EQ(face.compiled.scene.mesh_faces.size(), 1u);
    std::mt19937 random(4);
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
      const Ray ray{{test::uniform(random, -1, 3), test::uniform(random, 0, 4), 5}, Vec3(0, 0, -1)};
      ASSERT_EQ(own.hit(ray).is_hit(), face.hit(ray).is_hit());
      if (!own.hit(ray).is_hit()) continue;
      ++hits;
      const Surface a = own.surface(ray), b = face.surface(ray);
      EXPECT_NEAR(glm::length(a.shading_normal - b.shading_normal), 0, 1e-6) << smooth;  // normals are float
      EXPECT_EQ(a.is_gouraud, b.is_gouraud);
    }
    EXPECT_GT(hits, 150);
  }
}

TEST(MeshFaces, ThatAreNotPlanarAreCutAndItIsSaidOnce) {
  const World world(
      "{polygons: {points: [[0,0,0],[1,0,0],[1,1,0.2],[0,1,0],[2,0,0],[2,1,0],[3,0,0.0001],[3,1,0]], "
      "faces: [[0,1,2,3],[1,4,5,2],[4,6,7,5]]}}");
  EXPECT_EQ(world.compiled.scene.mesh_faces.size(), 1u) << "a ten-thousandth is rounding";
  EXPECT_EQ(world.compiled.scene.triangle_shading.size(), 4u);
  int notes = 0;
  for (const std::string& line : world.compiled.notes.lines())
    if (line.find("scene.yaml:3:") != std::string::npos &&
        line.find("2 faces of meshes are not planar: triangles stand for them") != std::string::npos)
      ++notes;
  EXPECT_EQ(notes, 1);
}

TEST(MeshFaces, TextureCoordinatesVaryOverTheWholePolygon) {
  // Coordinates that are linear in x and y are met everywhere.
  test::write_temporary("uv.obj",
                        "v 0 0 0\nv 2 0 0\nv 3 2 0\nv 1 3 0\nv -1 1 0\nvt 0 0\nvt 0.2 0.4\nvt 0.3 0.8\n"
                        "vt 0.1 0.5\nvt -0.1 -0.1\nf 1/1 2/2 3/3 4/4 5/5\n");
  const World world("{mesh: {file: uv.obj}}");
  for (const Vec3 p : {Vec3(0.5, 0.5, 5), Vec3(1.5, 1.9, 5), Vec3(-0.4, 0.8, 5), Vec3(2, 1, 5)}) {
    const Hit hit = world.hit({p, Vec3(0, 0, -1)});
    ASSERT_EQ(hit.primitive.kind(), PrimitiveKind::face);
    const Vec2 uv = surface_parameters(world.compiled.scene, hit, Vec3(p.x, p.y, 0));
    EXPECT_NEAR(uv.x, 0.1 * p.x, 1e-7);
    EXPECT_NEAR(uv.y, 0.2 * p.x + 0.1 * p.y, 1e-7);
  }
}

TEST(MeshFaces, ShineAsOneLampEach) {
  const World world("{material: lamp, polygons: " + kCube +
                    "}}\nmaterials: {lamp: {luminaire: {emission: 1}}}");
  const Scene& s = world.compiled.scene;
  ASSERT_EQ(s.lights.size(), 6u);
  for (const Light& light : s.lights) {
    EXPECT_EQ(light.primitive.kind(), PrimitiveKind::face);
    EXPECT_EQ(light.triangle_count, 2u);
  }
}

TEST(MeshFaces, WhatIsWrongInYamlIsToldWithItsPlace) {
  const auto error = [](const std::string& shape) {
    return test::error_of(test::view_text() + "scene:\n  - " + shape + "\n");
  };
  EXPECT_NE(error("{polygons: {points: [[0,0,0],[1,0,0],[1,1,0]], faces: [[0,1,3]]}}").find("scene.yaml:3:"),
            std::string::npos);
  EXPECT_NE(error("{polygons: {points: [[0,0,0],[1,0,0],[1,1,0]], faces: [[0,1]]}}").find("three or more"),
            std::string::npos);
  EXPECT_NE(error("{polygons: {points: [[0,0,0],[1,0,0],[1,1,0]], faces: [[0,1,2]], normals: [[0,0,1]]}}")
                .find("3 points but 1 normals"),
            std::string::npos);
  EXPECT_NE(error("{polygons: {points: [[0,0,0],[1,0,0],[1,1,0]]}}").find("faces"), std::string::npos);
  EXPECT_NE(
      error("{polygon: {points: [[0,0,0],[1,0,0],[1,1,0]], smooth: gouraud}}").find("one for each point"),
      std::string::npos);
  EXPECT_NE(error("{polygons: {points: [], faces: [[0,1,2]]}}").find("needs points"), std::string::npos);
}

/// What a closed mesh must be, and its volume and area.
struct Solid {
  explicit Solid(const std::string& shape) {
    const SceneDescription scene = test::load_yaml(test::view_text() + "scene: [" + shape + "]\n");
    const auto& mesh = std::get<MeshShape>(scene.objects[scene.root].primitives.at(0).shape);
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    const auto add = [&](std::span<const uint32_t> corners) {
      std::vector<Vec3> points;
      for (size_t i = 0; i < corners.size(); ++i) {
        ++edges[{corners[i], corners[(i + 1) % corners.size()]}];
        points.emplace_back(mesh.positions[corners[i]]);
      }
      const Vec3 normal = 0.5 * newell_normal(points);
      volume += glm::dot(normal, points[0]) / 3;
      area += glm::length(normal);
      ++faces;
    };
    for (const glm::uvec3& t : mesh.triangles) add(std::array{t.x, t.y, t.z});
    size_t begin = 0;
    for (const uint32_t sides : mesh.polygons.sides) {
      add(std::span(mesh.polygons.corners).subspan(begin, sides));
      begin += sides;
    }
    for (const auto& [edge, count] : edges) {  // each edge once this way and once that way
      EXPECT_EQ(count, 1) << shape;
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1u) << shape;
    }
  }
  double volume = 0, area = 0;
  int faces = 0;
};

TEST(Lathe, IsClosedAndFacesOutwardWhicheverWayItsProfileRuns) {
  // A frustum of N sides has the volume A h (r1² + r1 r2 + r2²) / 3 with A = N/2 sin(2π/N).
  const auto factor = [](int sides) { return 0.5 * sides * std::sin(2 * std::numbers::pi / sides); };
  const double cup = factor(12) * (2 * (1 + 2 + 4) / 3.0 + 3 * 4);  // from 1 to 2 over 2, then 3 of 2
  for (const char* profile : {"[[1, 0], [2, 2], [2, 5]]", "[[2, 5], [2, 2], [1, 0]]"}) {
    const Solid solid(fmt::format("{{lathe: {{profile: {}, sides: 12}}}}", profile));
    EXPECT_EQ(solid.faces, 2 * 12 + 2) << "two lids";
    EXPECT_NEAR(solid.volume, cup, 1e-5);
  }
  // From the axis to the axis: a double cone, all triangles.
  const Solid cone("{lathe: {profile: [[0, -1], [1, 0], [0, 3]], sides: 7}}");
  EXPECT_EQ(cone.faces, 14);
  EXPECT_NEAR(cone.volume, factor(7) * 4 / 3.0, 1e-6);
  // A ring of square section: Pappus, with the polygon's factor in place of π.
  for (const char* profile :
       {"[[2, 0], [3, 0], [3, 1], [2, 1], [2, 0]]", "[[2, 0], [2, 1], [3, 1], [3, 0], [2, 0]]"}) {
    const Solid ring(fmt::format("{{lathe: {{profile: {}, sides: 9, smooth: flat}}}}", profile));
    EXPECT_EQ(ring.faces, 36);
    EXPECT_NEAR(ring.volume, factor(9) * (9 - 4), 1e-5);
    const double rim = 2 * 9 * std::sin(std::numbers::pi / 9);  // round a polygon of radius 1
    EXPECT_NEAR(ring.area, 2 * factor(9) * (9 - 4) + rim * (2 + 3), 1e-5);
  }
}

TEST(Lathe, SmoothNormalsAreThoseOfTheCurvedSurfaceWithItsCreases) {
  // A ball: normals are directions from its middle. A cylinder: walls level, lids upright, the rim sharp.
  std::string profile;
  for (int i = 0; i <= 16; ++i)
    profile += fmt::format("[{:.9f}, {:.9f}],", i == 0 || i == 16 ? 0 : std::sin(std::numbers::pi * i / 16),
                           -std::cos(std::numbers::pi * i / 16));
  const World ball("{lathe: {profile: [" + profile + "], sides: 24}}");
  const World drum("{lathe: {profile: [[1, -1], [1, 1]], sides: 24}}");
  std::mt19937 random(6);
  for (int i = 0; i < 300; ++i) {
    const Vec3 eye = 5.0 * normalized(test::random_point(random, 1));
    const Surface on_ball = ball.surface({eye, normalized(-eye)});
    EXPECT_TRUE(on_ball.is_front);
    EXPECT_GT(glm::dot(on_ball.shading_normal, normalized(on_ball.p)), std::cos(0.03));
    const Surface on_drum = drum.surface({eye, normalized(-eye)});
    EXPECT_TRUE(on_drum.is_front);
    const bool is_lid = std::abs(std::abs(on_drum.p.y) - 1) < 1e-6;
    const Vec3 n = normalized(is_lid ? Vec3(0, on_drum.p.y, 0) : Vec3(on_drum.p.x, 0, on_drum.p.z));
    EXPECT_GT(glm::dot(on_drum.shading_normal, n), std::cos(0.03));
  }
  // Without creases the rim of a double cone is as smooth as its walls: level, half way between them.
  const World soft("{lathe: {profile: [[0, -1], [1, 0], [0, 1]], sides: 48, crease: 179}}");
  EXPECT_NEAR(soft.surface({{5, 1e-4, 0}, {-1, 0, 0}}).shading_normal.y, 0, 1e-3);
  const World sharp("{lathe: {profile: [[0, -1], [1, 0], [0, 1]], sides: 48}}");
  EXPECT_NEAR(sharp.surface({{5, 1e-4, 0}, {-1, 0, 0}}).shading_normal.y, std::sqrt(0.5), 1e-3);
}

TEST(Extrude, IsAClosedPrismOfAnyPolygon) {
  // An L of three squares, both ways round.
  for (const char* polygon :
       {"[[0,0],[2,0],[2,1],[1,1],[1,2],[0,2]]", "[[0,0],[0,2],[1,2],[1,1],[2,1],[2,0]]"}) {
    const Solid solid(fmt::format("{{extrude: {{polygon: {}, height: 2.5}}}}", polygon));
    EXPECT_EQ(solid.faces, 8);
    EXPECT_NEAR(solid.volume, 3 * 2.5, 1e-12);
    EXPECT_NEAR(solid.area, 2 * 3 + 8 * 2.5, 1e-12);
  }
}

TEST(Solids, WhatEnclosesNothingOrCrossesItselfIsRefused) {
  const auto error = [](const std::string& shape) {
    return test::error_of(test::view_text() + "scene:\n  - " + shape + "\n");
  };
  const std::pair<const char*, const char*> kWrong[] = {
      {"{lathe: {profile: [[0, 0], [0, 1]], sides: 8}}", "encloses nothing"},
      {"{lathe: {profile: [[1, 0]], sides: 8}}", "at least 2 points"},
      {"{lathe: {profile: [[1, 0], [-1, 1]], sides: 8}}", "below 0"},
      {"{lathe: {profile: [[1, 0], [1, 0], [1, 1]], sides: 8}}", "in a row are the same"},
      {"{lathe: {profile: [[1, 0], [2, 2], [2, 0], [1, 2]], sides: 8}}", "crosses itself"},
      {"{lathe: {profile: [[1, 0], [1, 1]], sides: 2}}", "sides"},
      {"{lathe: {profile: [[1, 0], [1, 1]], sides: 8, smooth: flat, crease: 10}}", "`crease` belongs"},
      {"{lathe: {profile: [[1, 0, 2], [1, 1]], sides: 8}}", "[r, y]"},
      {"{extrude: {polygon: [[0,0],[1,1],[1,0],[0,1]], height: 1}}", "crosses itself"},
      {"{extrude: {polygon: [[0,0],[1,1],[2,2]], height: 1}}", "encloses nothing"},
      {"{extrude: {polygon: [[0,0],[1,0],[1,1],[0,0]], height: 1}}", "first again"},
      {"{extrude: {polygon: [[0,0],[1,0],[1,1]], height: 0}}", "above 0"},
  };
  for (const auto& [shape, text] : kWrong) {
    EXPECT_NE(error(shape).find(text), std::string::npos) << shape << ": " << error(shape);
    EXPECT_NE(error(shape).find("scene.yaml:3:"), std::string::npos) << shape;
  }
}

TEST(PrimitiveCounts, AreThoseOfTable43) {
  // Thesis, Table 4.3, each object as a solid of as many polygons: 1,658 and 2,708 in all.
  const auto lathe = [](int lines, int sides) {
    std::string profile = "[0, 0]";
    for (int i = 1; i < lines; ++i) profile += fmt::format(", [{}, {}]", 1 + 0.3 * (i % 2), i);
    return fmt::format("{{lathe: {{profile: [{}, [0, {}]], sides: {}}}}}", profile, lines, sides);
  };
  const auto prism = [](int walls) {
    std::string polygon;
    for (int i = 0; i < walls; ++i)
      polygon += fmt::format("[{}, {}],", std::cos(2 * std::numbers::pi * i / walls),
                             std::sin(2 * std::numbers::pi * i / walls));
    return fmt::format("{{extrude: {{polygon: [{}], height: 1}}}}", polygon);
  };
  const auto flat = [](int count) {
    std::string points, faces;
    for (int i = 0; i <= count; ++i) points += fmt::format("[{0}, 0, 0], [{0}, 1, 0],", i);
    for (int i = 0; i < count; ++i)
      faces += fmt::format("[{}, {}, {}, {}],", 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
    return fmt::format("{{polygons: {{points: [{}], faces: [{}]}}}}", points, faces);
  };
  const auto counted = [](const std::string& objects, const std::string& scene) {
    const SceneDescription description =
        test::load_yaml(test::view_text() + "objects:\n" + objects + "scene:\n" + scene);
    const PrimitiveCounts counts = count_copies(description);
    EXPECT_EQ(counts.spheres + counts.quadrics, 0u);
    const CompiledScene compiled = compile(description);
    uint64_t sum = 0;  // as the compiled scene has them
    for (const Instance& i : compiled.scene.instances) {
      const Part& part = compiled.scene.parts[i.part];
      sum += part.triangle_count + part.polygon_count;
    }
    EXPECT_EQ(sum, counts.polygons);
    return counts.polygons;
  };
  std::string scene;
  for (const std::string& shape : {flat(14), flat(1), flat(1), lathe(14, 5), lathe(36, 10), flat(2), flat(3),
                                   lathe(18, 10), lathe(18, 10), lathe(16, 5), lathe(36, 10), lathe(26, 10)})
    scene += "  - " + shape + "\n";
  for (int i = 0; i < 8; ++i) scene += "  - {use: frame, transform: {translate: [0, 0, 1]}}\n";
  for (const int walls : {12, 12, 11, 11, 11}) scene += "  - " + prism(walls) + "\n";  // the title's letters
  EXPECT_EQ(counted("  frame: " + prism(8) + "\n", scene), 1658u);
  std::string plant;
  for (const std::string& shape : {lathe(28, 10), flat(36), lathe(12, 3), flat(4)})
    plant += "  - " + shape + "\n";
  for (int i = 0; i < 8; ++i)
    plant += fmt::format("  - {{use: leaf, transform: {{translate: [0, 0, {}]}}}}\n", i);
  EXPECT_EQ(counted("  leaf: " + lathe(14, 21) + "\n", plant), 2708u);
}

}  // namespace
}  // namespace rayfarm
