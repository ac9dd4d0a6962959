#include "host/experiments/lighting/lighting_runs.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/errors/input_error.h"
#include "common/image/image_file.h"
#include "host/experiments/page.h"
#include "host/farm/job_result.h"
#include "host/files/json.h"

namespace rayfarm {

void sample_corners(RenderSettings& settings, uint32_t side) {
  settings.sampling = SamplingPattern::corners;
  settings.subpixels = {side, side};
}

void gather_diffuse_light(RenderSettings& settings, uint32_t rays) {
  settings.lighting = LightingModel::thesis;
  settings.diffuse_rays = rays;
  settings.min_weight = kTrimmedWeight / rays;
}

void lay_out_as_in_thesis(RenderSettings& settings) {
  settings.diffuse_bands = DiffuseBands::cone;
  settings.diffuse_set = DiffuseSet::fixed;
}

LightingRuns::LightingRuns(const ExperimentOptions& options, const RunRender& render)
    : width_px_(options.width_px),
      scenes_(options.scenes),
      render_(render),
      folder_(options.output),
      scratch_(folder_ / "scratch") {
  make_page_folder(scratch_.string());
}

LightingRuns::~LightingRuns() {
  std::error_code ignored;
  std::filesystem::remove_all(scratch_, ignored);
}

std::string LightingRuns::scene(const std::string& name) const {
  return (std::filesystem::path(scenes_) / name).string();
}

RenderOptions LightingRuns::job(const std::string& scene, int width_px, int height_px) const {
  RenderOptions job;
  job.scene = scene;
  const int width = width_px_ > 0 ? width_px_ : width_px;
  job.size_px = {width, std::max(1, width * height_px / width_px)};
  job.is_quiet = true;
  return job;
}

Outcome LightingRuns::run(RenderOptions job, const std::filesystem::path& output) const {
  job.output = output.string();
  if (extension_of(job.output) == ".exr") job.pixel_format = PixelFormat::float32;
  job.stats = scratch("stats.json").string();
  render_or_throw(render_, job);
  const JsonView json = JsonView::read_file(job.stats);
  Outcome outcome;
  outcome.rays = read_ray_counts(json);
  outcome.trace_s = json.at("time_s").at("trace").number();
  return outcome;
}

std::vector<float> read_channels(const std::filesystem::path& file) {
  ImageReader reader(file.string(), uint64_t{65536} * 65536);
  std::vector<float> channels;
  for (int y = 0; y < reader.height_px(); ++y) {
    const std::span<const float> row = reader.next_row();
    channels.insert(channels.end(), row.begin(), row.end());
  }
  return channels;
}

double display_level(float linear) {
  return 255 * encode_srgb(std::clamp(static_cast<double>(linear), 0.0, 1.0));
}

double mean_level(const std::vector<float>& channels) {
  double sum = 0;
  for (const float v : channels) sum += display_level(v);
  return sum / static_cast<double>(channels.size());
}

ScreenDifference screen_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double squares = 0;
  size_t visible = 0;
  for (size_t i = 0; i + 2 < a.size(); i += 3) {
    double most = 0;
    for (size_t c = i; c < i + 3; ++c) {
      const double d = static_cast<double>(a[c]) - static_cast<double>(b[c]);
      squares += d * d;
      most = std::max(most, std::abs(display_level(a[c]) - display_level(b[c])));
    }
    visible += most > 2 ? 1 : 0;
  }
  const auto channels = static_cast<double>(a.size());
  return {std::sqrt(squares / channels), 3 * static_cast<double>(visible) / channels};
}

}  // namespace rayfarm
