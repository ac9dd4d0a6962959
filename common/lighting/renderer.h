#pragma once
// Pixels of a rectangle of the image: the renderer as a node calls it.
#include <functional>
#include <optional>
#include <vector>

#include "common/lighting/coloured_scene.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/media.h"
#include "common/lighting/moments.h"
#include "common/lighting/render_pass.h"
#include "common/lighting/small_objects.h"
#include "common/lighting/zones/zone_light.h"
#include "common/sampling/pixel_filter.h"

namespace rayfarm {

struct RenderedPixels {
  /// As make_pixel_layout(settings.pixel_format) lays them out: height × width, row-major, origin top left.
  std::vector<std::byte> pixels;
  /// Rays that belong to this rectangle. What is traced for neighbours too (in corner sampling the corners on
  /// the border, in adaptive sampling the first samples beyond it) is counted once, so that the counts of a
  /// frame do not depend on how it was cut.
  RayCounts counts;
  uint64_t eye_hits = 0;    ///< eye rays that met an object, counted in the same way
  uint64_t not_finite = 0;  ///< pixels with a channel that is infinite or no number
  /// What the next pass goes on from; empty after the last.
  std::vector<std::byte> running;
};

/// Renders rectangles of a scene's frames, in any order, with one set of settings.
class Renderer {
 public:
  /// What `scene` looks at must outlive the renderer.
  Renderer(const Scene& scene, const RenderSettings& settings);
  Renderer(const Renderer&) = delete;

  /// What zones hold in this frame and all of its pose, for lighting models that have them. Throws
  /// std::runtime_error if the bytes are damaged, or of other zones; and as ZoneMap.
  void set_zones(int frame, std::span<const std::byte> solution);

  /// `pulse` is called between rays, often; what it throws ends the work. Throws std::domain_error if the
  /// frame has no such view or pose, std::runtime_error if the pass goes on from something else. Corner
  /// sampling and adaptive sampling have one pass.
  RenderedPixels render(int frame, const PixelRect& rect, const std::function<void()>& pulse,
                        const RenderPass& pass = {});

 private:
  class Rendering;
  void set_frame(int frame);

  Scene scene_;
  RenderSettings settings_;
  std::vector<ColouredScene> passes_;
  std::unique_ptr<Integrator> integrator_;
  PixelFilter filter_;
  Moments moments_;
  std::vector<LightPower> powers_;  ///< of the lights, if any come and go
  std::unique_ptr<ZoneScene> zone_scene_;
  std::vector<ZoneLight> zones_;  ///< of each pass

  // Of the current frame.
  std::optional<int> frame_;
  std::optional<SamplingTables> tables_;
  std::span<const Moment> now_;
  std::vector<SmallObject> small_objects_;
  std::optional<EyeItems> eye_items_;
  std::optional<LightItems> light_items_;
  std::vector<Media> eye_media_;  ///< by moment, where rays have to know what they are in
};

}  // namespace rayfarm
