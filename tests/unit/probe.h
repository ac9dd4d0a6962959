#pragma once
// What a lighting model sees along one ray of a small scene; such scenes.
#include "common/lighting/integrators/integrator.h"
#include "common/scene/camera.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {

/// The mean colour along one ray, over many samples.
struct Probe {
  explicit Probe(const std::string& text)
      : compiled(compile(test::load_yaml(test::view_text() + text))),
        frame_pose(compiled.scene),
        pose(frame_pose.at(0)) {
    settings.lighting = LightingModel::path;
    limit_by_depth(settings, kMostDepth);
  }
  Color mean(const Vec3& origin, const Vec3& direction, uint32_t samples) {
    settings.samples = samples;
    const SamplingTables tables(settings, 0);
    const FrameContext context{compiled.scene, pose, tables};
    const std::unique_ptr<Integrator> integrator = make_integrator(settings.lighting);
    const Ray ray{origin, normalized(direction)};
    Color sum(0);
    for (uint32_t sample = 0; sample < samples; sample += kMostPacketRays) {
      const size_t n = std::min<size_t>(kMostPacketRays, samples - sample);
      RayPacket rays;
      std::array<SampleId, kMostPacketRays> ids;
      for (size_t i = 0; i < n; ++i) {
        rays.push_back(ray.origin, ray.direction);
        ids[i] = {3, 7, sample + static_cast<uint32_t>(i)};
      }
      std::array<Color, kMostPacketRays> colors;
      integrator->trace(context, rays, std::span(ids).first(n), counts, colors.data());
      for (size_t i = 0; i < n; ++i) sum += colors[i];
    }
    return sum / static_cast<double>(samples);
  }
  CompiledScene compiled;
  FrameState frame_pose;
  Pose pose;
  RenderSettings settings;
  RayCounts counts;
};

inline void expect_color(const Color& a, const Color& b, double tolerance = 1e-12) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

/// A closed room of six squares that face inward, side 2, about the origin.
inline std::string room(const std::string& material) {
  std::string text;
  for (const char* points :
       {"[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]", "[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]",
        "[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]", "[-1,-1,1],[-1,1,1],[1,1,1],[1,-1,1]",
        "[-1,-1,-1],[-1,1,-1],[-1,1,1],[-1,-1,1]", "[1,-1,-1],[1,-1,1],[1,1,1],[1,1,-1]"})
    text += fmt::format("  - {{material: {}, polygon: {{points: [{}]}}}}\n", material, points);
  return text;
}

/// What stands in it, with a mirror and glass.
inline constexpr const char* kMixedRoom = R"(
ambient: [0.5, 0.6, 0.7]
background: [0.1, 0.2, 0.3]
lights: [{position: [0.5, 0.8, 0.4], color: [0.9, 0.8, 0.7]}]
materials:
  wall: {color: [0.8, 0.5, 0.4], ambient: 0.7, diffuse: 0.7}
  mirror: {color: 0.9, ambient: 0.2, diffuse: 0.2, specular: 0.5, shininess: 20, reflect: 0.6}
  glass: {color: 0.9, ambient: 0.1, diffuse: 0.1, transmit: 0.8, index: 1.5}
scene:
  - {material: mirror, sphere: {center: [-0.4, -0.5, -0.3], radius: 0.4}}
  - {material: glass, sphere: {center: [0.4, -0.5, 0.2], radius: 0.4}}
)";

}  // namespace rayfarm
