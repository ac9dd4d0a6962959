// Several rays that read zones in place of one from each point that is seen.
#include <gtest/gtest.h>

#include "tests/unit/probe.h"
#include "tests/unit/simd_targets.h"
#include "tests/unit/solved_zones.h"

namespace rayfarm {
namespace {

using test::SolvedZones;
using test::zone_settings;

/// A room with a lamp, a textured wall, and in it what zones keep by directions, a polish, a mirror and
/// glass.
std::string furnished_room(const std::string& media = "") {
  return "view: {location: [0, 0, 0.9], look_at: [0, -0.3, -1], field_of_view: 80, aspect: 1}\n" + media +
         "textures: {squares: {kind: checker, first: 0.2, second: 0.8, scale: 0.3}}\n"
         "materials:\n  wall: {lambertian: [0.7, 0.5, 0.3]}\n  lamp: {luminaire: {color: 0, emission: 8}}\n"
         "  mirror: {conductor: {metal: silver}}\n  gold: {conductor: {metal: gold, exponent: 15}}\n"
         "  glass: {dielectric: {index: 1.5}}\n  paint: {polished: {color: 0.6, index: 1.5}}\n"
         "  tiles: {lambertian: 1, texture: squares}\nscene:\n"
         "  - {material: lamp, polygon: {points: "
         "[[-0.4,0.98,-0.4],[0.4,0.98,-0.4],[0.4,0.98,0.4],[-0.4,0.98,0.4]]}}\n"
         "  - {material: tiles, polygon: {points: "
         "[[-0.9,-0.5,-0.97],[-0.3,-0.5,-0.97],[-0.3,0.5,-0.97],[-0.9,0.5,-0.97]]}}\n"
         "  - {material: gold, sphere: {center: [0.5,-0.6,-0.4], radius: 0.35}}\n"
         "  - {material: mirror, sphere: {center: [-0.5,-0.6,-0.4], radius: 0.35}}\n"
         "  - {material: paint, sphere: {center: [0.5,0.2,-0.6], radius: 0.25}}\n"
         "  - {material: glass, sphere: {center: [0,-0.75,0.1], radius: 0.2}}\n" +
         room("wall");
}

/// RMS over the mean.
double unlike(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0, mean = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    sum += double{a[i] - b[i]} * (a[i] - b[i]);
    mean += b[i];
  }
  return std::sqrt(sum * static_cast<double>(a.size())) / mean;
}

TEST(GatherRays, MeanTheSameAndAreLessNoisy) {
  // A bare room with a bulb in a corner: nothing but what is gathered is noisy.
  const std::string text =
      "view: {location: [0, 0, 0.9], look_at: [0, -0.3, -1], field_of_view: 80, aspect: 1}\n"
      "lights: [{falloff: true, position: [0.8, 0.8, 0.5], color: 0.4}]\n"
      "materials:\n  wall: {lambertian: 0.6}\nscene:\n" +
      room("wall");
  for (const SamplingPattern pattern : {SamplingPattern::sobol, SamplingPattern::uncorrelated}) {
    RenderSettings settings = zone_settings(0.3, 20'000, ZoneView::gather);
    settings.sampling = pattern;
    SolvedZones solved(text, settings);
    const std::vector<float> expected = solved.picture(8, 8, 1024), one = solved.picture(8, 8, 4);
    solved.settings.zones.gather_rays = 16;
    EXPECT_LT(unlike(solved.picture(8, 8, 4), expected), 0.5 * unlike(one, expected));
    const std::vector<float> several = solved.picture(8, 8, 64);
    EXPECT_LT(unlike(several, expected), 0.04);  // edges of the room are as noisy as 64 samples let them be
    EXPECT_NEAR(std::accumulate(several.begin(), several.end(), 0.0),
                std::accumulate(expected.begin(), expected.end(), 0.0),
                0.005 * std::accumulate(expected.begin(), expected.end(), 0.0));
  }
}

/// All light of a picture with so many rays that gather, over that with one.
double light_of_several_over_one(SolvedZones& solved, uint32_t rays) {
  const std::vector<float> one = solved.picture(12, 12, 256);
  solved.settings.zones.gather_rays = rays;
  const std::vector<float> several = solved.picture(12, 12, 128);
  return std::accumulate(several.begin(), several.end(), 0.0) / std::accumulate(one.begin(), one.end(), 0.0);
}

TEST(GatherRays, ShowWhatPathsFind) {
  // All that can stand where rays go on: the mean is that of one ray each.
  SolvedZones solved(furnished_room(), zone_settings(0.3, 20'000, ZoneView::gather));
  EXPECT_NEAR(light_of_several_over_one(solved, 4), 1, 0.01);
}

TEST(GatherRays, KeepWhatGlassTookOnTheWay) {
  // A ball with a texture inside of a ball of dark glass: rays part in the glass.
  const std::string text =
      "view: {location: [0, 0, 0.9], look_at: [0, 0, -1], field_of_view: 40, aspect: 1}\n"
      "textures: {squares: {kind: checker, first: 0.5, second: 0.8, scale: 0.3}}\n"
      "materials:\n  wall: {lambertian: 0.7}\n  lamp: {luminaire: {color: 0, emission: 8}}\n"
      "  glass: {dielectric: {index: 1.5, filter: [0.01, 0.1, 0.01]}}\n  tiles: {lambertian: 1, texture: "
      "squares}\n"
      "scene:\n"
      "  - {material: lamp, polygon: {points: "
      "[[-0.4,0.98,-0.4],[0.4,0.98,-0.4],[0.4,0.98,0.4],[-0.4,0.98,0.4]]}}\n"
      "  - {material: glass, sphere: {center: [0,0,-0.3], radius: 0.5}}\n"
      "  - {material: tiles, sphere: {center: [0,0,-0.3], radius: 0.3}}\n" +
      room("wall");
  SolvedZones solved(text, zone_settings(0.3, 20'000, ZoneView::gather));
  EXPECT_NEAR(light_of_several_over_one(solved, 8), 1, 0.02);
}

TEST(GatherRays, AreTheSameInLanesAndAlone) {
  const std::string media = "media: [{box: {min: [-1,-1,-1], max: [1,0,1]}, scattering: 0.3, g: 0.4}]\n";
  RenderSettings settings = zone_settings(0.4, 5'000, ZoneView::gather);
  settings.zones.gather_rays = 3;
  settings.samples = 16;
  const SolvedZones solved(furnished_room(media), settings);
  const ZoneLight zones(solved.zones, 0, solved.solution, ZoneView::gather);
  const SamplingTables tables(settings, 0);
  const FrameContext context{
      .scene = solved.zones.scene(0), .pose = solved.zones.pose(), .tables = tables, .zones = &zones};
  const std::unique_ptr<Integrator> in_lanes = make_path(), one_by_one = make_path_one_by_one();
  const Camera camera = make_camera(solved.compiled.scene, 0, 32, 32);
  RayCounts counts_in_lanes, counts_one_by_one;
  for (int first = 0; first < 1024; first += kMostPacketRays) {
    RayPacket rays;
    std::array<SampleId, kMostPacketRays> ids;
    for (size_t i = 0; i < kMostPacketRays; ++i) {
      const int pixel = first + static_cast<int>(i);
      const Ray ray = camera.ray(pixel % 32 + 0.5, pixel / 32 + 0.5);
      rays.push_back(ray.origin, ray.direction);
      ids[i] = {pixel % 32, pixel / 32, static_cast<uint32_t>(pixel % 16)};
    }
    std::array<Color, kMostPacketRays> found, expected;
    in_lanes->trace(context, rays, ids, counts_in_lanes, found.data());
    one_by_one->trace(context, rays, ids, counts_one_by_one, expected.data());
    for (size_t i = 0; i < kMostPacketRays; ++i)
      ASSERT_TRUE(test::same_bits(found[i], expected[i])) << "pixel " << first + static_cast<int>(i);
  }
  EXPECT_EQ(counts_in_lanes[RayKind::diffuse], counts_one_by_one[RayKind::diffuse]);
  EXPECT_EQ(counts_in_lanes[RayKind::shadow], counts_one_by_one[RayKind::shadow]);
  EXPECT_GT(counts_in_lanes[RayKind::diffuse], 2 * 1024u);
}

TEST(GatherRays, OfTheEyeAskSourcesInMedia) {
  // A beam of the sun through a hole into a dark, misty room: zones that it fills a third of know only its
  // mean, and what is seen of it shows its edges, as paths find them.
  const std::string text =
      "view: {location: [0, 0, 0.99], look_at: [0, 0, -1], field_of_view: 60, aspect: 1}\n"
      "lights: [{direction: [0, -1, 0], color: 10}]\n"
      "media: [{box: {min: [-1,-1,-1], max: [1,1,1]}, scattering: 0.02}]\n"
      "materials: {wall: {lambertian: 0}}\nscene:\n"
      "  - {material: wall, polygon: {points: [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]]}}\n"
      "  - {material: wall, polygon: {points: [[-1,1,-1],[-0.15,1,-1],[-0.15,1,1],[-1,1,1]]}}\n"
      "  - {material: wall, polygon: {points: [[0.15,1,-1],[1,1,-1],[1,1,1],[0.15,1,1]]}}\n";
  const SolvedZones solved(text, zone_settings(0.5, 10'000, ZoneView::gather));
  const ZoneLight zones(solved.zones, 0, solved.solution, ZoneView::gather);
  const Ray ray{Vec3(0.3, 0, 1), Vec3(0, 0, -1), 2};  // beside the beam, in zones that it fills in part
  LitMediumPoint lit;
  const Color all = zones.radiance_of_media(ray, false, 0.5, lit);
  EXPECT_EQ(lit.medium, kNone);
  const Color indirect = zones.radiance_of_media(ray, true, 0.5, lit);
  EXPECT_NE(lit.medium, kNone);
  EXPECT_GT(all.x, 0.003);
  EXPECT_LT(indirect.x, 0.1 * all.x);
}

TEST(ZonesOfMedia, PointsThatAskSourcesAreInTheOrderOfTheirNumbers) {
  const SolvedZones solved(
      "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nlights: [{direction: [0, -1, 0]}]\n"
      "media:\n  - {box: {min: [-1,-1,-1], max: [1,1,1]}, scattering: 0.5}\n"
      "  - {box: {min: [-1,-1,1], max: [1,1,2]}, absorption: 0.5}\n"
      "  - {box: {min: [-1,-1,2], max: [1,1,4]}, scattering: 0.2, absorption: 0.1}\n"
      "scene: []\n",
      zone_settings(0.2, 1'000));
  const ZoneLight zones(solved.zones, 0, solved.solution, ZoneView::direct);
  const Ray ray{Vec3(0.31, 0.17, 5), normalized(Vec3(-0.05, -0.03, -1))};
  double before = 0;
  for (int i = 0; i < 1000; ++i) {
    LitMediumPoint lit;
    zones.radiance_of_media(ray, true, (i + 0.5) / 1000, lit);
    ASSERT_NE(lit.medium, kNone);
    ASSERT_GT(lit.t, before);
    before = lit.t;
  }
  EXPECT_GT(before, 5.9);
}

}  // namespace
}  // namespace rayfarm
