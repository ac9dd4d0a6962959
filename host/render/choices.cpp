#include "host/render/choices.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

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

namespace {

size_t bytes_of_picture(const RenderSettings& settings) {
  return static_cast<size_t>(settings.crop.area()) * make_pixel_layout(settings.pixel_format).bytes;
}

/// Rows of pixels that a row of subpolygons may have: small enough that several such bands are in memory, so
/// that nodes work on one while another is written.
int most_band_height(const RenderSettings& settings, size_t frame_bytes) {
  constexpr size_t kMostBandBytes = size_t{64} << 20, kLeastBands = 4;
  const size_t row_bytes =
      static_cast<size_t>(settings.crop.width()) * make_pixel_layout(settings.pixel_format).bytes;
  const size_t height = std::min(kMostBandBytes, frame_bytes / kLeastBands) / row_bytes;
  return static_cast<int>(std::clamp<size_t>(height, 1, static_cast<size_t>(settings.crop.height())));
}

}  // namespace

size_t choose_frame_bytes(const RenderOptions& options, size_t other_bytes) {
  if (options.passes > 1)
    return std::numeric_limits<size_t>::max();  // each begins with all of the one before
  // What is free also holds results that wait for their places, and buffers of files.
  constexpr uint64_t kShare = 3;
  const uint64_t free = available_memory_bytes();
  return std::min<uint64_t>(static_cast<uint64_t>(options.frame_memory_GiB * (1 << 30)),
                            (free - std::min<uint64_t>(other_bytes, free)) / kShare);
}

int choose_window(const RenderSettings& settings, const SubpolygonGrid& grid, size_t frame_bytes,
                  size_t other_bytes, int passes) {
  constexpr int kMostFrames = 3;
  constexpr double kShare = 0.9;           // of what is free: files are written through buffers
  constexpr double kSubpolygonBytes = 64;  // of the assignment, and of who traced it
  const size_t picture = bytes_of_picture(settings);
  const double of_subpolygons = kSubpolygonBytes * grid.count();
  const uint64_t free_bytes = available_memory_bytes();
  const auto available = static_cast<double>(free_bytes - std::min<uint64_t>(other_bytes, free_bytes));
  // A picture that is larger than its memory keeps two bands at least. A pass's picture is kept until it is
  // written, and what the next goes on from.
  const auto whole = static_cast<double>(picture);
  const double running =
      static_cast<double>(settings.crop.area()) * static_cast<double>(running_bytes_of(settings));
  const double pixels = picture > frame_bytes ? 2 * whole / settings.crop.height() * grid.most_row_height()
                        : passes == 1         ? whole
                                              : 2 * whole + running;
  const double least = of_subpolygons + pixels;
  if (least > kShare * available)
    throw JobError(
        kRenderFailure,
        fmt::format(
            "a frame of {}×{} pixels as {} in {} subpolygons{} takes {:.2f} GiB on the host, of which "
            "{:.2f} GiB are free; render parts of it (--crop), or take a smaller --pixel-format{}",
            settings.crop.width(), settings.crop.height(), name_of(settings.pixel_format), grid.count(),
            passes > 1 ? " and several passes" : "", least / (1 << 30), available / (1 << 30),
            passes > 1 ? ", or leave out --passes" : " or fewer --subpolygons"));
  if (passes > 1 || picture > frame_bytes) return 1;
  return static_cast<int>(std::clamp<size_t>(frame_bytes / picture, 1, kMostFrames));
}

JobPlan make_plan(const RenderOptions& options, const RenderSettings& settings,
                  std::vector<FrameNumber> frames, int processors, size_t frame_bytes) {
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
  const bool is_streamed = bytes_of_picture(settings) > frame_bytes;
  // Who asks for a number gets it, and a cost map is one of equal cells.
  const bool tapers = options.policy == AssignmentPolicy::on_demand && options.wire == Wire::block &&
                      options.subpolygons_per_processor == kSubpolygonsPerProcessor &&
                      options.cost_map.empty() && !is_streamed;
  SubpolygonGrid grid = tapers
                            ? make_tapering_grid(crop.x0, crop.y0, crop.width(), crop.height(),
                                                 plan.processors, options.least_side(), most_pixels)
                            : make_grid(crop.x0, crop.y0, crop.width(), crop.height(), plan.processors,
                                        options.subpolygons_per_processor, options.least_side(), most_pixels);
  if (is_streamed) {
    grid = with_lower_rows(grid, most_band_height(settings, frame_bytes));
    plan.policy = AssignmentPolicy::on_demand;  // nodes would not wait for the memory of theirs
  }
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
