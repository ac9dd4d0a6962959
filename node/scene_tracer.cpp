#include "common/lighting/render.h"
#include "common/scene/scene_block.h"
#include "common/scene/settings_codec.h"
#include "node/node.h"

namespace rayfarm {
namespace {

class SceneTracer : public SubpolygonTracer {
 public:
  SceneTracer(const JobPlan& plan, std::span<const std::byte> block)
      : scene_(decode_scene(block)),
        settings_(decode_settings(plan.settings)),
        coloured_(make_coloured_scenes(scene_, settings_.colour)),
        moments_(scene_) {}

  Traced trace(int frame, const DisplayPolygon& polygon, const std::function<void()>& pulse) override {
    if (!has_frame_ || frame != frame_) {
      has_frame_ = false;  // stays so if the frame can't be set up
      now_ = moments_.at(frame, settings_);
      frame_ = frame;
      has_frame_ = true;
    }
    const PixelRect rect{polygon.left, polygon.top, polygon.right + 1, polygon.bottom + 1};
    RenderedPixels rendered = render_rect(coloured_, now_, settings_, frame, rect, pulse);
    const RayCounts& c = rendered.counts;
    return {std::move(rendered.pixels), {c.primary, c.shadow, c.reflected, c.transmitted, c.diffuse}};
  }

 private:
  Scene scene_;
  RenderSettings settings_;
  std::vector<ColouredScene> coloured_;
  Moments moments_;
  std::span<const Moment> now_;
  int frame_ = 0;
  bool has_frame_ = false;
};

}  // namespace

std::unique_ptr<SubpolygonTracer> make_scene_tracer(const JobPlan& plan, std::span<const std::byte> scene) {
  return std::make_unique<SceneTracer>(plan, scene);
}

}  // namespace rayfarm
