#include "host/experiments/zones/zone_costs.h"

#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "common/errors/input_error.h"
#include "host/experiments/lighting/lighting_runs.h"
#include "host/experiments/page.h"
#include "host/experiments/renders.h"

namespace rayfarm {
namespace {

constexpr double kAskedNoise = 0.01;  ///< RMS of pixels over the mean
constexpr double kReferenceSamples = 4096, kWalkReferenceSamples = 2048;
constexpr int kFrames = 24;
constexpr const char* kScene = "goral_room.yaml";
constexpr double kOwnSide_px = 512;  ///< of the scene's own pictures

/// What a picture takes.
struct PictureCost {
  double samples = 0, error = 0, cpu_s = 0, rays = 0;
};

PictureCost cost_of(const PicturedScene& scene, const PathReference* reference,
                    const RenderSettings& settings, std::span<const std::byte> zones, int frame = 0) {
  const double before = cpu_time();
  const FloatPicture picture = scene.render(settings, frame, zones);
  PictureCost cost{static_cast<double>(settings.samples), 0, cpu_time() - before,
                   static_cast<double>(picture.counts.total())};
  if (reference) cost.error = picture_error(scene, picture, *reference).pixels;
  return cost;
}

/// What a picture takes that has the noise asked for: along a straight line between logarithms, of the two
/// points about it or, beyond all, of the last two. Nothing if errors do not fall to it.
std::optional<PictureCost> at_asked_noise(const std::vector<PictureCost>& points) {
  for (size_t i = 1; i < points.size(); ++i) {
    const PictureCost &a = points[i - 1], &b = points[i];
    if (b.error > kAskedNoise && i + 1 < points.size()) continue;
    const double fall = std::log(b.error / a.error), part = std::log(kAskedNoise / a.error) / fall;
    if (!(fall < -0.1) || part > 3) return std::nullopt;
    const auto along = [&](double from, double to) { return from * std::pow(to / from, part); };
    return PictureCost{along(a.samples, b.samples), kAskedNoise, along(a.cpu_s, b.cpu_s),
                       along(a.rays, b.rays)};
  }
  return std::nullopt;
}

/// A way to make pictures, and its zones if it has any.
struct CostOfWay {
  std::string name;
  RenderSettings settings;
  std::vector<std::byte> zones;
  double solve_cpu_s = 0, solve_rays = 0;
  std::vector<PictureCost> points;
  std::optional<PictureCost> at_noise;
};

CostOfWay measure_way(const PicturedScene& scene, const PathReference& reference, const std::string& name,
                      RenderSettings settings, const std::vector<uint32_t>& samples) {
  CostOfWay way{name, settings, {}, 0, 0, {}, {}};
  if (has_zones(settings.lighting)) {
    SolvedZoneLight solved = solve_zone_light(scene.scene(), settings);
    way.zones = std::move(solved.bytes);
    way.solve_cpu_s = solved.cpu_s;
    way.solve_rays = static_cast<double>(solved.rays.total());
  }
  for (const uint32_t count : samples) {
    settings.samples = count;
    way.points.push_back(cost_of(scene, &reference, settings, way.zones));
  }
  way.at_noise = at_asked_noise(way.points);
  return way;
}

std::vector<uint32_t> samples_of(const ZoneWork& work, const std::vector<double>& counts) {
  std::vector<uint32_t> samples;
  for (const double count : counts)
    if (const uint32_t n = work.samples(count); samples.empty() || n > samples.back()) samples.push_back(n);
  return samples;
}

std::vector<CostOfWay> measure_ways(const ZoneWork& work, const PicturedScene& scene,
                                    const PathReference& reference) {
  std::vector<CostOfWay> ways;
  ways.push_back(measure_way(scene, reference, "path", zone_experiment_settings(LightingModel::path, 1),
                             samples_of(work, {16, 64, 256, 512})));
  struct Zones {
    const char* name;
    double size, rays;  ///< 0: as a render does without a word
  };
  for (const auto& [name, size, rays] :
       {Zones{"usual zones", 0, 0}, Zones{"zones 0.1 wide, 300,000 rays", 0.1, 3e5},
        Zones{"zones 0.1 wide, 1 million rays", 0.1, 1e6}, Zones{"zones 0.1 wide, 3 million rays", 0.1, 3e6},
        Zones{"zones 0.2 wide, 100,000 rays", 0.2, 1e5}})
    for (const ZoneView view : {ZoneView::gather, ZoneView::direct}) {
      RenderSettings settings = zone_experiment_settings(LightingModel::zonal, 1);
      if (size > 0) settings.zones.size = work.size(size);
      settings.zones.rays = work.rays(rays > 0 ? rays : settings.zones.rays);
      settings.zones.view = view;
      ways.push_back(measure_way(
          scene, reference, fmt::format("{}, {}", kZoneViewWords[static_cast<size_t>(view)], name), settings,
          samples_of(work, view == ZoneView::gather ? std::vector<double>{16, 64, 128}
                                                    : std::vector<double>{4, 16, 64})));
    }
  for (const uint32_t gather_rays : {2u, 4u, 8u}) {
    RenderSettings settings = zone_experiment_settings(LightingModel::zonal, 1);
    settings.zones.size = work.size(0.2);
    settings.zones.rays = work.rays(1e5);
    settings.zones.view = ZoneView::gather;
    settings.zones.gather_rays = gather_rays;
    ways.push_back(measure_way(
        scene, reference, fmt::format("gather, {} rays a point, zones 0.2 wide, 100,000 rays", gather_rays),
        settings, samples_of(work, {64.0 / gather_rays, 128.0 / gather_rays, 256.0 / gather_rays})));
  }
  return ways;
}

/// The cheapest way of a view whose pictures come to the noise asked for, for so many pictures; null: none.
const CostOfWay* cheapest(const std::vector<CostOfWay>& ways, ZoneView view, double pictures) {
  const CostOfWay* best = nullptr;
  const auto cost = [&](const CostOfWay& way) { return way.solve_cpu_s + pictures * way.at_noise->cpu_s; };
  for (const CostOfWay& way : ways)
    if (has_zones(way.settings.lighting) && way.settings.zones.view == view && way.at_noise &&
        (!best || cost(way) < cost(*best)))
      best = &way;
  return best;
}

/// The room seen on a walk into it.
std::string walk_text(const ZoneWork& work) {
  std::ifstream in(work.path_of(kScene));
  std::ostringstream out;
  bool is_found = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("view:")) {
      is_found = true;
      line =
          "frames: [1, 24]\n"
          "view: {location: {1: [0, 0, 4.2], 12: [-0.5, 0.2, 3.4], 24: [0.4, 0.1, 2.4]}, "
          "look_at: {1: [0, 0, 0], 24: [-0.3, -0.2, -1]}, field_of_view: 38, aspect: 1, resolution: [512, "
          "512]}";
    }
    out << line << '\n';
  }
  if (!is_found) throw IoError(fmt::format("{}: has no line that begins with 'view:'", work.path_of(kScene)));
  return out.str();
}

