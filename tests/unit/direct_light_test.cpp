// Direct light in lanes against Equation 2.4 of the thesis written out for one surface: the same to the last
// bit, on every SIMD target.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/lighting/glass_shadows.h"
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

/// What tells a surface's random numbers from others.
struct Stream {
  SampleId id;
  uint32_t number = 0;
};

Vec2 point_on(const FrameContext& context, const Stream& stream, uint32_t light) {
  if (!has_extent(context.scene.lights[light])) return Vec2(0);
  const auto mixed = static_cast<uint32_t>(mix_bits(uint64_t{stream.number} << 32 | light));
  return context.tables.sampler.point(stream.id, mixed << 8 | dimension::kLightPoint);
}

/// Equation 2.4's terms for one surface: Lambert's, and Phong's or Torrance and Sparrow's.
DirectTerms reference(const FrameContext& context, const Highlights& highlights, const Surface& s,
                      const Material& material, const Vec3& direction, const Stream& stream,
                      uint64_t& shadow_rays) {
  DirectTerms sum;
  const bool is_mirrored =
      highlights.has_reflected_rays && material.reflect > 0 && has_reflected_rays(material);
  for (uint32_t number = 0; number < context.scene.lights.size(); ++number) {
    const Light& light = context.scene.lights[number];
    // The reflected ray shows a body that shines: its highlight would be a second image of it.
    const bool is_shown_by_ray = is_mirrored && has_extent(light);
    if (is_shown_by_ray && !(material.diffuse > 0)) continue;
    Vec3 target = light.position, to_light = target - s.p;
    Color color = light.color;
    if (light.kind != LightKind::point) {
      const LightSample sample =
          sample_light(context.scene, context.pose, light, s.p, point_on(context, stream, number));
      target = sample.target;
      to_light = sample.to_light;
      color = sample.incident / std::numbers::pi;
    }
    const double cosine_times_distance = glm::dot(s.shading_normal, to_light);
    if (!(cosine_times_distance > 0)) continue;
    ++shadow_rays;
    const Vec3 origin = s.ray_origin(to_light);
    const Ray shadow_ray{origin, target - origin, 1};
    const bool is_blocked = any_hit(context.scene, context.pose, shadow_ray);
    if (context.tables.settings.glass_shadows != GlassShadows::blocked)
      color *= light_through_glass(context, shadow_ray, is_blocked, Media());
    else if (is_blocked)
      continue;
    const double distance = glm::length(to_light);
    sum.diffuse += (material.diffuse * (cosine_times_distance / distance)) * color;
    if (!(material.specular > 0) || is_shown_by_ray) continue;
    if (highlights.shape == Highlights::Shape::torrance_sparrow) {
      sum.specular += facet_highlight(material, s.shading_normal, to_light / distance, -direction) * color;
      continue;
    }
    const Vec3 reflected = direction - 2 * glm::dot(direction, s.shading_normal) * s.shading_normal;
    const double cosine = glm::dot(reflected, to_light) / distance;
    if (cosine > 0) sum.specular += (material.specular * portable_pow(cosine, material.shininess)) * color;
  }
  return sum;
}

/// Packets of any size, with misses, both ways.
void compare(const std::string& scene, const RenderSettings& settings, bool has_reflected_rays) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + scene));
  FrameState state(compiled.scene);
  const Pose pose = state.at(0);
  const SamplingTables tables(settings, 0);
  const FrameContext context{compiled.scene, pose, tables};
  test::on_every_target([&] {
    std::mt19937 random(9);
    size_t shown = 0;
    for (int n = 0; n < 600; ++n) {
      RayPacket rays;
      std::array<Stream, kMostPacketRays> streams;
      const Vec3 from = test::random_point(random, 4), to = test::random_point(random, 1);
      for (size_t i = 0, size = 1 + random() % kMostPacketRays; i < size; ++i) {
        rays.push_back(from, normalized(to + test::random_point(random, 0.4) - from));
        streams[i] = {{n, static_cast<int>(i), static_cast<uint32_t>(random() % settings.samples)},
                      static_cast<uint32_t>(random())};
      }
      std::array<Hit, kMostPacketRays> hits;
      closest_hits(compiled.scene, pose, rays, hits.data());
      const Highlights highlights{n % 2 ? Highlights::Shape::phong : Highlights::Shape::torrance_sparrow,
                                  has_reflected_rays};
      ClassicalSurfaces surfaces(context, rays, hits.data());
      for_each_lane(surfaces.met,
                    [&](size_t i) { surfaces.begin(context, i, 0, streams[i].id, streams[i].number); });
      RayCounts counts;
      add_direct_light(context, highlights, surfaces, counts);
      uint64_t shadow_rays = 0;
      for_each_lane(surfaces.met, [&](size_t i) {
        const DirectTerms one =
            reference(context, highlights, eval_surface(compiled.scene, pose, rays[i], hits[i]),
                      *surfaces.materials[i], rays.direction(i), streams[i], shadow_rays);
        EXPECT_TRUE(test::same_bits(lane_of(surfaces.diffuse, i), one.diffuse))
            << "packet " << n << ", ray " << i;
        EXPECT_TRUE(test::same_bits(lane_of(surfaces.specular, i), one.specular))
            << "packet " << n << ", ray " << i;
        shown += one.specular.x > 0;
      });
      EXPECT_EQ(counts[RayKind::shadow], shadow_rays) << "packet " << n;
      if (testing::Test::HasFailure()) break;
    }
    EXPECT_GT(shown, 100u);
  });
}

