#pragma once
// What moves, at the moments of a frame while the shutter is open (Cook, Porter, Carpenter 1984).
#include <deque>

#include "common/hierarchy/frame_state.h"
#include "common/scene/camera.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

struct Moment {
  Pose pose;
  Camera camera;
};

/// True if something moves while the shutter is open, so that a frame has several moments.
bool is_blurred(const Scene& scene, const RenderSettings& settings);

/// Which of `moments` a sample belongs to that stands at `place` of [0, samples): rounding may have made it
/// `samples`.
inline size_t moment_index(size_t moments, double place, uint32_t samples) {
  return std::min(moments - 1, static_cast<size_t>(place / samples * static_cast<double>(moments)));
}

class Moments {
 public:
  explicit Moments(const Scene& scene) : scene_(scene) {}

  /// The moments of `frame`, evenly spread from `frame` to `frame + shutter`; one if the shutter only blinks
  /// or nothing moves.
  /// Valid until the next call. Throws std::domain_error if there is no such view or pose.
  std::span<const Moment> at(int frame, const RenderSettings& settings);

 private:
  Scene scene_;
  std::deque<FrameState> states_;
  std::vector<Moment> moments_;
};

}  // namespace rayfarm
