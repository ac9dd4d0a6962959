#include "common/lighting/renderer.h"
#include "common/scene/scene_block.h"
#include "common/scene/settings_codec.h"
#include "node/node.h"

namespace rayfarm {
namespace {

class PictureTracer : public PhaseWorker {
 public:
  PictureTracer(const PicturesPhase& phase, const RenderSettings& settings, std::span<const std::byte> block)
      : phase_(phase), renderer_(decode_scene(block), settings) {}

  ItemResult work(ItemIndex item, const std::function<void()>& pulse) override {
    const DisplayPolygon p = phase_.polygon_of(item);
    RenderedPixels rendered =
        renderer_.render(phase_.number_of(item).value(), {p.left, p.top, p.right + 1, p.bottom + 1}, pulse);
    return {std::move(rendered.pixels), rendered.counts, rendered.eye_hits > 0, rendered.not_finite};
  }

 private:
  const PicturesPhase& phase_;
  Renderer renderer_;
};

}  // namespace

std::unique_ptr<PhaseWorker> make_scene_worker(const JobPlan& plan, const Phase& phase,
                                               std::span<const std::byte> scene) {
  return std::make_unique<PictureTracer>(std::get<PicturesPhase>(phase), decode_settings(plan.settings),
                                         scene);
}

}  // namespace rayfarm
