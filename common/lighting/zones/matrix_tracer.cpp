// A node's part of the full matrix.
#include "common/lighting/zones/form_factors.h"
#include "common/lighting/zones/measured_light.h"
#include "common/lighting/zones/shooting.h"
#include "common/lighting/zones/zone_solver.h"

namespace rayfarm {
namespace {

class MatrixTracer : public ZoneTracer {
 public:
  MatrixTracer(const Scene& scene, const RenderSettings& settings, int frame)
      : settings_(settings),
        zones_(scene, settings, frame),
        sampler_({SamplingPattern::sobol, 1, settings.seed}, zones_.frame()),
        form_factors_(zones_, sampler_, settings_) {}

  void begin(std::span<const std::byte> stage_data) override {
    PackedReader in(stage_data);
    head_ = read_stage_head(in, zones_.passes());
    in.expect_end();
    if (head_.kind != ZoneStageKind::light && head_.kind != ZoneStageKind::count_hits)
      throw PackedReader::damaged();
    if (head_.kind == ZoneStageKind::light) colors_.emplace(zones_.scene(head_.pass), zones_.map());
  }

  ZoneItemResult work(uint64_t first, uint64_t count, const std::function<void()>& pulse) override {
    const bool is_light = head_.kind == ZoneStageKind::light;
    const uint64_t units =
        is_light ? zones_.map().cell_count() + zones_.media().cell_count() : zones_.map().slot_count();
    if (first > units || count > units - first) throw std::runtime_error("zones have no such units");
    ZoneItemResult result;
    if (is_light) {
      result.bytes = measure_light(zones_, zones_.scene(head_.pass), *colors_, sampler_, settings_, first,
                                   count, pulse, result.rays);
      return result;
    }
    PackedWriter out;
    for (uint64_t slot = first; slot < first + count; ++slot)
      write(out, form_factors_.trace(slot, pulse, result.rays));
    result.bytes = out.take();
    return result;
  }

 private:
  RenderSettings settings_;
  ZoneScene zones_;
  Sampler sampler_;
  FormFactorTracer form_factors_;
  std::optional<ZoneColors> colors_;  ///< of the stage's pass
  ZoneStageHead head_;
};

}  // namespace

std::unique_ptr<ZoneTracer> make_matrix_tracer(const Scene& scene, const RenderSettings& settings,
                                               int frame) {
  return std::make_unique<MatrixTracer>(scene, settings, frame);
}

}  // namespace rayfarm
