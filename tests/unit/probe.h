#pragma once
// What a lighting model sees along one ray of a small scene.
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
    settings.max_depth = 1000;
  }
  Color mean(const Vec3& origin, const Vec3& direction, uint32_t samples) {
    settings.samples = samples;
    const SamplingTables tables(settings, 0);
    const FrameContext context{compiled.scene, pose, tables};
    const std::unique_ptr<Integrator> integrator = make_integrator(settings.lighting);
    const Ray ray{origin, normalized(direction)};
    const std::array<Ray, kMostPacketRays> rays{ray, ray, ray, ray, ray, ray, ray, ray};
    Color sum(0);
    for (uint32_t sample = 0; sample < samples; sample += kMostPacketRays) {
      const size_t n = std::min<size_t>(kMostPacketRays, samples - sample);
      std::array<SampleId, kMostPacketRays> ids;
      for (size_t i = 0; i < n; ++i) ids[i] = {3, 7, sample + static_cast<uint32_t>(i)};
      std::array<Color, kMostPacketRays> colors;
      integrator->trace(context, std::span(rays).first(n), std::span(ids).first(n), counts, colors.data());
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

}  // namespace rayfarm
