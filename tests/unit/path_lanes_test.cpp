// Paths that take their steps in lanes are those that are followed one by one, to the last bit, on every SIMD
// target.
#include <bit>
#include <random>

#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

struct Traced {
  std::array<Color, kMostPacketRays> colors;
  size_t eye_hits;
};

/// Traces packets of all sizes from points within a room both ways.
void compare(const std::string& scene, const RenderSettings& settings, const std::string& what) {
  SCOPED_TRACE(what);
  Probe probe(scene);
  const SamplingTables tables(settings, 2);
  const FrameContext context{probe.compiled.scene, probe.pose, tables, 0.001};
  const auto trace = [&](Integrator& integrator, const RayPacket& rays, std::span<const SampleId> ids,
                         RayCounts& counts) {
    Traced traced;
    traced.eye_hits = integrator.trace(context, rays, ids, counts, traced.colors.data());
    return traced;
  };
  const std::unique_ptr<Integrator> in_lanes = make_path(), one_by_one = make_path_one_by_one();
  RayCounts counts_in_lanes, counts_one_by_one;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> real(-0.7, 0.7);
  for (int round = 0; round < 300; ++round) {
    const size_t n = round % 3 ? kMostPacketRays : 1 + static_cast<size_t>(random() % kMostPacketRays);
    RayPacket rays;
    std::vector<SampleId> ids;
    const Vec3 origin(real(random), real(random), real(random)),
        towards(real(random), real(random), real(random));
    for (size_t i = 0; i < n; ++i) {
      rays.push_back(origin, normalized(towards + 0.3 * Vec3(real(random), real(random), real(random))));
      ids.push_back({round, static_cast<int>(i), static_cast<uint32_t>(random() % settings.samples)});
    }
    const Traced found = trace(*in_lanes, rays, ids, counts_in_lanes),
                 expected = trace(*one_by_one, rays, ids, counts_one_by_one);
    ASSERT_EQ(found.eye_hits, expected.eye_hits);
    for (size_t i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(std::bit_cast<uint64_t>(found.colors[i][c]), std::bit_cast<uint64_t>(expected.colors[i][c]))
            << "round " << round << ", ray " << i << ", channel " << c << ": " << found.colors[i][c]
            << " and " << expected.colors[i][c];
  }
  for (const RayKind kind :
       {RayKind::primary, RayKind::shadow, RayKind::reflected, RayKind::transmitted, RayKind::diffuse})
    EXPECT_EQ(counts_in_lanes[kind], counts_one_by_one[kind]);
  EXPECT_EQ(counts_in_lanes[RayKind::shadow] > 0, settings.max_reflections > 0);
}

/// All kinds of materials, in a room that is open at one side.
std::string scene_with(const std::string& lights, const std::string& lamps) {
  return "background: [0.1, 0.2, 0.3]\nlights: [" + lights + "]\n" + R"(
materials:
  wall: {lambertian: [0.8, 0.5, 0.4]}
  black: {lambertian: 0}
  lamp: {luminaire: {emission: [3, 4, 5]}}
  beam: {luminaire: {emission: [3, 4, 5], exponent: 3}}
  old: {color: [0.8, 0.3, 0.4], diffuse: 0.7}
  shiny: {color: 0.9, diffuse: 0.2, specular: 0.5, shininess: 20}
  mirror: {color: 0.9, diffuse: 0.2, specular: 0.5, reflect: 0.6}
  old_glass: {color: 0.9, diffuse: 0.1, transmit: 0.6, reflect: 0.2, index: 1.5}
  pure: {diffuse: 0, transmit: 0.9, index: 1.3}
  paint: {polished: {color: [0.2, 0.7, 0.3], index: 1.5}}
  satin: {polished: {color: [0.2, 0.7, 0.3], index: 1.5, exponent: 50}}
  gold: {conductor: {metal: gold}}
  glass: {dielectric: {index: 1.5, filter: [0.9, 0.8, 0.7]}}
  water: {dielectric: {index: 1.33, priority: 2}}
  sheet: {translucent: {front: 0.5, back: 0.4, through: 0.3}}
scene:
)" + lamps +
         R"(
  - {material: wall, polygon: {points: [[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]]}}
  - {material: paint, polygon: {points: [[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]]}}
  - {material: old, polygon: {points: [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]]}}
  - {material: wall, polygon: {points: [[-1,-1,-1],[-1,1,-1],[-1,1,1],[-1,-1,1]]}}
  - {material: mirror, polygon: {points: [[1,-1,-1],[1,-1,1],[1,1,1],[1,1,-1]]}}
  - {material: gold, sphere: {center: [-0.5, -0.7, -0.5], radius: 0.3}}
  - {material: glass, sphere: {center: [0.5, -0.7, -0.5], radius: 0.3}}
  - {material: water, sphere: {center: [0.5, -0.4, -0.5], radius: 0.2}}
  - {material: old_glass, sphere: {center: [0.5, -0.7, 0.3], radius: 0.25}}
  - {material: pure, sphere: {center: [0, -0.7, 0.3], radius: 0.2}}
  - {material: shiny, sphere: {center: [-0.6, 0.6, 0.3], radius: 0.2}}
  - {material: satin, sphere: {center: [0.6, 0.6, 0.3], radius: 0.2}}
  - {material: black, sphere: {center: [0, 0.6, -0.6], radius: 0.2}}
  - {material: sheet, polygon: {points: [[-0.3,-0.2,-0.9],[0.3,-0.2,-0.9],[0,0.2,-0.9]]}}
)";
}

