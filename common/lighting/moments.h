#pragma once
// What moves, at the moments of a frame while the shutter is open (Cook, Porter, Carpenter 1984).
#include <deque>

#include "common/hierarchy/pose.h"
#include "common/scene/camera.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

struct Moment {
  Pose pose;
  Camera camera;
};

class Moments {
 public:
  explicit Moments(const Scene& scene) : scene_(scene) {}

  /// The moments of `frame`, evenly spread from `frame` to `frame + shutter`; one if the shutter only blinks
  /// or nothing moves.
  /// Valid until the next call. Throws std::domain_error if there is no such view or pose.
  std::span<const Moment> at(int frame, const RenderSettings& settings);

 private:
  Scene scene_;
  std::deque<FramePose> poses_;
  std::vector<Moment> moments_;
};

}  // namespace rayfarm
