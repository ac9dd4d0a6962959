#include "host/experiments/pictures.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>

#include "common/lighting/renderer.h"

namespace rayfarm {
namespace {

constexpr int kRowsAtOnce = 2;  ///< as blocks of rays are high

}  // namespace

PicturedScene::PicturedScene(const std::string& path, int width_px)
    : description_(load_scene(path)), compiled_(compile(description_)) {
  const auto [width, height] = description_.view.size_px();
  width_px_ = width_px > 0 ? width_px : width;
  height_px_ = std::max(1, width_px_ * height / width);
}

FloatPicture PicturedScene::render(RenderSettings settings, int frame,
                                   std::span<const std::byte> zones) const {
  settings.width_px = width_px_;
  settings.height_px = height_px_;
  settings.crop = {0, 0, width_px_, height_px_};
  settings.pixel_format = PixelFormat::float32;
  const size_t row_bytes = size_t{12} * static_cast<size_t>(width_px_);
  FloatPicture picture;
  picture.values.resize(row_bytes / sizeof(float) * static_cast<size_t>(height_px_));
  std::atomic<int> next_row = 0;
  std::mutex mutex;  // of `counts` and `failure`
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      Renderer renderer(compiled_.scene, settings);
      if (!zones.empty()) renderer.set_zones(frame, zones);
      RayCounts counts;
      for (int y; (y = next_row.fetch_add(kRowsAtOnce)) < height_px_;) {
        const RenderedPixels rows =
            renderer.render(frame, {0, y, width_px_, std::min(y + kRowsAtOnce, height_px_)}, [] {});
        std::memcpy(picture.values.data() + row_bytes / sizeof(float) * static_cast<size_t>(y),
                    rows.pixels.data(), rows.pixels.size());
        counts += rows.counts;
      }
      const std::lock_guard lock(mutex);
      picture.counts += counts;
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
      next_row = height_px_;
    }
  };
  std::vector<std::thread> others(std::max(1u, std::thread::hardware_concurrency()) - 1);
  for (std::thread& thread : others) thread = std::thread(work);
  work();
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
  return picture;
}

Difference difference(const FloatPicture& a, const FloatPicture& b) {
  Difference result;
  size_t visible = 0;
  for (size_t pixel = 0; pixel < a.values.size(); pixel += 3) {
    double most = 0;
    for (size_t i = pixel; i < pixel + 3; ++i) {
      const double d = double{a.values[i]} - double{b.values[i]};
      result.rms += d * d;
      most = std::max(most, std::abs(d));
    }
    result.largest = std::max(result.largest, most);
    visible += most > 1.0 / 255 ? 1 : 0;
  }
  const auto values = static_cast<double>(a.values.size());
  result.rms = std::sqrt(result.rms / values);
  result.visible = static_cast<double>(visible) * 3 / values;
  return result;
}

}  // namespace rayfarm
