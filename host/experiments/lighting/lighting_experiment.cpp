#include "host/experiments/lighting/lighting_experiment.h"

#include <fmt/ranges.h>

#include "host/experiments/lighting/lighting_studies.h"
#include "host/experiments/plots.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

/// How a picture is sampled: by rays through the corners of side × side subpixels, as the thesis does, or by
/// so many samples a pixel.
struct PictureSampling {
  uint32_t side = 0, samples = 1;
};
constexpr PictureSampling corners(uint32_t side) {
  return {side, 1};
}
constexpr PictureSampling samples(uint32_t count) {
  return {0, count};
}

/// One picture. Those of a plate are compared with its first.
struct Picture {
  const char* name;
  const char* plate;
  const char* scene;
  LightingModel lighting;
  PictureSampling sampling;
  uint32_t lobe_rays;       ///< of gloss
  int width_px, height_px;  ///< as in the thesis
  const char* thesis;       ///< what it says of the picture
};

const Picture kPictures[] = {
    {"plate_3_1a", "3.1", "goral_room.yaml", LightingModel::whitted, corners(4), 1, 512, 512,
     "Whitted's model; side walls smoothly shaded, no bleeding"},
    {"plate_3_1b", "3.1", "goral_room.yaml", LightingModel::thesis, corners(4), 1, 512, 512,
     "oversampled at a rate of sixteen: 25 directions a pixel; brighter in the back, colour bleeds at all "
     "corners; twice the computing time of 3.1a"},
    {"plate_3_2a", "3.2", "blocks.yaml", LightingModel::whitted, corners(4), 1, 512, 512,
     "fronts are constant: a washed-out appearance"},
    {"plate_3_2b", "3.2", "blocks.yaml", LightingModel::thesis, corners(4), 1, 512, 512,
     "over-sampled at a rate of sixteen; fronts brighter near the bottom; the centre block tinted red on the "
     "right, green on the left"},
    {"plate_3_3a", "3.3", "diffuse_room.yaml", LightingModel::whitted, corners(1), 1, 512, 384,
     "no bleeding, a regular shadow under the glass ball"},
    {"plate_3_3b", "3.3", "diffuse_room.yaml", LightingModel::thesis, corners(1), 1, 512, 384,
     "oversampling of one: \"only four different diffuse directions\" a pixel; diffuse light appears as "
     "multiple "
     "reflections"},
    {"plate_3_4a", "3.4", "diffuse_room.yaml", LightingModel::thesis, corners(2), 1, 512, 384,
     "oversampling of four: \"nine different diffuse directions\"; no longer multiple reflections, errors "
     "very "
     "pronounced"},
    {"plate_3_4b", "3.4", "diffuse_room.yaml", LightingModel::thesis, corners(4), 1, 512, 384,
     "oversampling of sixteen: \"twenty five\" directions, \"over 10 million rays\"; simple effects smoothly "
     "shaded, errors elsewhere"},
    {"plate_3_5a", "3.5", "diffuse_room_lamp.yaml", LightingModel::thesis, corners(2), 1, 512, 384,
     "spherical light, four: spots before the mirror, and spots that count the light twice"},
    {"plate_3_5b", "3.5", "diffuse_room_lamp.yaml", LightingModel::thesis, corners(4), 1, 512, 384,
     "the same, sixteen"},
    {"reference", "3.5", "diffuse_room_lamp.yaml", LightingModel::path, samples(32), 1, 512, 384,
     "(not in the thesis: the rendering equation, for comparison)"},
    {"phong", "highlights", "highlights.yaml", LightingModel::phong, samples(16), 1, 640, 320,
     "Phong's highlights"},
    {"torrance_sparrow", "highlights", "highlights.yaml", LightingModel::torrance_sparrow, samples(16), 1,
     640, 320, "most notable improvements where light strikes at shallow angles"},
    {"gloss_one", "gloss", "gloss.yaml", LightingModel::whitted, samples(16), 1, 640, 320,
     "(no plate: one ray of a lobe at each hit)"},
    {"gloss_four", "gloss", "gloss.yaml", LightingModel::whitted, samples(16), 4, 640, 320,
     "section 3.3: the technique \"can be applied to the highlights found on glossy objects\"; four rays"},
};

RenderOptions job_of(const LightingRuns& runs, const Picture& picture) {
  RenderOptions job = runs.job(runs.scene(picture.scene), picture.width_px, picture.height_px);
  RenderSettings& settings = job.settings;
  settings.lighting = picture.lighting;
  settings.samples = picture.sampling.samples;
  if (picture.sampling.side > 0) sample_corners(settings, picture.sampling.side);
  if (picture.lighting == LightingModel::thesis) {
    gather_diffuse_light(settings, 1);
    lay_out_as_in_thesis(settings);
  }
  if (picture.lighting == LightingModel::path) limit_by_depth(settings, kPathDepth);
  if (std::string_view(picture.plate) == "gloss") {
    settings.reflected_rays = settings.transmitted_rays = picture.lobe_rays;
    settings.glass_shadows = GlassShadows::transparent;
    settings.min_weight = 0.01;
    limit_by_depth(settings, 4);
  }
  return job;
}

