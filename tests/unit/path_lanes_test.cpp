// Paths that take their steps in lanes are those that are followed one by one, to the last bit, on every SIMD
// target.
#include <numbers>
#include <random>

#include "tests/unit/probe.h"
#include "tests/unit/simd_targets.h"

namespace rayfarm {
namespace {

struct Traced {
  std::array<Color, kMostPacketRays> colors;
  size_t eye_hits;
};

/// Below it is a point that all tests can name: eyes that stand here look straight down.
constexpr Vec3 kKnownPlace(0.25, 0, 0.125);

/// Traces packets of all sizes from points within a room both ways.
void compare(const std::string& scene, const RenderSettings& settings, const std::string& what) {
  SCOPED_TRACE(what);
  Probe probe(scene);
  const SamplingTables tables(settings, 2);
  const FrameContext context{probe.compiled.scene, probe.pose, tables, 0, 0.001};
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
      if (i == 0 && round % 8 == 0)
        rays.push_back(kKnownPlace, Vec3(0, -1, 0));
      else
        rays.push_back(origin, normalized(towards + 0.3 * Vec3(real(random), real(random), real(random))));
      ids.push_back({round, static_cast<int>(i), static_cast<uint32_t>(random() % settings.samples)});
    }
    const Traced found = trace(*in_lanes, rays, ids, counts_in_lanes),
                 expected = trace(*one_by_one, rays, ids, counts_one_by_one);
    ASSERT_EQ(found.eye_hits, expected.eye_hits);
    for (size_t i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c)
        ASSERT_TRUE(test::same_bits(found.colors[i][c], expected.colors[i][c]))
            << "round " << round << ", ray " << i << ", channel " << c << ": " << found.colors[i][c]
            << " and " << expected.colors[i][c];
  }
  for (const RayKind kind :
       {RayKind::primary, RayKind::shadow, RayKind::reflected, RayKind::transmitted, RayKind::diffuse})
    EXPECT_EQ(counts_in_lanes[kind], counts_one_by_one[kind]);
  EXPECT_EQ(counts_in_lanes[RayKind::shadow] > 0,
            settings.max_reflections > 0 && !probe.compiled.scene.lights.empty());
}

constexpr const char* kBackground = "background: [0.1, 0.2, 0.3]\n";

/// All kinds of materials, in a room that is open at one side. `things` stand in it, too: lamps and others;
/// `behind` tells what rays see that leave it, and what else the scene's head holds.
std::string scene_with(const std::string& lights, const std::string& things,
                       const std::string& behind = kBackground, const std::string& materials = "") {
  return behind + "lights: [" + lights + "]\nmaterials:\n" + materials + R"(
  wall: {lambertian: [0.8, 0.5, 0.4]}
  black: {lambertian: 0}
  lamp: {luminaire: {emission: [3, 4, 5]}}
  beam: {luminaire: {emission: [3, 4, 5], exponent: 3}}
  inward: {luminaire: {color: 0.3, emission: [0.3, 0.4, 0.5], inward: true}}
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
  tea: {dielectric: {index: 1.2, filter: [0.5, 0.3, 1], priority: 1}}
  polish: {polished: {color: [0.2, 0.7, 0.3], index: 1.5}, reflections: specular}
  unreflecting: {color: [0.8, 0.3, 0.4], diffuse: 0.4, reflect: 0.4, reflections: false}
  sheet: {translucent: {front: 0.5, back: 0.4, through: 0.3}}
scene:
)" + things +
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

/// Triangles about (x, y, z) whose normals lean so far that those of some hits look away from the viewer.
std::string smooth_mesh(const char* material, double x, double y, double z) {
  return fmt::format(
      "  - {{transform: {{translate: [{}, {}, {}]}}, group: [{{material: {}, triangles: "
      "{{points: [[-0.2, 0, -0.2], [0.2, 0.1, -0.2], [0.2, -0.1, 0.2], [-0.2, 0.1, 0.2]], "
      "triangles: [[0, 2, 1], [0, 3, 2]], normals: [[-3, 1, 0], [1, 1, 2], [0.1, 1, 0], [0, 1, 3]]}}}}]}}\n",
      x, y, z, material);
}

