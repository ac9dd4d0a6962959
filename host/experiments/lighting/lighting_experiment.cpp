#include "host/experiments/lighting/lighting_experiment.h"

#include <fmt/ranges.h>

#include <filesystem>

#include "host/experiments/page.h"
#include "host/farm/job_result.h"
#include "host/files/json.h"
#include "host/files/text_file.h"
#include "host/render/render_options.h"

namespace rayfarm {
namespace {

/// Where the lighting trees of the thesis's model are trimmed: so that what a diffuse ray meets sends out no
/// further diffuse rays, as the times and ray counts that the thesis gives imply.
constexpr double kTrimmedWeight = 0.41;

/// One picture. Those of a plate are compared with its first.
struct Picture {
  const char* name;
  const char* plate;
  const char* scene;
  LightingModel lighting;
  uint32_t samples;
  int width_px, height_px;  ///< as in the thesis
  const char* thesis;       ///< what it says of the picture
};

const Picture kPictures[] = {
    {"plate_3_1a", "3.1", "goral_room.yaml", LightingModel::whitted, 16, 512, 512,
     "Whitted's model; side walls smoothly shaded, no bleeding"},
    {"plate_3_1b", "3.1", "goral_room.yaml", LightingModel::thesis, 16, 512, 512,
     "brighter in the back, colour bleeds at all corners; twice the computing time of 3.1a"},
    {"plate_3_2a", "3.2", "blocks.yaml", LightingModel::whitted, 16, 512, 512,
     "fronts are constant: a washed-out appearance"},
    {"plate_3_2b", "3.2", "blocks.yaml", LightingModel::thesis, 16, 512, 512,
     "fronts brighter near the bottom; the centre block tinted red on the right, green on the left"},
    {"plate_3_3a", "3.3", "diffuse_room.yaml", LightingModel::whitted, 1, 512, 384,
     "no bleeding, a regular shadow under the glass ball"},
    {"plate_3_3b", "3.3", "diffuse_room.yaml", LightingModel::thesis, 1, 512, 384,
     "oversampling of one: diffuse light appears as multiple reflections"},
    {"plate_3_4a", "3.4", "diffuse_room.yaml", LightingModel::thesis, 4, 512, 384,
     "oversampling of four: errors very pronounced"},
    {"plate_3_4b", "3.4", "diffuse_room.yaml", LightingModel::thesis, 16, 512, 384,
     "oversampling of sixteen, over 10 million rays: corners smooth, errors elsewhere"},
    {"plate_3_5a", "3.5", "diffuse_room_lamp.yaml", LightingModel::thesis, 4, 512, 384,
     "spherical light, four: spots before the mirror, and spots that count the light twice"},
    {"plate_3_5b", "3.5", "diffuse_room_lamp.yaml", LightingModel::thesis, 16, 512, 384, "the same, sixteen"},
    {"reference", "3.5", "diffuse_room_lamp.yaml", LightingModel::path, 32, 512, 384,
     "(not in the thesis: the rendering equation, for comparison)"},
    {"phong", "highlights", "highlights.yaml", LightingModel::phong, 16, 640, 320, "Phong's highlights"},
    {"torrance_sparrow", "highlights", "highlights.yaml", LightingModel::torrance_sparrow, 16, 640, 320,
     "most notable improvements where light strikes at shallow angles"},
};

struct Outcome {
  RayCounts rays;
  double trace_s = 0;
};

Outcome read_outcome(const std::filesystem::path& stats) {
  const JsonView json = JsonView::read_file(stats.string());
  Outcome outcome;
  for (size_t kind = 0; kind < kRayKinds; ++kind)
    outcome.rays.by_kind[kind] = json.at("rays").at(kRayKindNames[kind]).count();
  outcome.trace_s = json.at("time_s").at("trace").number();
  return outcome;
}

}  // namespace

int run_lighting_experiment(const ExperimentOptions& options, const RunRender& render) {
  const std::filesystem::path folder = make_page_folder(options.output);
  std::string csv =
      "picture,plate,scene,samples,primary,shadow,reflected,transmitted,diffuse,rays,rays_ratio,trace_s,time_"
      "ratio\n";
  std::string page =
      "# Lighting: the pictures of the thesis's chapter 3\n\nWritten by `rayfarm experiment lighting`. "
      "Ratios are to "
      "the plate's first picture; times are of this machine, and mean something only as ratios. The thesis's "
      "model trims its "
      "lighting trees at a weight of 0.41: diffuse rays spawn no others.\n\n"
      "| picture | scene, samples | rays | ratio | trace | ratio | the thesis "
      "|\n|---|---|---:|---:|---:|---:|---|\n";
  std::string pictures;
  const char* plate = "";
  Outcome first;
  for (const Picture& picture : kPictures) {
    RenderOptions job;
    job.scene = (std::filesystem::path(options.scenes) / picture.scene).string();
    job.output = (folder / fmt::format("{}.png", picture.name)).string();
    job.stats = (folder / fmt::format("{}.json", picture.name)).string();
    job.settings.lighting = picture.lighting;
    job.settings.samples = picture.samples;
    if (picture.lighting == LightingModel::thesis) job.settings.min_weight = kTrimmedWeight;
    if (picture.lighting == LightingModel::path) limit_by_depth(job.settings, kPathDepth);
    const int width = options.width_px > 0 ? options.width_px : picture.width_px;
    job.size_px = {width, std::max(1, width * picture.height_px / picture.width_px)};
    job.is_quiet = true;
    if (const int code = render(job); code != 0) return code;
    const Outcome outcome = read_outcome(job.stats);
    if (std::string_view(plate) != picture.plate) first = outcome;
    plate = picture.plate;
    const auto rays = outcome.rays.total();
    const double rays_ratio =
        static_cast<double>(rays) / static_cast<double>(std::max<uint64_t>(1, first.rays.total()));
    const double time_ratio = first.trace_s > 0 ? outcome.trace_s / first.trace_s : 0;
    csv += fmt::format("{},{},{},{},{},{},{:.3f},{:.4f},{:.3f}\n", picture.name, picture.plate, picture.scene,
                       picture.samples, fmt::join(outcome.rays.by_kind, ","), rays, rays_ratio,
                       outcome.trace_s, time_ratio);
    page += fmt::format("| {} | {}, {} | {:.2f} M | {:.2f} | {:.2f} s | {:.2f} | {} |\n", picture.name,
                        picture.scene, picture.samples, 1e-6 * static_cast<double>(rays), rays_ratio,
                        outcome.trace_s, time_ratio, picture.thesis);
    pictures += fmt::format("![{0}]({0}.png) ", picture.name);
  }
  write_text_file((folder / "lighting.csv").string(), csv);
  write_text_file((folder / "README.md").string(), page + "\n" + pictures + "\n");
  fmt::print("{}\n", (folder / "README.md").string());
  return 0;
}

}  // namespace rayfarm
