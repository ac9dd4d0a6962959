#include "common/lighting/moments.h"

#include "common/scene/animation.h"

namespace rayfarm {
namespace {

constexpr size_t kMoments = 64;  // so many that their number does not show
/// Where what changes its shape would take more memory than this, moments are halved, but not below so many.
constexpr size_t kMostShapeBytes = 16 << 20, kFewestMoments = 16;

/// While the shutter is open. By the scene alone: pictures depend on it.
size_t count_moments(const Scene& scene) {
  size_t count = kMoments;
  while (count > kFewestMoments && count * deformed_bytes(scene) > kMostShapeBytes) count /= 2;
  return count;
}

bool moves(const Scene& scene) {
  constexpr auto step = static_cast<uint32_t>(Interpolation::step);  // of what comes and goes between frames
  return std::any_of(scene.curves.begin(), scene.curves.end(), [](const CurveRecord& curve) {
    return curve.key_count > 1 && curve.interpolation != step;
  });
}

}  // namespace

bool is_blurred(const Scene& scene, const RenderSettings& settings) {
  return settings.shutter > 0 && moves(scene);
}

std::span<const Moment> Moments::at(int frame, const RenderSettings& settings) {
  const size_t count = is_blurred(scene_, settings) ? count_moments(scene_) : 1;
  while (states_.size() < count) states_.emplace_back(scene_);
  moments_.clear();
  for (size_t i = 0; i < count; ++i) {
    const double time =
        frame +
        settings.shutter * (count > 1 ? (static_cast<double>(i) + 0.5) / static_cast<double>(count) : 0);
    moments_.push_back({states_[i].at(time, frame),
                        make_camera(scene_, time, settings.width_px, settings.height_px, settings.fit)});
  }
  return moments_;
}

}  // namespace rayfarm