RenderSettings settings_of(uint32_t depth) {
  RenderSettings settings;
  settings.lighting = LightingModel::path;
  settings.samples = 64;
  limit_by_depth(settings, depth);
  return settings;
}

const char* const kPoint = "{position: [0.2, 0.8, 0.1], color: [0.9, 0.8, 0.7]}";
const char* const kAllLights =
    "{position: [0.2, 0.8, 0.1]}, {direction: [0.3, -1, -0.2], color: [0.3, 0.2, 0.1]}, "
    "{position: [-0.2, 0.7, 0.1], falloff: true, intensity: 2}, "
    "{position: [0, 0.9, 0], direction: [0, -1, 0], angle: 20, dark_angle: 40, intensity: 3}";
const char* const kAllLamps = R"(
  - {material: lamp, sphere: {center: [0.3, 0.8, -0.3], radius: 0.1}}
  - {material: lamp, polygon: {points: [[-0.4,0.95,-0.2],[-0.1,0.95,-0.2],[-0.1,0.95,0.2],[-0.4,0.95,0.2],[-0.6,0.95,0]]}}
  - {material: beam, polygon: {points: [[0.4,0.95,0.2],[0.6,0.95,0.2],[0.5,0.95,0.4]]}}
  - name: moved
    transform: [{scale: [1, 0.5, 1]}, {translate: [0.6, 0.2, 0]}]
    group: [{material: lamp, sphere: {center: [0, 0, 0], radius: 0.1}}]
)";

class PathLanes : public ::testing::Test {
 protected:
  void TearDown() override { force_simd_target(""); }
};

TEST_F(PathLanes, AllMaterialsAndSourcesOnEverySimdTarget) {
  for (const std::string& target : simd_targets()) {
    force_simd_target(target);
    compare(scene_with(kPoint, ""), settings_of(9), target + ", a point light");
    compare(scene_with("", kAllLamps), settings_of(9), target + ", lamps");
    compare(scene_with(kAllLights, kAllLamps), settings_of(6), target + ", lights and lamps");
  }
}

TEST_F(PathLanes, LimitsOfReflectionsAndTransmissions) {
  RenderSettings settings = settings_of(9);
  settings.max_reflections = 2;
  settings.max_transmissions = 1;
  compare(scene_with(kAllLights, kAllLamps), settings, "few of each");
  settings.max_reflections = 0;
  compare(scene_with(kPoint, ""), settings, "no reflections");
}

TEST_F(PathLanes, OtherPatternsThanSobols) {
  RenderSettings settings = settings_of(5);
  for (const SamplingPattern pattern : {SamplingPattern::jittered, SamplingPattern::poisson}) {
    settings.sampling = pattern;
    compare(scene_with(kAllLights, kAllLamps), settings, "another pattern");
  }
}

}  // namespace
}  // namespace rayfarm
