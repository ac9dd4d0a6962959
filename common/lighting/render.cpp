#include "common/lighting/render.h"

#include "common/math/inline_vector.h"
#include "common/sampling/pixel_filter.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

constexpr size_t kRaysPerPulse = 64;
// Pixels whose rays are traced together.
constexpr int kBlockWidth_px = 4, kBlockHeight_px = 2;
static_assert(kBlockWidth_px * kBlockHeight_px == kMostPacketRays);

class Pulse {
 public:
  explicit Pulse(const std::function<void()>& callback) : callback_(callback) {}
  void count_rays(size_t rays) {
    rays_ += rays;
    if (rays_ < kRaysPerPulse) return;
    rays_ = 0;
    callback_();
  }

 private:
  const std::function<void()>& callback_;
  size_t rays_ = 0;
};

/// Traces eye rays in all passes of a colour model.
class Tracer {
 public:
  Tracer(std::span<const ColouredScene> scenes, const SamplingTables& tables)
      : scenes_(scenes), tables_(tables) {}

  void trace(const Moment& moment, std::span<const Ray> rays, std::span<const SampleId> ids,
             RayCounts& counts, Color* colors) const {
    trace_eye_rays({scenes_.front().scene(), moment.pose, tables_, moment.camera.spread()}, rays, ids, counts,
                   colors);
    if (scenes_.front().pass().is_rgb) return;
    for (size_t i = 0; i < rays.size(); ++i) colors[i] = scenes_.front().pass().rgb_from_channels * colors[i];
    std::array<Color, kMostPacketRays> channels;
    for (const ColouredScene& scene : scenes_.subspan(1)) {
      trace_eye_rays({scene.scene(), moment.pose, tables_, moment.camera.spread()}, rays, ids, counts,
                     channels.data());
      for (size_t i = 0; i < rays.size(); ++i) colors[i] += scene.pass().rgb_from_channels * channels[i];
    }
  }

 private:
  std::span<const ColouredScene> scenes_;
  const SamplingTables& tables_;
};

/// The moment of a sample. All pixels of a block share it, so that their rays stay together; blocks stand
/// where they do in every picture, however it is cut.
size_t moment_of(size_t moments, const RenderSettings& settings, int frame, int block_x, int block_y,
                 uint32_t sample) {
  if (moments == 1) return 0;
  const auto r = random_pair(settings.seed, frame, {block_x, block_y, 0}, dimension::kTime);
  const uint32_t stratum = permuted(sample, settings.samples, static_cast<uint64_t>(r[1] * 0x1p53));
  return static_cast<size_t>((stratum + r[0]) / settings.samples * static_cast<double>(moments));
}

}  // namespace

RenderedPixels render_rect(std::span<const ColouredScene> scenes, std::span<const Moment> moments,
                           const RenderSettings& settings, int frame, const PixelRect& rect,
                           const std::function<void()>& callback) {
  RenderedPixels result;
  const size_t stride = bytes_per_pixel(settings.pixel_format);
  result.pixels.resize(static_cast<size_t>(rect.area()) * stride);
  std::byte* out = result.pixels.data();
  Pulse pulse(callback);
  const SamplingTables tables(settings, frame);
  const Tracer tracer(scenes, tables);
  const auto eye_ray = [&](const Camera& camera, const SampleId& id, double x, double y) {
    return camera.has_lens() ? camera.ray(x, y, sample_disk(tables.sampler.point(id, dimension::kLens)))
                             : camera.ray(x, y);
  };

  if (settings.sampling == SamplingPattern::corners) {
    // Rays through the pixels' corners, shared by the four pixels around each (thesis 2.3.2). Two rows are
    // kept.
    const auto columns = static_cast<size_t>(rect.width()) + 1;
    std::vector<Color> above(columns), below(columns);
    const auto trace_row = [&](int y, std::vector<Color>& row) {
      InlineVector<Ray, kMostPacketRays> rays;
      InlineVector<SampleId, kMostPacketRays> ids;
      for (size_t i = 0; i < columns; ++i) {
        const int x = rect.x0 + static_cast<int>(i);
        // A corner belongs to the pixel below and right of it; the image's last corners to its last pixels.
        const auto owns = [&](int column) {
          return (column < rect.x1 || column == settings.crop.x1) && (y < rect.y1 || y == settings.crop.y1);
        };
        const SampleId& id = ids.push_back({x, y, 0});
        rays.push_back(eye_ray(moments.front().camera, id, x, y));
        if (!rays.is_full() && i + 1 < columns && owns(x + 1) == owns(x)) continue;
        RayCounts repeated;
        tracer.trace(moments.front(), rays.span(), ids.span(), owns(x) ? result.counts : repeated,
                     &row[i + 1 - rays.size()]);
        pulse.count_rays(rays.size());
        rays.clear();
        ids.clear();
      }
    };
    trace_row(rect.y0, above);
    for (int y = rect.y0; y < rect.y1; ++y, above.swap(below)) {
      trace_row(y + 1, below);
      for (size_t i = 0; i + 1 < columns; ++i, out += stride)
        encode_pixel(settings.pixel_format, 0.25 * (above[i] + above[i + 1] + below[i] + below[i + 1]), out);
    }
    return result;
  }

  const PixelFilter filter(settings.filter);
  for (int y0 = rect.y0 / kBlockHeight_px * kBlockHeight_px; y0 < rect.y1; y0 += kBlockHeight_px)
    for (int x0 = rect.x0 / kBlockWidth_px * kBlockWidth_px; x0 < rect.x1; x0 += kBlockWidth_px) {
      const PixelRect block{std::max(x0, rect.x0), std::max(y0, rect.y0),
                            std::min(x0 + kBlockWidth_px, rect.x1), std::min(y0 + kBlockHeight_px, rect.y1)};
      std::array<Color, kMostPacketRays> sums, colors;
      sums.fill(Color(0));
      for (uint32_t sample = 0; sample < settings.samples; ++sample) {
        const Moment& moment = moments[moment_of(moments.size(), settings, frame, x0, y0, sample)];
        InlineVector<Ray, kMostPacketRays> rays;
        InlineVector<SampleId, kMostPacketRays> ids;
        InlineVector<double, kMostPacketRays> weights;
        for (int y = block.y0; y < block.y1; ++y)
          for (int x = block.x0; x < block.x1; ++x) {
            const SampleId& id = ids.push_back({x, y, sample});
            const PixelFilter::Place place = filter.sample(tables.sampler.point(id, dimension::kScreen));
            rays.push_back(eye_ray(moment.camera, id, x + 0.5 + place.offset.x, y + 0.5 + place.offset.y));
            weights.push_back(place.weight);
          }
        tracer.trace(moment, rays.span(), ids.span(), result.counts, colors.data());
        for (size_t i = 0; i < rays.size(); ++i) sums[i] += weights[i] * colors[i];
        pulse.count_rays(rays.size());
      }
      const Color* sum = sums.data();
      for (int y = block.y0; y < block.y1; ++y) {
        const auto first = static_cast<size_t>(y - rect.y0) * static_cast<size_t>(rect.width()) +
                           static_cast<size_t>(block.x0 - rect.x0);
        out = result.pixels.data() + first * stride;
        for (int x = block.x0; x < block.x1; ++x, out += stride)
          encode_pixel(settings.pixel_format, *sum++ / static_cast<double>(settings.samples), out);
      }
    }
  return result;
}

}  // namespace rayfarm