/// Where the difference comes from.
std::string samples_text(const ZoneWork& work, const CostOfWay& path, const CostOfWay& zones) {
  const double pixels = double(work.width_px()) * work.width_px();
  const auto of = [&](const CostOfWay& way) {
    const PictureCost& at = *way.at_noise;
    return fmt::format("{:.0f} samples of {:.1f} rays and {:.0f} ns", at.samples,
                       at.rays / (pixels * at.samples), 1e9 * at.cpu_s / (pixels * at.samples));
  };
  return fmt::format("\nA pixel of `path` takes {}, one of {} takes {}: {:.1f} times less in pictures.\n",
                     of(path), zones.name, of(zones), path.at_noise->cpu_s / zones.at_noise->cpu_s);
}

void compare_pictures(const ZoneWork& work, const std::vector<CostOfWay>& ways,
                      const PathReference& reference, ZoneStudy& study) {
  Table points{"noise over samples", {"way", "samples", "pixels_rms", "cpu_s", "rays"}, {}};
  Table costs{"cost at 1 % noise",
              {"way", "solve_cpu_s", "samples", "picture_cpu_s", "rays", "times_less_cpu", "at_512_x_512",
               "times_fewer_rays"},
              {}};
  const CostOfWay& path = ways[0];
  const double own = kOwnSide_px * kOwnSide_px / (double(work.width_px()) * work.width_px());
  for (const CostOfWay& way : ways) {
    std::string& data = study.data["costs.dat"];
    data += fmt::format("\"{}\"\n", way.name);
    for (const PictureCost& point : way.points) {
      points.rows.push_back({way.name, point.samples, point.error, point.cpu_s, point.rays});
      data += fmt::format("{} {} {}\n", way.solve_cpu_s + point.cpu_s, point.error, point.samples);
    }
    data += "\n\n";
    if (!way.at_noise) {
      costs.rows.push_back({way.name, way.solve_cpu_s, std::string("not reached"), std::string(),
                            std::string(), std::string(), std::string(), std::string()});
      continue;
    }
    const PictureCost& at = *way.at_noise;
    const auto ratio = [&](double pixels) {
      return path.at_noise ? pixels * path.at_noise->cpu_s / (way.solve_cpu_s + pixels * at.cpu_s) : 0;
    };
    costs.rows.push_back({way.name, way.solve_cpu_s, at.samples, at.cpu_s, way.solve_rays + at.rays, ratio(1),
                          ratio(own), path.at_noise ? path.at_noise->rays / (way.solve_rays + at.rays) : 0});
  }
  study.section =
      fmt::format(
          "\n## Costs against paths at equal noise\n\n"
          "Goral's room, {0} × {0} pixels. Noise is the RMS error of pixels over the mean, against "
          "`path` with {1} samples a pixel, whose own is {2}; what zones get wrong is part of it. "
          "The samples that {3} takes lie on a line between logarithms of the two measured points "
          "about it, or beyond the last two. CPU seconds include the light of zones, once; at {4} × "
          "{4} pixels, the scene's own size, pictures take {5:.0f} times as much, and the light of "
          "zones the same.\n\n",
          work.width_px(), 2 * (work.samples(kReferenceSamples) / 2), percent(reference.pixel_noise),
          percent(kAskedNoise), kOwnSide_px, own) +
      markdown(costs) + "\nMeasured:\n\n" + markdown(points) + "\n![noise over CPU seconds](costs.svg)\n";
  study.tables.push_back(std::move(points));
  study.tables.push_back(std::move(costs));
  for (const ZoneView view : {ZoneView::gather, ZoneView::direct}) {
    const CostOfWay* const best = cheapest(ways, view, 1);
    const bool is_known = best && path.at_noise;
    const double ratio = is_known ? path.at_noise->cpu_s / (best->solve_cpu_s + best->at_noise->cpu_s) : 0;
    study.checks.push_back({fmt::format("Goral's room at {} noise, `{}` against `path`", percent(kAskedNoise),
                                        kZoneViewWords[static_cast<size_t>(view)]),
                            "a quarter of the CPU, or less",
                            is_known ? fmt::format("1/{:.1f} ({})", ratio, best->name) : "not reached",
                            ratio >= 4});
    if (is_known) study.section += samples_text(work, path, *best);
  }
}

