#include "host/experiments/zones/zone_errors.h"

#include <fmt/core.h>

#include <cmath>

#include "common/lighting/zones/zone_scene.h"
#include "host/experiments/page.h"
#include "host/experiments/zones/zone_means.h"

namespace rayfarm {
namespace {

constexpr ZoneView kViews[] = {ZoneView::flat, ZoneView::smooth, ZoneView::direct, ZoneView::gather};
/// In the order of their halving; the last is about what a render chooses by itself.
constexpr double kSizes[] = {0.8, 0.4, 0.2, 0.1, 0.05};
constexpr double kRays[] = {1e4, 1e5, 1e6, 1e7};
constexpr double kRaysOfSizes = 4e6, kSizeOfRays = 0.1;
constexpr double kSamples = 64, kReferenceSamples = 1024;
constexpr double kSizeOfMeans = 0.5, kSamplesOfMeans = 32'768;

struct ZoneErrorPoint {
  double size = 0, rays = 0, zones = 0, cpu_s = 0;
  std::array<PictureError, std::size(kViews)> errors;  ///< by view
};

ZoneErrorPoint measure(const ZoneWork& work, const PicturedScene& scene, const PathReference& reference,
                       double size, double rays) {
  RenderSettings settings = zone_experiment_settings(LightingModel::zonal, work.samples(kSamples));
  settings.zones.size = work.size(size);
  settings.zones.rays = work.rays(rays);
  ZoneErrorPoint point;
  point.size = settings.zones.size;
  point.rays = static_cast<double>(settings.zones.rays);
  point.zones = static_cast<double>(ZoneScene(scene.scene(), settings, 0).map().cell_count());
  const SolvedZoneLight solved = solve_zone_light(scene.scene(), settings);
  point.cpu_s = solved.cpu_s;
  for (size_t view = 0; view < std::size(kViews); ++view) {
    settings.zones.view = kViews[view];
    point.errors[view] = picture_error(scene, scene.render(settings, 0, solved.bytes), reference);
  }
  return point;
}

/// By how much the error falls when zones are half as wide, on average over the sizes; what is within twice
/// the reference's noise tells nothing.
double fall_by_halving(const std::vector<ZoneErrorPoint>& points, size_t view, double noise) {
  size_t last = 0;
  while (last + 1 < points.size() && points[last + 1].errors[view].blocks > 2 * noise) ++last;
  if (last == 0) return 1;
  return std::pow(points[0].errors[view].blocks / points[last].errors[view].blocks,
                  1.0 / static_cast<double>(last));
}

void add_points(const std::string& name, const std::vector<ZoneErrorPoint>& points, bool is_over_size,
                ZoneStudy& study) {
  Table table{fmt::format("{}, error over {}", name, is_over_size ? "zone size" : "rays"),
              {"zone_size", "zones", "rays", "solve_cpu_s"},
              {}};
  std::string data;
  for (const ZoneView view : kViews) {
    table.columns.push_back(fmt::format("{}_blocks", kZoneViewWords[static_cast<size_t>(view)]));
    table.columns.push_back(fmt::format("{}_pixels", kZoneViewWords[static_cast<size_t>(view)]));
  }
  for (const ZoneErrorPoint& point : points) {
    table.rows.push_back({point.size, point.zones, point.rays, point.cpu_s});
    data += fmt::format("{}", is_over_size ? point.size : point.rays);
    for (const PictureError& error : point.errors) {
      table.rows.back().emplace_back(error.blocks);
      table.rows.back().emplace_back(error.pixels);
      data += fmt::format(" {}", error.blocks);
    }
    data += "\n";
  }
  study.data[is_over_size ? "error_size.dat" : "error_rays.dat"] += data + "\n\n";
  study.section += fmt::format("{}, over {}:\n\n", name, is_over_size ? "the size of zones" : "rays") +
                   markdown(table) + "\n";
  study.tables.push_back(std::move(table));
}

}  // namespace

ZoneStudy study_zone_errors(const ZoneWork& work) {
  ZoneStudy study;
  study.section = fmt::format(
      "\n## Errors against paths\n\n"
      "RMS of blocks of 16 × 16 pixels, and of pixels, over the picture's mean, against `path` with {} "
      "samples "
      "a pixel (the mean of two pictures; half of their difference is its own noise). Pictures of zones are "
      "{} pixels wide and have {} samples a pixel; over sizes {:.2g} rays carry the light of the first "
      "round, "
      "over rays zones are {:.2g} wide.\n\n",
      2 * (work.samples(kReferenceSamples) / 2), work.width_px(), work.samples(kSamples),
      double(work.rays(kRaysOfSizes)), work.size(kSizeOfRays));
  for (const auto& [name, file] :
       {std::pair{"Goral's room", "goral_room.yaml"},
        std::pair{"Goral's room, closed by a luminaire", "zones/closed_room.yaml"}}) {
    tell_zones(fmt::format("errors in {}", file));
    const PicturedScene scene = work.scene(file);
    const PathReference reference = make_path_reference(scene, work.samples(kReferenceSamples));
    std::vector<ZoneErrorPoint> over_size, over_rays;
    for (const double size : kSizes) over_size.push_back(measure(work, scene, reference, size, kRaysOfSizes));
    for (const double rays : kRays) over_rays.push_back(measure(work, scene, reference, kSizeOfRays, rays));
    study.section += fmt::format("### {} (`{}`)\n\nThe reference's own noise: blocks {}, pixels {}.\n\n",
                                 name, file, percent(reference.block_noise), percent(reference.pixel_noise));
    add_points(name, over_size, true, study);
    add_points(name, over_rays, false, study);

    RenderSettings settings = zone_experiment_settings(LightingModel::zonal, 1);
    settings.zones.size = kSizeOfMeans;
    settings.zones.rays = work.rays(kRaysOfSizes);
    settings.zones.samples = work.samples(4096);
    const MeansOfZones means = compare_zone_means(scene.scene(), settings, work.rays(kSamplesOfMeans));
    study.checks.push_back({fmt::format("{}: means of {} zones {:.2g} wide", name, means.zones, kSizeOfMeans),
                            "1 % RMS of `path`",
                            fmt::format("{} (noise of `path` {})", percent(means.rms), percent(means.noise)),
                            means.rms <= 0.01});
    const ZoneErrorPoint& finest = over_size.back();
    for (const auto& [view, most] : {std::pair{1, 0.05}, std::pair{3, 0.02}}) {
      const double error = finest.errors[static_cast<size_t>(view)].blocks;
      study.checks.push_back({fmt::format("{}: `{}`, blocks, zones {:.2g} wide", name,
                                          kZoneViewWords[static_cast<size_t>(view)], finest.size),
                              fmt::format("{} of `path`", percent(most)), percent(error), error <= most});
    }
    for (const size_t view : {size_t{0}, size_t{1}}) {
      const double fall = fall_by_halving(over_size, view, reference.block_noise);
      study.checks.push_back({fmt::format("{}: `{}`, zones half as wide", name, kZoneViewWords[view]),
                              "error a half", fmt::format("1/{:.2f}", fall), fall >= 1.9});
    }
  }
  study.section += "![errors over the size of zones](error_size.svg) ![errors over rays](error_rays.svg)\n";
  return study;
}

}  // namespace rayfarm