/// A lamp of more corners than a step in lanes takes the triangles of.
std::string round_lamp(int corners) {
  std::string points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points += fmt::format("{}[{}, 0.9, {}]", i ? ", " : "", 0.3 * std::cos(angle), 0.3 * std::sin(angle));
  }
  return "  - {material: lamp, polygon: {points: [" + points + "]}}\n";
}

TEST(PathLanes, AllMaterialsAndSources) {
  test::on_every_target([] {
    compare(scene_with(kPoint, ""), settings_of(9), "a point light");
    compare(scene_with("", kAllLamps), settings_of(9), "lamps");
    compare(scene_with(kAllLights, kAllLamps), settings_of(6), "lights and lamps");
    compare(scene_with("", ""), settings_of(6), "nothing but the background");
  });
}

TEST(PathLanes, SmoothNormals) {
  std::string meshes;
  double x = -0.6;
  for (const char* material : {"wall", "old", "mirror", "old_glass", "paint", "gold", "tea"})
    meshes += smooth_mesh(material, x, x * x - 0.5, 0.1), x += 0.18;
  test::on_every_target(
      [&] { compare(scene_with(kAllLights, kAllLamps + meshes), settings_of(6), "smooth meshes"); });
}

TEST(PathLanes, LampsOfAllShapes) {
  test::on_every_target([] {
    for (const auto& [what, lamps] : std::vector<std::pair<const char*, std::string>>{
             {"a polygon that shines inward",
              "  - {material: inward, polygon: {points: [[-0.5,0.9,-0.5],[-0.5,0.9,0.5],[0.5,0.9,0.5],"
              "[0.5,0.9,-0.5]]}}\n"},
             {"a sphere that shines inward",
              "  - {material: inward, sphere: {center: [0,0,0], radius: 3}}\n"},
             {"a sphere that shines outward, about what is dark",
              "  - {material: lamp, sphere: {center: [0.2,-0.4,0], radius: 0.7}}\n"},
             {"eight triangles, and more", round_lamp(10) + round_lamp(11)},
             {"concave",
              "  - {material: lamp, polygon: {points: [[-0.5,0.9,-0.5],[0.5,0.9,-0.5],[0,0.9,0],"
              "[0.5,0.9,0.5],[-0.5,0.9,0.5]]}}\n"}})
      compare(scene_with("", lamps), settings_of(5), what);
  });
}

TEST(PathLanes, PhotometricLights) {
  const std::string file = test::write_temporary(
      "lamp.ies", "TILT=NONE\n1 1000 1 3 2 1 2 0 0 0\n1 1 100\n0 45 90\n0 90\n90 30 0\n90 60 0\n");
  const std::string light = "{position: [0.3, 0.7, 0], ies: " + file + ", color: 0.02}",
                    material = "  shaped: {luminaire: {emission: 3, ies: " + file + "}}\n";
  const char* const lamp = "  - {material: shaped, sphere: {center: [-0.4, 0.7, 0], radius: 0.1}}\n";
  test::on_every_target(
      [&] { compare(scene_with(light, lamp, kBackground, material), settings_of(5), "photometric files"); });
}

TEST(PathLanes, EnvironmentsOutside) {
  const std::string sky = test::write_environment(16, 8, [](int x, int y) {
    return x == 12 && y == 3 ? 40.0f : 0.2f + 0.1f * static_cast<float>(x % 3);
  });
  const std::string behind = "environment: {file: " + sky + ", turn: 30}\n";
  test::on_every_target([&] {
    compare(scene_with("", "", behind), settings_of(6), "alone");
    compare(scene_with(kAllLights, kAllLamps, behind), settings_of(5), "with others");
  });
}