const std::string kLights = R"(
lights:
  - {position: [3, 4, 5], color: [0.9, 0.8, 0.7]}
  - {position: [-3, 2, 1], color: [0.3, 0.4, 0.5]}
  - {direction: [0.2, -1, -0.3], color: [0.2, 0.3, 0.1]}
  - {position: [1, 3, -2], falloff: true, color: [2, 1, 3]}
  - {position: [0, 4, 0], direction: [0.1, -1, 0.05], angle: 20, dark_angle: 35, color: [0.5, 0.6, 0.2]}
)";
const std::string kThings = R"(
materials:
  dull: {color: 0.5, diffuse: 0.7}
  shiny: {color: 0.7, diffuse: 0.3, specular: 0.6, shininess: 17.5}
  mirror: {color: 0.9, diffuse: 0, specular: 0.9, shininess: 300, reflect: 0.5}
  half_mirror: {color: 0.9, diffuse: 0.4, specular: 0.5, shininess: 9, reflect: 0.5}
  switched_off: {color: 0.9, diffuse: 0.4, specular: 0.5, shininess: 5, reflect: 0.5, reflections: false}
  green: {color: 0.9, diffuse: 0.1, specular: 0.3, transmit: 0.7, interior: [0.3, 0.9, 0.4], index: 1.5}
  tea: {dielectric: {index: 1.3, filter: [0.8, 0.5, 0.3]}}
  lamp: {luminaire: {emission: [3, 4, 5]}}
  inward: {luminaire: {emission: [0.3, 0.2, 0.1], inward: true}}
scene:
  - {material: shiny, sphere: {center: [0.5, 0, 0], radius: 0.6}}
  - {material: mirror, sphere: {center: [-0.8, 0.2, 0.4], radius: 0.5}}
  - {material: half_mirror, sphere: {center: [0.2, 0.7, 0.7], radius: 0.3}}
  - {material: switched_off, sphere: {center: [0.2, -0.3, 0.9], radius: 0.3}}
  - {material: dull, polygon: {points: [[-3, -0.8, -3], [-3, -0.8, 3], [3, -0.8, 3], [3, -0.8, -3]]}}
  - {material: shiny, triangles: {points: [[-1, -1, -1], [1, -1, -0.8], [1, 1, -1], [-1, 1, -0.7]],
                                  triangles: [[0, 1, 2], [0, 2, 3]],
                                  normals: [[0, 0.1, 1], [0.2, 0, 1], [0, -0.3, 1], [0.1, 0.1, 1]]}}
)";
const std::string kLamps = R"(
  - {material: lamp, sphere: {center: [1, 1.6, 1], radius: 0.2}}
  - {material: lamp, polygon: {points: [[-1, 2, -1], [0, 2, -1], [0, 2, 1], [-0.5, 2, 0], [-1, 2, 1]]}}
  - {material: inward, sphere: {center: [0, 0, 0], radius: 20}}
)";
const std::string kGlass = R"(
  - {material: green, polygon: {points: [[-3, 1.3, -3], [-3, 1.3, 3], [3, 1.3, 3], [3, 1.3, -3]]}}
  - {material: tea, sphere: {center: [-0.2, 0.1, 1.2], radius: 0.4}}
)";

// Points, sources far away, bulbs and spots; dull and shiny materials.
TEST(DirectLight, OfEightSurfacesIsThatOfOne) {
  compare(kLights + kThings, {}, false);
}

// Shadow rays to points that are chosen on luminaires (Shirley, Sung and Brown 1991); mirrors show these by
// reflected rays.
TEST(DirectLight, OfBodiesThatShineIsThatOfOne) {
  RenderSettings settings;
  settings.samples = 16;
  for (const bool has_reflected_rays : {false, true})
    compare(kLights + kThings + kLamps, settings, has_reflected_rays);
}

// Thesis 2.2.4 and 3.5.1: transparent objects weaken light, or let it through as if they were not there.
TEST(DirectLight, ThroughGlassIsThatOfOne) {
  RenderSettings settings;
  settings.samples = 16;
  for (const GlassShadows shadows : {GlassShadows::transparent, GlassShadows::none}) {
    settings.glass_shadows = shadows;
    compare(kLights + kThings + kLamps + kGlass, settings, true);
  }
}

}  // namespace
}  // namespace rayfarm
