// Rays that leave surfaces neither meet them again nor leak through them, at any scale.
#include "common/lighting/surface.h"

#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

class SceneScale : public testing::TestWithParam<double> {};

TEST_P(SceneScale, NeitherAcneNorLeaks) {
  // Convex bodies lit from the viewer's side: no point that faces the light is shadowed by its own body,
  // whatever the scale, also far from the origin. And inside closed bodies with a light outside nothing is
  // lit.
  const double s = GetParam();
  std::mt19937 random(8);
  for (const double shift : {0.0, 300.0}) {
    SceneDescription scene;
    scene.files = {"acne"};
    scene.materials.emplace_back("m");
    scene.materials[0].ambient = 0;
    scene.materials[0].diffuse = 1;
    scene.objects.push_back({"root", {}, {}, {}});
    const Vec3 at = Vec3(shift, -0.7 * shift, 0.3 * shift) * s;
    scene.objects.push_back({"moved", {}, {}, {}});
    auto& primitives = scene.objects[0].primitives;
    primitives.push_back({SphereShape{at + Vec3(0, 0, 0) * s, s}, 0, {}});
    primitives.push_back(
        {ConeShape{at + Vec3(4, -1, 0) * s, at + Vec3(4, 1, 0.5) * s, 0.8 * s, 0.2 * s}, 0, {}});
    scene.objects[1].primitives.push_back({QuadricShape{{1, 2, 1.5, 0.1, 0, 0, 0, 0, 0, -s * s}, {}}, 0, {}});
    scene.objects[0].children.push_back(
        {1, {{TransformKind::translate, constant_curve(Vec4(at + Vec3(8, 0, 0) * s, 0)), {}, {}}}, {}});
    const Vec3 eye = at + Vec3(4, 1, 30) * s;
    scene.lights.emplace_back().position = eye;
    const CompiledScene compiled = compile(scene);
    FrameState frame_pose(compiled.scene);
    const Pose pose = frame_pose.at(0);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 target = at + Vec3(test::uniform(random, -1, 9), test::uniform(random, -1.2, 1.2), 0) * s;
      const Ray ray{eye, normalized(target - eye)};
      const Hit hit = closest_hit(compiled.scene, pose, ray);
      if (!hit.is_hit()) continue;
      ++hits;
      const Surface surface = eval_surface(compiled.scene, pose, ray, hit);
      const Vec3 origin = surface.ray_origin(eye - surface.p);
      EXPECT_FALSE(any_hit(compiled.scene, pose, {origin, eye - origin, 1}))
          << "acne at scale " << s << ", shift " << shift;
      const Vec3 inward = surface.ray_origin(-surface.geometric_normal);
      if (hit.primitive.kind() == PrimitiveKind::sphere) {
        EXPECT_TRUE(any_hit(compiled.scene, pose, {inward, normalized(test::random_point(random, 1))}))
            << "a leak";
      }
      if (HasFailure()) return;
    }
    EXPECT_GT(hits, 5000);
  }
}

INSTANTIATE_TEST_SUITE_P(, SceneScale, testing::Values(1e-3, 1.0, 1e3, 1e6));

TEST(Lighting, MeshesOfAnyScaleShadowThemselvesOnlyWhereTheyShould) {
  for (const double s : {1e-3, 1.0, 1e6}) {
    SceneDescription scene;
    scene.files = {"mesh"};
    scene.materials.emplace_back("m");
    scene.objects.push_back({"root", {}, {}, {}});
    MeshShape mesh;  // a convex octahedron
    for (const Vec3& v :
         {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
      mesh.positions.emplace_back(s * (v + Vec3(10, 20, 30)));
    for (const auto& t : {glm::uvec3(0, 2, 4), glm::uvec3(2, 1, 4), glm::uvec3(1, 3, 4), glm::uvec3(3, 0, 4),
                          glm::uvec3(2, 0, 5), glm::uvec3(1, 2, 5), glm::uvec3(3, 1, 5), glm::uvec3(0, 3, 5)})
      mesh.triangles.push_back(t);
    scene.objects[0].primitives.push_back({mesh, 0, {}});
    const CompiledScene compiled = compile(scene);
    FrameState frame_pose(compiled.scene);
    const Pose pose = frame_pose.at(0);
    std::mt19937 random(4);
    const Vec3 center = s * Vec3(10, 20, 30);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 eye = center + s * 5.0 * normalized(test::random_point(random, 1));
      const Ray ray{eye, normalized(center + s * test::random_point(random, 0.4) - eye)};
      const Hit hit = closest_hit(compiled.scene, pose, ray);
      if (!hit.is_hit()) continue;
      const Surface surface = eval_surface(compiled.scene, pose, ray, hit);
      const Vec3 origin = surface.ray_origin(eye - surface.p);
      ASSERT_FALSE(any_hit(compiled.scene, pose, {origin, eye - origin, 1}));
      const Vec3 inside = surface.ray_origin(-surface.geometric_normal);
      ASSERT_TRUE(closest_hit(compiled.scene, pose, {inside, -surface.geometric_normal}).is_hit());
    }
  }
}

}  // namespace
}  // namespace rayfarm