/// "corners, 4x4" or "16 samples".
std::string name_of(const PictureSampling& sampling) {
  return sampling.side > 0 ? fmt::format("corners {0}x{0}", sampling.side)
                           : fmt::format("{} samples", sampling.samples);
}

/// The section of pictures; `csv` gets a line for each.
std::string render_pictures(const LightingRuns& runs, std::string& csv) {
  csv =
      "picture,plate,scene,sampling,directions,primary,shadow,reflected,transmitted,diffuse,rays,rays_ratio,"
      "trace_s,time_ratio\n";
  std::string section =
      "Ratios are to the plate's first picture; times are of this machine, and mean something only as "
      "ratios. The "
      "plates are made as the thesis makes them: rays go through the corners of subpixels, (a + 1)(b + 1) to "
      "a "
      "pixel, shared between neighbours (3.4.1); in its model they share out one set of as many diffuse "
      "directions, laid out once for the picture in bands of equal cones (3.3); lighting trees are trimmed "
      "at a "
      "weight of 0.41, so that diffuse rays spawn no others.\n\n"
      "| picture | scene | sampling | directions a pixel | incident rays | rays | ratio | trace | ratio | "
      "the thesis "
      "|\n|---|---|---|---:|---:|---:|---:|---:|---:|---|\n";
  std::string pictures;
  const char* plate = "";
  Outcome first;
  for (const Picture& picture : kPictures) {
    const RenderOptions job = job_of(runs, picture);
    const Outcome outcome = runs.run(job, runs.file(fmt::format("{}.png", picture.name)));
    if (std::string_view(plate) != picture.plate) first = outcome;
    plate = picture.plate;
    const auto rays = outcome.rays.total();
    const double rays_ratio =
        static_cast<double>(rays) / static_cast<double>(std::max<uint64_t>(1, first.rays.total()));
    const double time_ratio = first.trace_s > 0 ? outcome.trace_s / first.trace_s : 0;
    const uint64_t directions = diffuse_directions_of(job.settings);
    csv += fmt::format("{},{},{},{},{},{},{},{:.3f},{:.4f},{:.3f}\n", picture.name, picture.plate,
                       picture.scene, name_of(picture.sampling), directions,
                       fmt::join(outcome.rays.by_kind, ","), rays, rays_ratio, outcome.trace_s, time_ratio);
    section += fmt::format("| {} | {} | {} | {} | {} | {:.2f} M | {:.2f} | {:.2f} s | {:.2f} | {} |\n",
                           picture.name, picture.scene, name_of(picture.sampling),
                           directions > 0 ? fmt::format("{}", directions) : "",
                           outcome.rays[RayKind::primary], 1e-6 * static_cast<double>(rays), rays_ratio,
                           outcome.trace_s, time_ratio, picture.thesis);
    pictures += fmt::format("![{0}]({0}.png) ", picture.name);
  }
  section +=
      "\nOf w × h pixels of a × b subpixels (a w + 1)(b h + 1) rays are incident: 513 × 513 = 263,169 and "
      "2,049 × "
      "2,049 = 4,198,401 for 512 × 512, the thesis's \"just over a quarter million to several million\" "
      "(section "
      "4.4.4.1).\n";
  return section + "\n" + pictures + "\n";
}

const char* const kPlots = R"(# gnuplot lighting.gp
set terminal svg size 760,420 font "sans,12" background "white"
set output "error.svg"
set key right top
set grid
set logscale xy 10
set xlabel "rays"
set ylabel "RMS error, linear"
set title "Errors over rays in the diffuse test room"
plot "error.dat" index 0 using 1:2 with linespoints pt 7 lc 1 title "the thesis's directions: cones, one set", \
     "" index 1 using 1:2 with linespoints pt 5 lc 2 title "flux, sets turned"
)";

}  // namespace

int run_lighting_experiment(const ExperimentOptions& options, const RunRender& render) {
  try {
    const LightingRuns runs(options, render);
    std::string csv;
    std::string page =
        "# Lighting: the pictures of the thesis's chapter 3\n\nWritten by `rayfarm experiment lighting`. ";
    page += render_pictures(runs, csv);
    page += study_times(runs);
    const ErrorStudy errors = study_errors(runs);
    page += errors.section + study_bands(runs) + study_ball(runs);
    write_text_file(runs.file("lighting.csv").string(), csv);
    write_text_file(runs.file("error.csv").string(), errors.csv);
    write_text_file(runs.file("error.dat").string(), errors.curves);
    draw_plots(runs.file(""), "lighting.gp", kPlots);
    write_text_file(runs.file("README.md").string(), page);
    fmt::print("{}\n", runs.file("README.md").string());
    return 0;
  } catch (const RenderFailed& failed) {
    return failed.code;
  }
}

}  // namespace rayfarm
