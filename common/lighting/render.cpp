#include "common/lighting/render.h"

#include "common/sampling/pixel_sampler.h"

namespace rayfarm {
namespace {

constexpr uint32_t kRaysPerPulse = 64;

class Pulse {
 public:
  explicit Pulse(const std::function<void()>& callback) : callback_(callback) {}
  void count_ray() {
    if (++rays_ % kRaysPerPulse == 0) callback_();
  }

 private:
  const std::function<void()>& callback_;
  uint32_t rays_ = 0;
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
      for (size_t i = 0; i < columns; ++i) {
        const int x = rect.x0 + static_cast<int>(i);
        // A corner belongs to the pixel below and right of it; the image's last corners to its last pixels.
        const bool owned = (x < rect.x1 || x == settings.crop.x1) && (y < rect.y1 || y == settings.crop.y1);
        RayCounts repeated;
        row[i] = trace_eye_ray(scene, pose, settings, camera.ray(x, y), owned ? result.counts : repeated);
        pulse.count_ray();
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
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x, out += stride) {
      Color sum(0);
      for (uint32_t sample = 0; sample < settings.samples; ++sample) {
        const Vec2 place = sample_place(settings, strata, frame, x, y, sample);
        sum += trace_eye_ray(scene, pose, settings, camera.ray(x + place.x, y + place.y), result.counts);
        pulse.count_ray();
      }
      encode_pixel(settings.pixel_format, sum / static_cast<double>(settings.samples), out);
    }
  return result;
}

}  // namespace rayfarm
