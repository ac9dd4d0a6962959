// Surfaces of eight hits at once against those of one hit, and functions in lanes against those of one
// number: the same to the last bit, on every SIMD target.
#include "common/lighting/surfaces.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "common/lighting/eye_rays.h"
#include "common/math/portable_math.h"
#include "tests/unit/simd_targets.h"
#include "tests/unit/test_scene.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/surfaces_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/math/portable_pow-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

void pow_of_eight(const double* base, const double* exponent, double* result) {
  const RealTag d;
  for (size_t i = 0; i < 8; i += kLanes)
    hn::Store(pow(hn::Load(d, base + i), hn::Load(d, exponent + i)), d, result + i);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(pow_of_eight);

namespace {

using test::on_every_target;
using test::same_bits;

TEST(Lanes, PowersAreThoseOfOneNumber) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit;
  constexpr std::array kSpecial{0.0, -0.0, 1.0, 0.5, 1e-310, 5e-324, 1e308, 2.0, 20.0, 0.999999999};
  const auto number = [&](double largest) {
    if (random() % 8 == 0) return kSpecial[random() % kSpecial.size()];
    return random() % 2 ? unit(random) : largest * unit(random);
  };
  on_every_target([&] {
    for (int n = 0; n < 4000; ++n) {
      alignas(64) double base[8], exponent[8], result[8];
      for (size_t i = 0; i < 8; ++i) {
        base[i] = number(1e3);
        exponent[i] = (random() % 8 == 0 ? -1 : 1) * number(1e3);
      }
      HWY_DYNAMIC_DISPATCH(pow_of_eight)(base, exponent, result);
      for (size_t i = 0; i < 8; ++i)
        ASSERT_TRUE(same_bits(result[i], portable_pow(base[i], exponent[i])))
            << base[i] << "^" << exponent[i] << ": " << result[i];
    }
  });
}

// Rays through the display polygon (thesis 2.3.2, Equation 2.8).
TEST(Lanes, EyeRaysAreThoseOfOne) {
  std::mt19937 random(6);
  on_every_target([&] {
    for (int n = 0; n < 300; ++n) {
      Camera camera;
      camera.location = test::random_point(random, 10);
      const double size = n % 3 == 0 ? 1e-150 : 1;  // whose square underflows
      camera.top_left = test::random_point(random, size);
      camera.per_x = test::random_point(random, 0.01 * size);
      camera.per_y = test::random_point(random, 0.01 * size);
      RasterPoints at;
      for (size_t i = 0; i < 8; ++i) {
        at.x[i] = test::uniform(random, 0, 1000);
        at.y[i] = test::uniform(random, 0, 1000);
      }
      RayPacket rays;
      make_eye_rays(camera, at, rays);
      for (size_t i = 0; i < 8; ++i) {
        const Ray ray = camera.ray(at.x[i], at.y[i]);
        ASSERT_TRUE(same_bits(rays.origin(i), ray.origin) && same_bits(rays.direction(i), ray.direction) &&
                    rays.t_max[i] == ray.t_max);
      }
    }
  });
}

/// Rays at random points of a scene, in packets of any size, neighbours or strangers.
void compare_with_single_surfaces(const CompiledScene& compiled, double scale, int packets,
                                  size_t expected_kinds) {
  FrameState state(compiled.scene);
  const Pose pose = state.at(0);
  std::mt19937 random(5);
  size_t compared = 0;
  std::set<PrimitiveKind> kinds;
  for (int n = 0; n < packets; ++n) {
    RayPacket rays;
    const Vec3 from = test::random_point(random, scale), to = test::random_point(random, scale);
    const bool are_strangers = random() % 2;
    const size_t size = 1 + random() % kMostPacketRays;
    for (size_t i = 0; i < size; ++i) {
      const Vec3 origin = are_strangers ? test::random_point(random, scale) : from;
      rays.push_back(origin, to + test::random_point(random, 0.05 * scale) - origin);
    }
    std::array<Hit, kMostPacketRays> hits;
    closest_hits(compiled.scene, pose, rays, hits.data());
    Surfaces surfaces;
    const uint32_t met = eval_surfaces(compiled.scene, pose, rays, hits.data(), surfaces);
    for (size_t i = 0; i < kMostPacketRays; ++i) {
      ASSERT_EQ(met >> i & 1, i < rays.size && hits[i].is_hit() ? 1u : 0u);
      if (!(met >> i & 1)) continue;
      const Surface alone = eval_surface(compiled.scene, pose, rays[i], hits[i]), one = surfaces[i];
      const bool is_same = same_bits(one.p, alone.p) &&
                           same_bits(one.geometric_normal, alone.geometric_normal) &&
                           same_bits(one.shading_normal, alone.shading_normal) &&
                           same_bits(one.offset, alone.offset) && one.material == alone.material &&
                           one.is_front == alone.is_front && one.is_gouraud == alone.is_gouraud;
      ASSERT_TRUE(is_same) << "packet " << n << ", ray " << i << ", primitive " << hits[i].primitive.bits;
      ++compared;
      kinds.insert(hits[i].primitive.kind());
    }
  }
  EXPECT_GT(compared, 100u);
  EXPECT_EQ(kinds.size(), expected_kinds);
}

TEST(Surfaces, OfEightHitsAreThoseOfOneAtAnyScale) {
  on_every_target([] {
    for (const double scale : {1e-3, 1.0, 1e5})
      compare_with_single_surfaces(compile(test::make_mixed_scene(3, scale, 400)), scale, 500, 4);
  });
}

// Objects turned, stretched and mirrored; smooth meshes of triangles and of faces; flat and smooth polygons.
TEST(Surfaces, OfMovedAndSmoothObjectsAreThoseOfOne) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + R"(
materials: {a: {color: 0.5}, b: {color: 0.7}}
objects:
  things:
    - {material: a, sphere: {center: [0.5, 0, 0], radius: 0.4}}
    - {material: b, triangles: {points: [[-1, -1, 0], [1, -1, 0.2], [1, 1, 0], [-1, 1, 0.3]],
                                triangles: [[0, 1, 2], [0, 2, 3]],
                                normals: [[0, 0.1, 1], [0.2, 0, 1], [0, -0.3, 1], [0.1, 0.1, 1]]}}
    - {material: a, triangles: {points: [[-1, -1, 1], [1, -1, 1.2], [1, 1, 1]], triangles: [[0, 1, 2]], smooth: gouraud,
                                normals: [[0, 0.1, 1], [0.2, 0, 1], [0, -0.3, 1]]}}
    - {material: b, triangles: {points: [[-1, -1, -1], [1, -1, -1.2], [1, 1, -1]], triangles: [[0, 1, 2]], smooth: center,
                                normals: [[0, 0.1, 1], [0.2, 0, 1], [0, -0.3, 1]]}}
    - {material: b, polygons: {points: [[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], faces: [[0, 1, 2, 3]],
                               normals: [[0, 1, 0.1], [0.2, 1, 0], [0, 1, -0.3], [0.1, 1, 0.1]]}}
    - {material: a, polygon: {points: [[-1, -0.8, -1], [1, -0.8, -1], [1, -0.8, 1], [-1, -0.8, 1]]}}
    - {material: a, polygon: {points: [[0.8, -1, -1], [0.8, 1, -1], [0.8, 0, 1]],
                              normals: [[1, 0, 0.1], [1, 0.1, 0], [1, 0, 0]]}}
    - {material: a, cone: {base: [0, 0.5, 0], apex: [0, 1, 0], base_radius: 0.5}}
scene:
  - {use: things}
  - {use: things, transform: [{rotate: {axis: [1, 2, 3], degrees: 50}}, {scale: [1, 2, 0.5]}, {translate: [1, 0, 1]}]}
  - {use: things, transform: [{scale: [-1, 1, 1]}, {translate: [-1, 0.5, 1]}]}
)"));
  on_every_target([&] { compare_with_single_surfaces(compiled, 2, 2000, 5); });
}

}  // namespace
}  // namespace rayfarm
#endif