TEST(PathLanes, Textures) {
  const std::string head = std::string(kBackground) +
                           "textures:\n  tiles: {kind: checker, first: 0, second: 1, scale: 0.13}\n"
                           "  lumps: {kind: noise, scale: 0.2}\n";
  const char* const materials = R"(
  tiled: {lambertian: 0.8, texture: tiles}
  beaten: {conductor: gold, bump: {texture: lumps, height: 0.05}}
  cloudy: {color: 0.9, diffuse: 0.4, reflect: 0.5, texture: lumps}
  foil: {lambertian: 0.5}
  partly: {mix: {a: foil, b: tiled, by: lumps}}
)";
  const char* const things = R"(
  - {material: tiled, sphere: {center: [-0.2, 0.3, 0], radius: 0.2}}
  - {material: beaten, sphere: {center: [0.3, 0.3, 0], radius: 0.2}}
  - {material: cloudy, sphere: {center: [0, -0.1, 0.5], radius: 0.2}}
  - {material: partly, sphere: {center: [-0.4, -0.2, 0.4], radius: 0.2}}
)";
  test::on_every_target([&] {
    compare(scene_with(kAllLights, std::string(kAllLamps) + things, head, materials), settings_of(5),
            "textures");
  });
}

TEST(PathLanes, MediaWithAllMaterialsInside) {
  const char* const things = R"(
  - {material: tea, sphere: {center: [0, -0.3, 0], radius: 0.9}}
  - {material: polish, sphere: {center: [0.2, 0.1, 0.2], radius: 0.15}}
  - {material: unreflecting, sphere: {center: [-0.3, 0.1, 0.2], radius: 0.15}}
  - {material: glass, sphere: {center: [0, 0.4, 0.3], radius: 0.3}}
)";
  test::on_every_target([&] {
    compare(scene_with(kAllLights, std::string(kAllLamps) + things), settings_of(9), "a ball of tea");
  });
}

TEST(PathLanes, MediaThatScatterBetweenSurfaces) {
  const std::string head =
      std::string(kBackground) +
      "media:\n"
      "  - {box: {min: [-1, -1, -1], max: [0, 1, 1]}, scattering: [0.3, 0.6, 0.9], g: 0.7}\n"
      "  - {box: {min: [0, -1, -1], max: [2, 1, 0.5]}, absorption: [0.2, 0.4, 0]}\n";
  const char* const things = R"(
  - {material: tea, sphere: {center: [0, -0.3, 0], radius: 0.6}}
  - {material: glass, sphere: {center: [0, 0.4, 0.3], radius: 0.3}}
)";
  test::on_every_target([&] {
    RenderSettings settings = settings_of(9);
    compare(scene_with(kAllLights, std::string(kAllLamps) + things, head), settings, "fog");
    settings.max_reflections = 3;
    compare(scene_with(kAllLights, std::string(kAllLamps) + things, head), settings,
            "fog, and few reflections");
  });
}

// Its direction is 0 long, and no number of the lanes beside it changes.
TEST(PathLanes, ALightThatStandsOnASurface) {
  const std::string floor =
      "  - {material: wall, polygon: {points: "
      "[[-0.5,-0.5,-0.5],[-0.5,-0.5,0.5],[0.5,-0.5,0.5],[0.5,-0.5,-0.5]]}}\n";
  const std::string light = fmt::format("{{position: [{}, -0.5, {}]", kKnownPlace.x, kKnownPlace.z);
  test::on_every_target([&] {
    compare(scene_with(light + "}", floor), settings_of(4), "a point");
    compare(scene_with(light + ", falloff: true}", floor), settings_of(4), "a bulb");
  });
}

TEST(PathLanes, LimitsOfReflectionsAndTransmissions) {
  test::on_every_target([] {
    RenderSettings settings = settings_of(9);
    settings.max_reflections = 2;
    settings.max_transmissions = 1;
    compare(scene_with(kAllLights, kAllLamps), settings, "few of each");
    settings.max_reflections = 0;
    compare(scene_with(kPoint, ""), settings, "no reflections");
  });
}

TEST(PathLanes, RaysThatKnowWhatTheyAreIn) {
  test::on_every_target([] {
    RenderSettings settings = settings_of(7);
    settings.self_hit = SelfHit::medium;
    compare(scene_with(kAllLights, kAllLamps), settings, "no bound on rounding");
  });
}

TEST(PathLanes, OtherPatternsThanSobols) {
  test::on_every_target([] {
    RenderSettings settings = settings_of(5);
    for (const SamplingPattern pattern : {SamplingPattern::jittered, SamplingPattern::poisson}) {
      settings.sampling = pattern;
      compare(scene_with(kAllLights, kAllLamps), settings, "another pattern");
    }
  });
}

}  // namespace
}  // namespace rayfarm
