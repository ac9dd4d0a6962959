#include "host/experiments/colour/colour_experiment.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "common/compile/compile.h"
#include "common/errors/input_error.h"
#include "common/lighting/coloured_scene.h"
#include "host/experiments/colour/colour_difference.h"
#include "host/experiments/colour/colour_page.h"
#include "host/experiments/colour/linear_colour.h"
#include "host/experiments/page.h"
#include "host/experiments/renders.h"
#include "host/files/json.h"
#include "host/render/render_options.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

constexpr size_t kReferenceNodes = 200;
constexpr int kRuns = 3;  ///< of which the fastest counts; the reference has one

// Random choices are the same in all colour models: no ray chooses by the colours of what it meets, and no
// path ends by chance.
const ColourPicture kScenes[] = {
    {"chart", LightingModel::whitted, 16, 5, 240, 160,
     "paints with edges and notches under a fluorescent lamp"},
    {"glasses", LightingModel::path, 9, 4, 240, 120,
     "measured metals and filters of glass under an incandescent lamp"},
    {"prism", LightingModel::whitted, 4, 5, 240, 120, "dispersion: white bars through flint and diamond"},
};

const ColourChoice kModels[] = {{"rgb", ColourModel::rgb},
                                {"meyer4", ColourModel::meyer4},
                                {"spectral20", ColourModel::spectral20},
                                {"spectral", ColourModel::spectral},
                                {"spectral:200", ColourModel::spectral, true}};

PictureDifference difference(std::span<const Vec3> a, std::span<const Vec3> b) {
  std::vector<double> all;
  PictureDifference result;
  for (size_t i = 0; i < a.size(); ++i) {
    all.push_back(ciede2000(a[i], b[i]));
    result.mean += all.back() / static_cast<double>(a.size());
    result.share_over_1 += (all.back() > 1 ? 1.0 : 0.0) / static_cast<double>(a.size());
  }
  std::sort(all.begin(), all.end());
  result.largest = all.back();
  result.most_of_95 = all[static_cast<size_t>(0.95 * static_cast<double>(all.size() - 1))];
  return result;
}

std::vector<Vec3> read_looks(const std::string& path) {
  ImageReader reader(path, 1 << 24);
  std::vector<Vec3> looks;
  for (int y = 0; y < reader.height_px(); ++y) {
    const std::span<const float> row = reader.next_row();
    for (size_t i = 0; i < row.size(); i += 3) {
      const Color rgb(row[i], row[i + 1], row[i + 2]);
      looks.push_back(lab_of(glm::clamp(rgb, Color(0), Color(1))));
    }
  }
  return looks;
}

/// Seconds of one call of `work`, which is called often.
template <typename Work>
double time_of(Work work) {
  constexpr int kCalls = 20'000;
  double best = 1e9;
  for (int run = 0; run < kRuns; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kCalls; ++i) work(static_cast<size_t>(i));
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    best = std::min(best, taken.count() / kCalls);
  }
  return best;
}

/// With the scene's own colours: those that are spectra, or if it has none those that RGB colours have.
ColourCost measure_cost(const Scene& scene) {
  std::vector<LinearColour> colours;
  for (const SpectralColor& c : scene.spectral_colors) {
    const auto nodes = scene.spectrum_of(c);
    colours.emplace_back(nodes.begin(), nodes.end());
  }
  if (colours.empty()) {
    LinearColour band;
    for (const double nm : kBandCorners_nm) band.push_back({nm, nm / 700});
    colours.assign(3, band);
  }
  std::vector<Color> rgb;
  for (const LinearColour& c : colours) rgb.push_back(rgb_of(c));
  const size_t n = colours.size();
  ColourCost cost;
  volatile double sink = 0;  // so that no work is left out
  cost.list_s = time_of([&](size_t i) {
    const LinearColour sum = colours[i % n] * colours[(i + 1) % n] + colours[i % n] * colours[(i + 2) % n];
    cost.nodes = static_cast<double>(sum.size());
    sink = sum.back().value;
  });
  cost.rgb_s =
      time_of([&](size_t i) { sink = (rgb[i % n] * rgb[(i + 1) % n] + rgb[i % n] * rgb[(i + 2) % n]).x; });
  double nodes = 0;
  for (size_t i = 0; i < n; ++i)
    nodes +=
        static_cast<double>((colours[i] * colours[(i + 1) % n] + colours[i] * colours[(i + 2) % n]).size());
  cost.nodes = nodes / static_cast<double>(n);
  return cost;
}