/// Twenty-four frames, with the samples that the first takes.
void compare_walks(const ZoneWork& work, const std::vector<CostOfWay>& ways, ZoneStudy& study) {
  const CostOfWay& path = ways[0];
  if (!path.at_noise) return;
  constexpr uint32_t kShare = 4;  // of the samples that a frame takes, time is measured with
  const PicturedScene scene = work.scene_of(walk_text(work));
  Table table{
      "walk",
      {"way", "solve_cpu_s", "samples", "frames_cpu_s", "times_less_cpu", "noise_1", "noise_12", "noise_24"},
      {}};
  constexpr int kJudged[] = {1, 12, 24};
  std::vector<PathReference> references;
  for (const int frame : kJudged)
    references.push_back(make_path_reference(scene, work.samples(kWalkReferenceSamples), frame));
  double of_paths = 0;
  for (const CostOfWay* way :
       {&path, cheapest(ways, ZoneView::gather, kFrames), cheapest(ways, ZoneView::direct, kFrames)}) {
    if (!way) continue;
    const bool is_path = way == &path;
    tell_zones(fmt::format("a walk, {}", way->name));
    RenderSettings settings = way->settings;
    settings.samples = std::max(1u, static_cast<uint32_t>(std::ceil(way->at_noise->samples)));
    table.rows.push_back({way->name, way->solve_cpu_s, double(settings.samples), 0.0, 0.0, 0.0, 0.0, 0.0});
    auto& row = table.rows.back();
    for (size_t i = 0; i < std::size(kJudged); ++i)
      row[5 + i] = cost_of(scene, &references[i], settings, way->zones, kJudged[i]).error;
    double frames_s = 0;
    if (is_path) settings.samples = std::max(1u, settings.samples / kShare);
    for (int frame = 1; frame <= kFrames; ++frame)
      frames_s += cost_of(scene, nullptr, settings, way->zones, frame).cpu_s;
    if (is_path) {
      frames_s *= std::ceil(way->at_noise->samples) / settings.samples;
      of_paths = frames_s;
    }
    const double ratio = of_paths / (way->solve_cpu_s + frames_s);
    row[3] = frames_s;
    row[4] = ratio;
    if (is_path) continue;
    study.checks.push_back({fmt::format("a walk of {} frames, `{}` against `path`", kFrames,
                                        kZoneViewWords[static_cast<size_t>(way->settings.zones.view)]),
                            "a twentieth of the CPU, or less", fmt::format("1/{:.1f} ({})", ratio, way->name),
                            ratio >= 20});
  }
  study.section +=
      fmt::format(
          "\n### A walk\n\n"
          "{} frames in one light, which is found once; the camera goes into the room. All have the "
          "samples that the first takes for {} noise, and the noise of three frames is measured "
          "(references of {} samples, their own noise {} to {}). The frames of `path` are timed "
          "with a quarter of the samples, times four.\n\n",
          kFrames, percent(kAskedNoise), 2 * (work.samples(kWalkReferenceSamples) / 2),
          percent(references[0].pixel_noise), percent(references[2].pixel_noise)) +
      markdown(table);
  study.section +=
      "\nHowever much frames share, a walk by `gather` gains no more than a picture does without the light "
      "of "
      "zones: each sample has an eye ray, a shadow ray and rays that read zones. With one of these, rays "
      "take "
      "36 % of the time to find what they meet, reading zones takes 19 %, and 11 % go into steps of eight "
      "paths at once (`perf record build/rayfarm render scenes/goral_room.yaml -o x.exr --lighting zonal "
      "--zone-view gather --samples 64 --local-nodes 1 --zones x.zones`, the second time). What they gather "
      "is most of the noise, so that several to a sample (`--gather-rays`) save eye rays and shadow rays, "
      "until there are too few samples for what these see. The view `direct` has next to no noise but what "
      "zones get wrong, so that a walk pays for zones that are good enough.\n";
  study.tables.push_back(std::move(table));
}

