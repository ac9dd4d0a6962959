#include "common/lighting/renderer.h"
#include "common/scene/scene_block.h"
#include "common/scene/settings_codec.h"
#include "node/node.h"

namespace rayfarm {
namespace {

class SceneTracer : public SubpolygonTracer {
 public:
  SceneTracer(const JobPlan& plan, std::span<const std::byte> block)
      : renderer_(decode_scene(block), decode_settings(plan.settings)) {}

  Traced trace(int frame, const DisplayPolygon& polygon, const std::function<void()>& pulse) override {
    const PixelRect rect{polygon.left, polygon.top, polygon.right + 1, polygon.bottom + 1};
    RenderedPixels rendered = renderer_.render(frame, rect, pulse);
    return {std::move(rendered.pixels), rendered.counts, rendered.eye_hits > 0, rendered.not_finite};
  }

 private:
  Renderer renderer_;
};

}  // namespace

std::unique_ptr<SubpolygonTracer> make_scene_tracer(const JobPlan& plan, std::span<const std::byte> scene) {
  return std::make_unique<SceneTracer>(plan, scene);
}

}  // namespace rayfarm
