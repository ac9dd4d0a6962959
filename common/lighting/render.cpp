#include "common/lighting/render.h"

#include "common/sampling/pixel_sampler.h"

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

}  // namespace

RenderedPixels render_rect(const Scene& scene, const Pose& pose, const Camera& camera,
                           const RenderSettings& settings, int frame, const PixelRect& rect,
                           const std::function<void()>& callback) {
  RenderedPixels result;
  const size_t stride = bytes_per_pixel(settings.pixel_format);
  result.pixels.resize(static_cast<size_t>(rect.area()) * stride);
  std::byte* out = result.pixels.data();
  Pulse pulse(callback);

  if (settings.sampling == SamplingPattern::corners) {
    // Rays through the pixels' corners, shared by the four pixels around each (thesis 2.3.2). Two rows are
    // kept.
    const auto columns = static_cast<size_t>(rect.width()) + 1;
    std::vector<Color> above(columns), below(columns);
    const auto trace_row = [&](int y, std::vector<Color>& row) {
      std::array<Ray, kMostPacketRays> rays;
      size_t count = 0;
      for (size_t i = 0; i < columns; ++i) {
        const int x = rect.x0 + static_cast<int>(i);
        // A corner belongs to the pixel below and right of it; the image's last corners to its last pixels.
        const auto owns = [&](int column) {
          return (column < rect.x1 || column == settings.crop.x1) && (y < rect.y1 || y == settings.crop.y1);
        };
        rays[count++] = camera.ray(x, y);
        if (count < kMostPacketRays && i + 1 < columns && owns(x + 1) == owns(x)) continue;
        RayCounts repeated;
        trace_eye_rays(scene, pose, settings, std::span(rays).first(count),
                       owns(x) ? result.counts : repeated, &row[i + 1 - count]);
        pulse.count_rays(count);
        count = 0;
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

  const Strata strata = make_strata(settings.samples);
  for (int y0 = rect.y0; y0 < rect.y1; y0 += kBlockHeight_px)
    for (int x0 = rect.x0; x0 < rect.x1; x0 += kBlockWidth_px) {
      const int width = std::min(kBlockWidth_px, rect.x1 - x0),
                height = std::min(kBlockHeight_px, rect.y1 - y0);
      const auto count = static_cast<size_t>(width * height);
      std::array<Color, kMostPacketRays> sums, colors;
      sums.fill(Color(0));
      for (uint32_t sample = 0; sample < settings.samples; ++sample) {
        std::array<Ray, kMostPacketRays> rays;
        for (size_t i = 0; i < count; ++i) {
          const int x = x0 + static_cast<int>(i) % width, y = y0 + static_cast<int>(i) / width;
          const Vec2 place = sample_place(settings, strata, frame, x, y, sample);
          rays[i] = camera.ray(x + place.x, y + place.y);
        }
        trace_eye_rays(scene, pose, settings, std::span(rays).first(count), result.counts, colors.data());
        for (size_t i = 0; i < count; ++i) sums[i] += colors[i];
        pulse.count_rays(count);
      }
      for (size_t i = 0; i < count; ++i) {
        const int x = x0 + static_cast<int>(i) % width, y = y0 + static_cast<int>(i) / width;
        const auto pixel = static_cast<size_t>(y - rect.y0) * static_cast<size_t>(rect.width()) +
                           static_cast<size_t>(x - rect.x0);
        encode_pixel(settings.pixel_format, sums[i] / static_cast<double>(settings.samples),
                     result.pixels.data() + pixel * stride);
      }
    }
  return result;
}

}  // namespace rayfarm
