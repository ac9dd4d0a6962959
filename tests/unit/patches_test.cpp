// Curved primitives of the thesis's 2.3.3: bilinear patches, and bicubic ones as meshes.
#include <map>

#include "common/description/formats/bezier.h"
#include "common/hierarchy/frame_state.h"
#include "common/hierarchy/traverser.h"
#include "common/lighting/textured.h"
#include "common/sampling/warps.h"
#include "common/shapes/bilinear_patch.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

Vec3 point_of_patch(const PatchCorners& p, double u, double v) {
  return (1 - u) * ((1 - v) * p[0] + v * p[3]) + u * ((1 - v) * p[1] + v * p[2]);
}

PatchCorners random_patch(std::mt19937& random, double at) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  PatchCorners corners;
  for (Vec3& corner : corners)
    for (int axis = 0; axis < 3; ++axis) corner[axis] = at + uniform(random);
  return corners;
}

/// All t > 0 at which a ray meets the patch, by the quadratic in u that two rulings and the ray give (S.
/// Ramsey, K. Potter and C. Hansen, "Ray bilinear patch intersections", 2004): independent of quadrics.
std::vector<double> meet_patch(const PatchCorners& p, const Vec3& o, const Vec3& d) {
  const Vec3 b = p[1] - p[0], c = p[3] - p[0], g = (p[0] - p[1]) + (p[2] - p[3]), h = o - p[0];
  // (h + t d) = u b + v c + u v g; a cross product with d leaves t out: two equations in u and v.
  const Frame across(normalized(d));
  const auto flat = [&](const Vec3& x) {
    return Vec2(glm::dot(x, across.tangent), glm::dot(x, across.bitangent));
  };
  const auto cross = [](const Vec2& x, const Vec2& y) { return x.x * y.y - x.y * y.x; };
  const Vec2 b2 = flat(b), c2 = flat(c), g2 = flat(g), h2 = flat(h);
  // h - u b is parallel to c + u g.
  const double k2 = -cross(b2, g2), k1 = cross(h2, g2) - cross(b2, c2), k0 = cross(h2, c2);
  std::vector<double> found;
  const double root = k1 * k1 - 4 * k2 * k0;
  if (root < 0) return found;
  for (const double sign : {-1.0, 1.0}) {
    const double u = (-k1 + sign * std::sqrt(root)) / (2 * k2);
    const Vec2 along = c2 + u * g2;
    const double v = glm::dot(h2 - u * b2, along) / glm::dot(along, along);
    const double t = glm::dot(point_of_patch(p, u, v) - o, d) / glm::dot(d, d);
    if (u >= 0 && u <= 1 && v >= 0 && v <= 1 && t > 0) found.push_back(t);
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(BilinearPatch, RaysMeetItWhereAnotherEquationSays) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  size_t hits = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double at = i % 3 == 0 ? 1000 : 0;
    const PatchCorners corners = random_patch(random, at);
    std::array<Vec4, 4> planes;
    const Quadric quadric = make_patch(corners, planes);
    const Vec3 o = Vec3(at) + 3.0 * Vec3(uniform(random), uniform(random), uniform(random));
    const Vec3 d =
        normalized(point_of_patch(corners, 0.5 + 0.7 * uniform(random), 0.5 + 0.7 * uniform(random)) - o);
    const std::vector<double> expected = meet_patch(corners, o, d);
    const auto t = intersect(quadric, planes, o, d, 1e9);
    ASSERT_EQ(t.has_value(), !expected.empty()) << i;
    if (!t) continue;
    ++hits;
    EXPECT_NEAR(*t, expected.front(), at == 0 ? 1e-9 : 1e-7) << i;
  }
  EXPECT_GT(hits, 8000u);
}