void compare_thesis(const ZoneWork& work, const RunRender& render, const std::vector<CostOfWay>& ways,
                    ZoneStudy& study) {
  constexpr int kRuns = 3;
  constexpr uint32_t kSide = 4;
  constexpr int kTimesWider = 4;  // so that setting up a picture does not show
  constexpr double kTimesMorePixels = kTimesWider * kTimesWider;
  Table table{"models of the thesis", {"model", "rays", "cpu_s", "rays_ratio", "time_ratio"}, {}};
  const auto add = [&](const std::string& name, double rays, double cpu_s) {
    const double rays0 = table.rows.empty() ? rays : std::get<double>(table.rows[0][1]),
                 cpu0 = table.rows.empty() ? cpu_s : std::get<double>(table.rows[0][2]);
    table.rows.push_back({name, rays, cpu_s, rays / rays0, cpu_s / cpu0});
  };
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis}) {
    RenderSettings settings;
    settings.lighting = model;
    sample_corners(settings, kSide);
    if (model == LightingModel::thesis) {
      gather_diffuse_light(settings, 1);
      lay_out_as_in_thesis(settings);
    }
    double rays = 0, cpu_s = INFINITY;
    for (int run = 0; run < kRuns; ++run) {
      RenderOptions job;
      job.scene = work.path_of(kScene);
      job.output = work.scratch("thesis.png").string();
      job.stats = work.scratch("thesis.json").string();
      job.size_px = {kTimesWider * work.width_px(), kTimesWider * work.width_px()};
      job.settings = settings;
      job.local_nodes = 1;
      job.is_quiet = true;
      render_or_throw(render, job);
      const JsonView stats = JsonView::read_file(job.stats);
      rays = static_cast<double>(read_ray_counts(stats).total());
      cpu_s = std::min(cpu_s, stats.at("nodes").elements()[0].at("busy_s").number());
    }
    add(model == LightingModel::whitted ? "Whitted's, corners 4x4"
                                        : "the thesis's, corners 4x4, 25 directions",
        rays / kTimesMorePixels, cpu_s / kTimesMorePixels);
  }
  for (const CostOfWay& way : ways)
    if (way.at_noise)
      add(fmt::format("{}, {} noise", way.name, percent(kAskedNoise)), way.solve_rays + way.at_noise->rays,
          way.solve_cpu_s + way.at_noise->cpu_s);
  const double ratio = std::get<double>(table.rows[1][4]);
  study.checks.push_back(
      {"the thesis's model, time beside Whitted's", "twice",
       fmt::format("{:.2f} times, {:.2f} times the rays", ratio, std::get<double>(table.rows[1][3])),
       ratio > 1.5 && ratio < 3});
  study.section +=
      "\n### Beside the thesis's model\n\nThe same room as Plates 3.1a and 3.1b have it, rays through "
      "the corners of 4 × 4 subpixels, measured at four times the width and told for a picture as wide as "
      "the others (the light of ambient terms is not that of paths, so these two "
      "have no noise to compare):\n\n" +
      markdown(table);
  study.tables.push_back(std::move(table));
}

}  // namespace

ZoneStudy study_zone_costs(const ZoneWork& work, const RunRender& render) {
  tell_zones("costs at equal noise");
  ZoneStudy study;
  const PicturedScene scene = work.scene(kScene);
  const PathReference reference = make_path_reference(scene, work.samples(kReferenceSamples));
  const std::vector<CostOfWay> ways = measure_ways(work, scene, reference);
  compare_pictures(work, ways, reference, study);
  compare_thesis(work, render, ways, study);
  compare_walks(work, ways, study);
  return study;
}

}  // namespace rayfarm
