// Direct light in lanes against Equation 2.4 written out for one surface: the same to the last bit, on every
// SIMD target.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/lighting/integrators/classical_surfaces.h"
#include "common/lighting/torrance_sparrow.h"
#include "common/math/portable_math.h"
#include "tests/unit/simd_targets.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

struct DirectTerms {
  Color diffuse{0}, specular{0};
};

/// Equation 2.4's terms for one surface: Lambert's, and Phong's or Torrance and Sparrow's.
DirectTerms reference(const FrameContext& context, Highlights::Shape shape, const Surface& s,
                      const Material& material, const Vec3& direction) {
  DirectTerms sum;
  for (const Light& light : context.scene.lights) {
    Vec3 target = light.position, to_light = target - s.p;
    Color color = light.color;
    if (light.kind != LightKind::point) {
      const LightSample sample = sample_light(context.scene, context.pose, light, s.p, Vec2(0));
      target = sample.target;
      to_light = sample.to_light;
      color = sample.incident / std::numbers::pi;
    }
    const double cosine_times_distance = glm::dot(s.shading_normal, to_light);
    if (!(cosine_times_distance > 0)) continue;
    const Vec3 origin = s.ray_origin(to_light);
    if (any_hit(context.scene, context.pose, {origin, target - origin, 1})) continue;
    const double distance = glm::length(to_light);
    sum.diffuse += (material.diffuse * (cosine_times_distance / distance)) * color;
    if (!(material.specular > 0)) continue;
    if (shape == Highlights::Shape::torrance_sparrow) {
      sum.specular += facet_highlight(material, s.shading_normal, to_light / distance, -direction) * color;
      continue;
    }
    const Vec3 reflected = direction - 2 * glm::dot(direction, s.shading_normal) * s.shading_normal;
    const double cosine = glm::dot(reflected, to_light) / distance;
    if (cosine > 0) sum.specular += (material.specular * portable_pow(cosine, material.shininess)) * color;
  }
  return sum;
}

// Points, sources far away, bulbs and spots; dull and shiny materials; packets of any size with misses.
TEST(DirectLight, OfEightSurfacesIsThatOfOne) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + R"(
lights:
  - {position: [3, 4, 5], color: [0.9, 0.8, 0.7]}
  - {position: [-3, 2, 1], color: [0.3, 0.4, 0.5]}
  - {direction: [0.2, -1, -0.3], color: [0.2, 0.3, 0.1]}
  - {position: [1, 3, -2], falloff: true, color: [2, 1, 3]}
  - {position: [0, 4, 0], direction: [0.1, -1, 0.05], angle: 20, dark_angle: 35, color: [0.5, 0.6, 0.2]}
materials:
  dull: {color: 0.5, diffuse: 0.7}
  shiny: {color: 0.7, diffuse: 0.3, specular: 0.6, shininess: 17.5}
  mirror: {color: 0.9, diffuse: 0, specular: 0.9, shininess: 300, reflect: 0.5}
scene:
  - {material: shiny, sphere: {center: [0.5, 0, 0], radius: 0.6}}
  - {material: mirror, sphere: {center: [-0.8, 0.2, 0.4], radius: 0.5}}
  - {material: dull, polygon: {points: [[-3, -0.8, -3], [-3, -0.8, 3], [3, -0.8, 3], [3, -0.8, -3]]}}
  - {material: shiny, triangles: {points: [[-1, -1, -1], [1, -1, -0.8], [1, 1, -1], [-1, 1, -0.7]],
                                  triangles: [[0, 1, 2], [0, 2, 3]],
                                  normals: [[0, 0.1, 1], [0.2, 0, 1], [0, -0.3, 1], [0.1, 0.1, 1]]}}
)"));
  FrameState state(compiled.scene);
  const Pose pose = state.at(0);
  const RenderSettings settings;
  const SamplingTables tables(settings, 0);
  const FrameContext context{compiled.scene, pose, tables};
  test::on_every_target([&] {
    std::mt19937 random(9);
    size_t shown = 0;
    for (int n = 0; n < 600; ++n) {
      RayPacket rays;
      const Vec3 from = test::random_point(random, 4), to = test::random_point(random, 1);
      for (size_t i = 0, size = 1 + random() % kMostPacketRays; i < size; ++i)
        rays.push_back(from, normalized(to + test::random_point(random, 0.4) - from));
      std::array<Hit, kMostPacketRays> hits;
      closest_hits(compiled.scene, pose, rays, hits.data());
      const auto shape = n % 2 ? Highlights::Shape::phong : Highlights::Shape::torrance_sparrow;
      ClassicalSurfaces surfaces(context, rays, hits.data());
      for_each_ray(surfaces.met, [&](size_t i) { surfaces.begin(context, i, 0, SampleId(), 0); });
      RayCounts counts;
      add_direct_light(context, {.shape = shape}, surfaces, counts);
      for_each_ray(surfaces.met, [&](size_t i) {
        const DirectTerms one =
            reference(context, shape, eval_surface(compiled.scene, pose, rays[i], hits[i]),
                      *surfaces.materials[i], rays.direction(i));
        EXPECT_TRUE(test::same_bits(lane_of(surfaces.diffuse, i), one.diffuse))
            << "packet " << n << ", ray " << i;
        EXPECT_TRUE(test::same_bits(lane_of(surfaces.specular, i), one.specular))
            << "packet " << n << ", ray " << i;
        shown += one.specular.x > 0;
      });
      if (testing::Test::HasFailure()) break;
    }
    EXPECT_GT(shown, 100u);
  });
}

}  // namespace
}  // namespace rayfarm