TEST(BilinearPatch, ParametersNormalsAndBoundsAreThoseOfItsPoints) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const PatchCorners corners = random_patch(random, 0);
    std::array<Vec4, 4> planes;
    const Quadric quadric = make_patch(corners, planes);
    for (double u = 0; u <= 1; u += 0.125)
      for (double v = 0; v <= 1; v += 0.125) {
        const Vec3 p = point_of_patch(corners, u, v);
        EXPECT_NEAR(glm::length(patch_parameters(planes, p) - Vec2(u, v)), 0, 1e-9);
        const Vec3 n = glm::cross(point_of_patch(corners, 1, v) - point_of_patch(corners, 0, v),
                                  point_of_patch(corners, u, 1) - point_of_patch(corners, u, 0));
        EXPECT_GT(glm::dot(normalized(quadric.gradient(p)), normalized(n)), 1 - 1e-9);
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_GE(p[axis], quadric.bounds.lo[axis]);
          EXPECT_LE(p[axis], quadric.bounds.hi[axis]);
        }
      }
  }
}

TEST(BilinearPatch, ScenesHaveThemInEveryStructure) {
  std::string reference;
  for (const char* structure :
       {"brute", "sah", "thesis", "{thesis: {volumes: spheres}}", "regular", "adaptive", "object"}) {
    std::string text = test::view_text() + fmt::format("scene:\n  - structure: {}\n    group:\n", structure);
    std::mt19937 random(3);
    for (int i = 0; i < 40; ++i) {
      const PatchCorners p = random_patch(random, 0);
      text += "      - patch: {points: [";
      for (const Vec3& c : p) text += fmt::format("[{}, {}, {}], ", c.x, c.y, c.z);
      text.resize(text.size() - 2);
      text += "]}\n";
    }
    const CompiledScene compiled = compile(test::load_yaml(text));
    EXPECT_EQ(compiled.scene.quadrics.size(), 40u);
    std::string hits;
    FrameState state(compiled.scene);
    const Pose pose = state.at(0);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 500; ++i) {
      const Vec3 o(3 * uniform(random), 3 * uniform(random), 3);
      const Ray ray{o, Vec3(uniform(random), uniform(random), uniform(random)) - o};
      const Hit hit = closest_hit(compiled.scene, pose, ray);
      hits += hit.is_hit() ? fmt::format("{}:{};", hit.primitive.index(), hit.t) : "-;";
    }
    if (reference.empty()) reference = hits;
    EXPECT_EQ(hits, reference) << structure;
  }
}

TEST(BilinearPatch, CornersInAPlaneAreAPolygonAndOthersCountAsQuadrics) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + R"(
scene:
  - {patch: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]}}
  - {patch: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]]}}
)"));
  EXPECT_EQ(compiled.scene.polygons.size(), 1u);
  EXPECT_EQ(compiled.scene.quadrics.size(), 1u);
  EXPECT_NE(
      test::error_of(test::view_text() + "scene: [{patch: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}}]\n")
          .find(": a patch has 4 corners, not 3"),
      std::string::npos);
}

BezierPatch random_bezier(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  BezierPatch patch;
  for (size_t i = 0; i < 16; ++i)
    patch[i] = Vec3(static_cast<double>(i % 4) + uniform(random),
                    static_cast<double>(i / 4) + uniform(random), uniform(random));
  return patch;
}

Vec3 point_of_bezier(const BezierPatch& p, double u, double v) {
  const auto cubic = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                        double t) {  // de Casteljau
    const Vec3 ab = glm::mix(a, b, t), bc = glm::mix(b, c, t), cd = glm::mix(c, d, t);
    return glm::mix(glm::mix(ab, bc, t), glm::mix(bc, cd, t), t);
  };
  std::array<Vec3, 4> rows;
  for (size_t j = 0; j < 4; ++j) rows[j] = cubic(p[4 * j], p[4 * j + 1], p[4 * j + 2], p[4 * j + 3], u);
  return cubic(rows[0], rows[1], rows[2], rows[3], v);
}

