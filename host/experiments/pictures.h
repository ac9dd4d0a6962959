#pragma once
// Pictures as numbers: an experiment's scene, rendered on all cores of this process, and how pictures differ.
#include <optional>
#include <string>
#include <vector>

#include "common/compile/compile.h"
#include "common/lighting/ray_counts.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

struct FloatPicture {
  std::vector<float> values;  ///< height × width × 3, linear Rec.709, row-major, origin top left
  RayCounts counts;
};

class PicturedScene {
 public:
  /// `width_px` 0: as the scene has it; the height follows. Throws InputError for what is wrong with the
  /// file.
  PicturedScene(const std::string& path, int width_px);

  /// Of frame 0. Size, crop and pixel format are the scene's.
  FloatPicture render(RenderSettings settings) const;

 private:
  SceneDescription description_;
  CompiledScene compiled_;
  int width_px_, height_px_;
};

/// How a picture differs from another of its size, channel by channel.
struct Difference {
  double rms = 0;
  double largest = 0;
  double visible = 0;  ///< share of pixels that differ by more than 1/255 in a channel
};
Difference difference(const FloatPicture& a, const FloatPicture& b);

}  // namespace rayfarm
