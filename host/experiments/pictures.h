#pragma once
// Pictures as numbers: an experiment's scene, rendered on all cores of this process, and how pictures differ.
#include <cstddef>
#include <optional>
#include <span>
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

  const Scene& scene() const { return compiled_.scene; }
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

  /// Size, crop and pixel format are the scene's. `zones`: the light that is shown, of models with zones.
  FloatPicture render(RenderSettings settings, int frame = 0, std::span<const std::byte> zones = {}) const;

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