TEST(BezierPatches, TrianglesStandOffByNoMoreThanTheErrorAndNotMuchLess) {
  std::mt19937 random(4);
  double largest_share = 0;
  for (int i = 0; i < 20; ++i) {
    const BezierPatch patch = random_bezier(random);
    for (const double error : {0.1, 0.01}) {
      const uint32_t n = divisions_for(std::span(&patch, 1), error, 1000);
      ASSERT_LT(n, 100u);
      const MeshShape mesh = dice_patches(std::span(&patch, 1), n, Smoothing::phong);
      EXPECT_EQ(mesh.triangles.size(), size_t{2} * n * n);
      double largest = 0;
      for (const glm::uvec3& t : mesh.triangles)
        for (const auto& w : {Vec3(1 / 3.0), Vec3(0.5, 0.5, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5)}) {
          Vec3 p(0);
          Vec2 uv(0);
          for (int k = 0; k < 3; ++k) {
            p += w[k] * Vec3(mesh.positions[t[k]]);
            uv += w[k] * Vec2(mesh.uvs[t[k]]);
          }
          largest = std::max(largest, glm::length(p - point_of_bezier(patch, uv.x, uv.y)));
        }
      EXPECT_LE(largest, error + 1e-5);
      largest_share = std::max(largest_share, largest / error);
    }
  }
  EXPECT_GT(largest_share, 0.1) << "the bound is not much too careful";
}

TEST(BezierPatches, SharedEdgesAreTheSameToTheBitWhicheverWayTheyRun) {
  std::mt19937 random(5);
  const BezierPatch a = random_bezier(random);
  // b lies across a's edge u = 1, and runs along it backwards, as its own edge v = 0.
  BezierPatch b = random_bezier(random);
  for (size_t i = 0; i < 4; ++i) b[i] = a[4 * (3 - i) + 3];
  const std::array both{a, b};
  for (const uint32_t n : {1u, 2u, 7u, 24u}) {
    const MeshShape mesh = dice_patches(both, n, Smoothing::flat);
    for (uint32_t i = 0; i <= n; ++i)
      EXPECT_EQ(mesh.positions[(n + 1) * (n - i) + n], mesh.positions[(n + 1) * (n + 1) + i])
          << n << " " << i;
  }
}

TEST(BezierPatches, NormalsAreTheSurfacesAlsoWhereAnEdgeIsAPoint) {
  // A quarter of a paraboloid-like cap: the edge v = 0 is drawn together to the top.
  BezierPatch cap;
  for (size_t i = 0; i < 4; ++i) {
    const double angle = std::numbers::pi / 2 * static_cast<double>(i) / 3;
    const Vec3 out(std::cos(angle), 0, std::sin(angle));
    cap[i] = Vec3(0, 1, 0);
    cap[4 + i] = 0.4 * out + Vec3(0, 1, 0);
    cap[8 + i] = 0.8 * out + Vec3(0, 0.7, 0);
    cap[12 + i] = out;
  }
  const MeshShape mesh = dice_patches(std::span(&cap, 1), 8, Smoothing::phong);
  EXPECT_EQ(mesh.triangles.size(), size_t{2 * 64 - 8}) << "triangles with two corners at the top are none";
  for (uint32_t i = 0; i <= 8; ++i)
    EXPECT_GT(std::abs(glm::dot(Vec3(mesh.normals[i]), Vec3(0, 1, 0))), 0.99) << i;
  for (const glm::vec3& n : mesh.normals) EXPECT_NEAR(glm::length(Vec3(n)), 1, 1e-6);
}

TEST(BezierPatches, WrongOnesHaveTheirPlace) {
  const auto error_with = [](const std::string& rest) {
    return test::error_of(test::view_text() +
                          "scene: [{bezier: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], " + rest + "}}]\n");
  };
  const std::string good = "patches: [[0, 1, 1, 2, 0, 1, 1, 2, 0, 1, 1, 2, 0, 1, 1, 2]]";
  EXPECT_NE(error_with("patches: [[0, 1]]").find("16 indices"), std::string::npos);
  EXPECT_NE(error_with("patches: [[0, 1, 1, 2, 0, 1, 1, 2, 0, 1, 1, 2, 0, 1, 1, 3]]").find("from 0 to 2"),
            std::string::npos);
  EXPECT_NE(error_with("patches: []").find("there is no patch"), std::string::npos);
  EXPECT_NE(error_with(good + ", error: 1e-12").find("1000 parts a side"), std::string::npos);
  EXPECT_NE(error_with(good + ", error: 1, divisions: 3").find("give either"), std::string::npos);
  EXPECT_NE(error_with(good + ", divisions: 0").find("divisions must be from 1"), std::string::npos);
}

}  // namespace
}  // namespace rayfarm
