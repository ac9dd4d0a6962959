#include "common/lighting/renderer.h"
#include "common/scene/scene_block.h"
#include "common/scene/settings_codec.h"
#include "node/node.h"

namespace rayfarm {
namespace {

class PictureTracer : public PictureWorker {
 public:
  PictureTracer(const RenderSettings& settings, const Scene& scene)
      : renderer_(scene, settings), has_media_(!scene.media.empty()) {}

  void set_zones(std::span<const std::byte> solution) override { zones_ = solution; }

  ItemResult work(FrameNumber frame, const DisplayPolygon& p, const RenderPass& pass,
                  const std::function<void()>& pulse) override {
    if (!zones_.empty()) renderer_.set_zones(frame.value(), zones_);
    zones_ = {};  // not before: should they fail, the next item fails, too
    RenderedPixels rendered =
        renderer_.render(frame.value(), {p.left, p.top, p.right + 1, p.bottom + 1}, pulse, pass);
    return {std::move(rendered.pixels), rendered.counts, rendered.eye_hits > 0 || has_media_,
            rendered.not_finite, std::move(rendered.running)};
  }

 private:
  Renderer renderer_;
  bool has_media_;                    ///< which eye rays may see without meeting an object
  std::span<const std::byte> zones_;  ///< of the pose of the frames to come, if that is news
};

}  // namespace

std::unique_ptr<PictureWorker> make_scene_worker(const JobPlan& plan, std::span<const std::byte> scene) {
  return std::make_unique<PictureTracer>(decode_settings(plan.settings), decode_scene(scene));
}

}  // namespace rayfarm
