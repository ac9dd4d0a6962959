#pragma once
// Pixels of a rectangle of the image: the renderer as a node calls it.
#include <functional>
#include <vector>

#include "common/lighting/coloured_scene.h"
#include "common/lighting/lighting_tree.h"
#include "common/lighting/moments.h"

namespace rayfarm {

struct RenderedPixels {
  std::vector<std::byte> pixels;  ///< height × width × bytes_per_pixel, row-major, origin top left
  /// Rays that belong to this rectangle. In corner sampling a corner on the border is traced for both
  /// neighbours but counted once, so that the counts of a frame do not depend on how it was cut.
  RayCounts counts;
};

/// Renders `rect` of `frame`; `scenes` are the passes of the settings' colour model,
/// `moments` what Moments::at gives. `pulse` is called
/// between rays, often; what it throws ends the work.
RenderedPixels render_rect(std::span<const ColouredScene> scenes, std::span<const Moment> moments,
                           const RenderSettings& settings, int frame, const PixelRect& rect,
                           const std::function<void()>& pulse);

}  // namespace rayfarm
