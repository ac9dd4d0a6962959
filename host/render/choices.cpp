#include "host/render/choices.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/lighting/running_pixel.h"
#include "common/scene/settings_codec.h"
#include "host/process/exit_code.h"
#include "host/process/memory.h"
#include "host/render/output_pattern.h"
#include "protocol/build_identity.h"

namespace rayfarm {

std::vector<FrameNumber> choose_frames(const RenderOptions& options, const SceneDescription& scene) {
  if (!options.frames.empty()) return parse_frames(options.frames);
  const std::array<int, 2> range = scene.frames.value_or(std::array{0, 0});
  return parse_frames(has_frame_pattern(options.output) ? fmt::format("{}-{}", range[0], range[1])
                                                        : fmt::format("{}", range[0]));
}

namespace {
[[noreturn]] void fail_of_crop(const RenderOptions& options, const std::string& problem) {
  if (options.crop_place) throw InputError(*options.crop_place, "crop " + problem);
  throw JobError(kUsageError, "--crop " + problem);
}
}  // namespace

RenderSettings choose_settings(const RenderOptions& options, const SceneDescription& scene) {
  RenderSettings s = options.settings;
  const std::array<int, 2> size = options.size_px.value_or(scene.view.size_px());
  s.width_px = size[0];
  s.height_px = size[1];
  s.crop = {0, 0, s.width_px, s.height_px};
  s.fit = options.fit.value_or(Fit::width);
  if (options.crop) {
    const auto& c = *options.crop;
    s.crop = {c[0], c[2], c[1], c[3]};
    if (c[0] < 0 || c[2] < 0 || c[0] >= c[1] || c[2] >= c[3] || c[1] > s.width_px || c[3] > s.height_px)
      fail_of_crop(options,
                   fmt::format("{},{},{},{}: must lie inside the image of {}×{} pixels, with x0 < x1 "
                               "and y0 < y1",
                               c[0], c[1], c[2], c[3], s.width_px, s.height_px));
  }
  s.pixel_format = options.pixel_format.value_or(
      options.wire == Wire::pixel ? PixelFormat::rgb8 : natural_format(options.output));
  try {
    check_settings(s);  // once more: the picture's size is known
  } catch (const SettingsError& e) {
    throw JobError(kUsageError, e.what());
  }
  return s;
}

size_t running_bytes_of(const RenderSettings& settings) {
  return bytes_of_running(settings.noise > 0);
}

int choose_window(const RenderSettings& settings, size_t frames, int subpolygons, size_t other_bytes,
                  int passes) {
  constexpr int kMostFrames = 3;
  constexpr double kShare = 0.9;           // of what is free: files are written through buffers
  constexpr double kSubpolygonBytes = 64;  // of the assignment, and of who traced it
  // A pass's picture is kept until it is written, and what the next goes on from.
  const size_t layout_bytes = make_pixel_layout(settings.pixel_format).bytes,
               pixel_bytes = passes == 1 ? layout_bytes : 2 * layout_bytes + running_bytes_of(settings);
  const double frame_bytes = static_cast<double>(settings.crop.area()) * static_cast<double>(pixel_bytes) +
                             kSubpolygonBytes * subpolygons;
  const uint64_t free_bytes = available_memory_bytes();
  const auto available = static_cast<double>(free_bytes - std::min<uint64_t>(other_bytes, free_bytes));
  const double fit = kShare * available / frame_bytes;
  if (fit < 1)
    throw JobError(
        kRenderFailure,
        fmt::format("a frame of {}×{} pixels as {} in {} subpolygons takes {:.2f} GiB on the host, of which "
                    "{:.2f} GiB are free; render parts of it (--crop), or take a smaller --pixel-format or "
                    "fewer --subpolygons",
                    settings.crop.width(), settings.crop.height(), name_of(settings.pixel_format),
                    subpolygons, frame_bytes / (1 << 30), available / (1 << 30)));
  return static_cast<int>(std::min({double(kMostFrames), double(frames), fit}));
}

JobPlan make_plan(const RenderOptions& options, const RenderSettings& settings,
                  std::vector<FrameNumber> frames, int processors) {
  JobPlan plan;
  plan.build = build_identity();
  plan.policy = options.policy;
  plan.wire = options.wire;
  const PixelLayout layout = make_pixel_layout(settings.pixel_format);
  plan.compresses = options.compresses && layout.is_rgb8();
  plan.processors = processors;
  plan.settings = encode_settings(settings);
  const size_t running_bytes = options.passes > 1 ? running_bytes_of(settings) : 0;
  const size_t pixel_bytes = options.wire == Wire::pixel ? kPixelBytes : layout.bytes + running_bytes;
  const size_t most_pixels = kMostSubpolygonBytes / pixel_bytes;
  const PixelRect& crop = settings.crop;
  // Who asks for a number gets it, and a cost map is one of equal cells.
  const bool tapers = options.policy == AssignmentPolicy::on_demand && options.wire == Wire::block &&
                      options.subpolygons_per_processor == kSubpolygonsPerProcessor &&
                      options.cost_map.empty();
  const SubpolygonGrid grid =
      tapers ? make_tapering_grid(crop.x0, crop.y0, crop.width(), crop.height(), plan.processors,
                                  options.least_side(), most_pixels)
             : make_grid(crop.x0, crop.y0, crop.width(), crop.height(), plan.processors,
                         options.subpolygons_per_processor, options.least_side(), most_pixels);
  plan.pictures = {std::move(frames), grid, {}, options.passes};
  plan.sets = options.sets;
  plan.rotates = options.rotates;
  plan.ray_time_s = options.ray_time_s;
  // Who waits longer for nodes has a slower net, on which nodes wait longer for their host.
  plan.host_timeout_s = std::max(plan.host_timeout_s, options.node_timeout_s);
  plan.beat_s = liveness::beat_s(processors, options.node_timeout_s);
  plan.time_factors = options.time_factors;
  return plan;
}

}  // namespace rayfarm