class ColourExperiment {
 public:
  ColourExperiment(const ExperimentOptions& options, const RunRender& render)
      : options_(options), render_(render), folder_(options.output) {}

  std::vector<ColourScene> run() {
    std::vector<ColourScene> outcomes;
    for (const ColourPicture& picture : kScenes) {
      ColourScene outcome;
      outcome.picture = &picture;
      const CompiledScene compiled = compile(load_scene(scene_of(picture)));
      for (const ColourChoice& choice : kModels)
        outcome.models.push_back(measure(picture, choice, compiled.scene));
      for (ColourOutcome& model : outcome.models)
        model.from_reference = difference(model.looks, outcome.models.back().looks);
      outcome.from_20_to_4 = difference(outcome.models[1].looks, outcome.models[2].looks);
      outcome.cost = measure_cost(compiled.scene);
      outcomes.push_back(std::move(outcome));
    }
    return outcomes;
  }

 private:
  std::string scene_of(const ColourPicture& picture) const {
    return (fs::path(options_.scenes) / fmt::format("{}.yaml", picture.name)).string();
  }

  ColourOutcome measure(const ColourPicture& picture, const ColourChoice& choice, const Scene& scene) const {
    RenderOptions job;
    job.scene = scene_of(picture);
    const fs::path file =
        folder_ / fmt::format("{}_{}", picture.name, choice.is_reference ? "reference" : choice.name);
    job.stats = file.string() + ".json";
    job.settings.lighting = picture.lighting;
    job.settings.samples = picture.samples;
    limit_by_depth(job.settings, picture.max_depth);
    job.settings.colour = choice.model;
    if (choice.is_reference) job.settings.colour_nodes_nm = even_nodes(kReferenceNodes);
    const int width = options_.width_px > 0 ? options_.width_px : picture.width_px;
    job.size_px = {width, std::max(1, width * picture.height_px / picture.width_px)};
    job.local_nodes = 1;  // so that times are a processor's
    job.is_quiet = true;
    fmt::print(stderr, "colour: {} in {}\n", picture.name, choice.name);
    ColourOutcome outcome;
    outcome.choice = &choice;
    outcome.nodes = colour_nodes(scene, job.settings).size();
    outcome.passes = make_coloured_scenes(scene, job.settings).size();
    const std::string exr = file.string() + ".exr", png = file.string() + ".png";
    outcome.trace_s = 1e9;
    for (int run = 0; run < (choice.is_reference ? 1 : kRuns); ++run) {
      job.output = exr;
      job.pixel_format = PixelFormat::float32;
      render_or_throw(render_, job);
      const JsonView stats = JsonView::read_file(job.stats);
      outcome.trace_s = std::min(outcome.trace_s, stats.at("time_s").at("trace").number());
      outcome.rays = static_cast<double>(read_ray_counts(stats).total());
    }
    outcome.looks = read_looks(exr);
    write_shown(exr, png);
    fs::remove(exr);
    fs::remove(job.stats);
    return outcome;
  }

  /// The same pixels as a screen shows them.
  static void write_shown(const std::string& exr, const std::string& png) {
    ImageReader reader(exr, 1 << 24);
    const int w = reader.width_px(), h = reader.height_px();
    Image image{w, h, {0, 0, w, h}, make_pixel_layout(PixelFormat::rgb8), {}};
    for (int y = 0; y < h; ++y)
      for (const float value : reader.next_row())
        image.pixels.push_back(static_cast<std::byte>(encode_srgb8(static_cast<double>(value))));
    write_image(png, image, {});
  }

  const ExperimentOptions& options_;
  const RunRender& render_;
  fs::path folder_;
};

}  // namespace

int run_colour_experiment(const ExperimentOptions& options, const RunRender& render) {
  const fs::path folder = make_page_folder(options.output);
  try {
    const std::vector<ColourScene> scenes = ColourExperiment(options, render).run();
    write_colour_page(folder, scenes);
  } catch (const RenderFailed& failed) {
    return failed.code;
  }
  fmt::print("{}\n", (folder / "README.md").string());
  return 0;
}

}  // namespace rayfarm
