#include "host/experiments/lighting/lighting_studies.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>

#include "common/errors/input_error.h"
#include "common/image/image_file.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

constexpr int kWidth_px = 512, kHeight_px = 384;  // of Plates 3.3 to 3.5

double total(const Outcome& outcome) {
  return static_cast<double>(outcome.rays.total());
}

/// The mean of a picture's channels, as its file holds them.
double mean(const std::filesystem::path& file) {
  const std::vector<float> channels = read_channels(file);
  return std::accumulate(channels.begin(), channels.end(), 0.0) / static_cast<double>(channels.size());
}

}  // namespace

ErrorStudy study_errors(const LightingRuns& runs) {
  constexpr uint32_t kReferenceRays = 32;
  struct Point {
    uint32_t side, rays;
  };
  constexpr Point kPoints[] = {{1, 1}, {2, 1}, {4, 1}, {4, 2}, {4, 4}, {4, 8}, {4, 16}};
  ErrorStudy study;
  ScreenDifference most_rays;  // the thesis's last point
  double rays_of_most = 0;
  study.csv = "directions,subpixels,diffuse_rays,directions_per_pixel,rays,rms,visible\n";
  study.section =
      "\n## Errors over rays\n\n"
      "Section 3.5.1: two diffuse rays for each incident ray test fifty directions a pixel, and \"the "
      "sampling "
      "errors should begin to disappear completely before 100 million rays are traced, but no such test "
      "image "
      "was rendered\". Here they are. An error is the difference from what the same directions tend to: 4x4 "
      "subpixels with 32 diffuse rays at each hit, in sets that are turned by other random numbers. So 1x1 "
      "and 2x2 count the edges that they sample coarsely, too. RMS is of linear values, in thousandths; "
      "visibly off are pixels that a screen shows more than two levels of 255 away.\n\n"
      "| directions | subpixels | diffuse rays a hit | directions a pixel | rays | RMS error | visibly off "
      "|\n|---|---|---:|---:|---:|---:|---:|\n";
  for (const bool is_thesis : {true, false}) {
    RenderOptions job = runs.job(runs.scene("diffuse_room.yaml"), kWidth_px, kHeight_px);
    RenderSettings& settings = job.settings;
    const auto lay_out = [&](const Point& point) {
      settings = RenderSettings();
      sample_corners(settings, point.side);
      gather_diffuse_light(settings, point.rays);
      if (is_thesis) lay_out_as_in_thesis(settings);
    };
    lay_out({4, kReferenceRays});
    settings.diffuse_set = DiffuseSet::turned;
    settings.seed = 1;
    const auto reference_file = runs.scratch("reference.exr"), file = runs.scratch("picture.exr");
    runs.run(job, reference_file);
    const std::vector<float> reference = read_channels(reference_file);
    for (const Point& point : kPoints) {
      lay_out(point);
      const Outcome outcome = runs.run(job, file);
      const ScreenDifference error = screen_difference(read_channels(file), reference);
      if (is_thesis) {
        most_rays = error;
        rays_of_most = total(outcome);
      }
      const uint32_t directions = point.rays * settings.subpixels.corners();
      study.section += fmt::format("| {} | {}x{} | {} | {} | {:.2f} M | {:.2f} | {:.1f} % |\n",
                                   is_thesis ? "the thesis's: cones, one set" : "flux, sets turned",
                                   point.side, point.side, point.rays, directions, 1e-6 * total(outcome),
                                   1e3 * error.rms, 100 * error.visible);
      study.csv +=
          fmt::format("{},{}x{},{},{},{},{:.6f},{:.4f}\n", is_thesis ? "thesis" : "turned", point.side,
                      point.side, point.rays, directions, outcome.rays.total(), error.rms, error.visible);
      study.curves += fmt::format("{} {}\n", outcome.rays.total(), error.rms);
    }
    study.curves += "\n\n";
  }
  study.section += fmt::format(
      "\nWith the thesis's directions {:.1f} % of the pixels are visibly off at {:.0f} million rays. One set "
      "for the "
      "whole picture has the smaller errors, but they are edges, which the eye finds; turned sets turn them "
      "into "
      "noise. Turned sets of 16 rays a hit are no better than of 8: their 400 directions stand 24 to a band, "
      "so that "
      "every 25th of them, which is what goes out from one ray through a corner, stand nearly above each "
      "other. "
      "12 and 20 rays a hit leave two thirds of that error (`--diffuse-rays 12 --subpixels 4x4`).\n\n"
      "![errors over rays](error.svg)\n",
      100 * most_rays.visible, 1e-6 * rays_of_most);
  return study;
}

std::string study_ball(const LightingRuns& runs) {
  const std::string lamp = runs.scene("diffuse_room_lamp.yaml");
  std::ostringstream alone;
  bool is_found = false;
  std::ifstream in(lamp);
  for (std::string line; std::getline(in, line);) {
    // The same ball as a quadric, which no shadow rays are sent to.
    if (line.find("name: lamp") != std::string::npos) {
      is_found = true;
      line =
          "  - {name: lamp, material: lamp, quadric: {coefficients: [1, 1, 1, 0, 0, 0, -12, 1, -22, "
          "628.91]}}";
    }
    alone << line << '\n';
  }
  if (!is_found) throw IoError(fmt::format("{}: has no line with 'name: lamp', the ball of light", lamp));
  const std::string ball_alone = runs.file("ball_alone.yaml").string();
  write_text_file(ball_alone, alone.str());

  const auto render = [&](const std::string& scene, uint32_t rays, uint64_t seed, bool is_thesis,
                          const std::filesystem::path& file) {
    RenderOptions job = runs.job(scene, kWidth_px, kHeight_px);
    sample_corners(job.settings, 4);
    gather_diffuse_light(job.settings, rays);
    if (is_thesis) lay_out_as_in_thesis(job.settings);
    job.settings.seed = seed;
    return runs.run(job, file);
  };
  const auto with = runs.scratch("with.png"), without = runs.file("ball_alone.png"),
             many = runs.scratch("many.png"), one = runs.scratch("one.exr"),
             other = runs.scratch("other.exr");
  render(lamp, 1, 0, true, with);
  render(ball_alone, 1, 0, true, without);
  const Outcome of_many = render(ball_alone, 16, 0, false, many);
  const Outcome of_one = render(ball_alone, 1, 1, false, one);
  render(ball_alone, 1, 2, false, other);
  const double noise = screen_difference(read_channels(one), read_channels(other)).rms / std::sqrt(2.0);
  const double needed = total(of_one) * (noise * 255) * (noise * 255);
  return fmt::format(
      "\n## The ball of light without its cosine term\n\n"
      "Of the ball of light around the point the thesis says: \"The cosine function could be eliminated so "
      "that "
      "there would be only one contribution, but an unreasonable number of diffuse rays would be required to "
      "obtain a smoothly shaded image (billions). Experiments with this technique using an oversampling rate "
      "of sixteen resulted in very dark images.\" The cosine is that of the first term of Equation 3.6a, "
      "which "
      "shadow rays bring. In `diffuse_room_lamp.yaml` they do, and diffuse rays that meet the ball bring "
      "nothing, so that it is counted once (the thesis counts it twice, hence its spots). In "
      "`ball_alone.yaml`, which this experiment writes, the same ball is a quadric: no shadow rays go there, "
      "and diffuse rays alone find it.\n\n"
      "| picture, 4x4 subpixels | rays | mean level of 255 on a screen |\n|---|---:|---:|\n"
      "| with the cosine term | | {:.1f} |\n"
      "| without, one set of 25 directions | {:.2f} M | {:.1f} |\n"
      "| without, 400 directions a pixel | {:.1f} M | {:.1f} |\n\n"
      "The light is all there, but in few pixels, each far too bright for a screen; the others are black. "
      "Pixels scatter by {:.2f} (linear, from two renders with other random numbers), and scatter falls with "
      "the root of the rays: one level of 255 takes {:.1e} rays, more than the thesis's billions.\n\n"
      "![without the cosine term](ball_alone.png)\n",
      255 * mean(with), 1e-6 * total(of_one), 255 * mean(without), 1e-6 * total(of_many), 255 * mean(many),
      noise, needed);
}

std::string study_bands(const LightingRuns& runs) {
  struct Sky {
    const char *name, *text;
    const char *flux, *cone;  // by integration
  };
  const Sky skies[] = {{"an even sky of radiance 1", "background: 1\nscene:\n", "1", "1"},
                       {"a ball of radiance 1 that fills 45 degrees about the zenith",
                        "scene:\n  - {material: lamp, quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, "
                        "-1414.2135623730951, 0, 1e6]}}\n",
                        "sin² 45° = 0.5", "1 - cos⁴ 45° = 0.75"},
                       {"an even sky but for a black ball that fills 60 degrees about the zenith",
                        "background: 1\nscene:\n  - {material: dark, sphere: {center: [0, "
                        "1154.7005383792515, 0], radius: 1000}}\n",
                        "cos² 60° = 0.25", "cos⁴ 60° = 0.0625"}};
  std::string section =
      "\n## Bands of light, bands of cones\n\n"
      "Section 3.3 draws Lambert's law as a sphere on the surface and asks that \"each cone should be of "
      "equal "
      "volume so that each ray represents an equal amount of light energy\". The volume inside an angle θ of "
      "the normal is 1 - cos⁴θ of the sphere, the integral of r³ = cos³θ. The light that passes there is the "
      "integral of cos θ, sin²θ. So rays of equal weight in bands of equal volume count light with cos³θ: "
      "what "
      "stands high counts too much, what stands low too little. `--diffuse-bands flux`, the default, shares "
      "the "
      "light; `cone` is the thesis's, and the plates above are made with it. A white floor under three "
      "skies, "
      "2,500 rays at each hit:\n\n"
      "| sky | flux: by integration | rendered | cone: by integration | rendered "
      "|\n|---|---:|---:|---:|---:|\n";
  for (const Sky& sky : skies) {
    const std::string scene = runs.scratch("sky.yaml").string();
    write_text_file(
        scene,
        fmt::format(R"(view: {{location: [0, 1, 0], look_at: [0, 0, 0], up: [0, 0, -1], field_of_view: 20}}
materials:
  floor: {{color: 1, ambient: 0, diffuse: 1}}
  lamp: {{luminaire: {{emission: 1}}}}
  dark: {{lambertian: 0}}
{}  - {{material: floor, polygon: {{points: [[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]]}}}}
)",
                    sky.text));
    section += fmt::format("| {} ", sky.name);
    for (const DiffuseBands bands : {DiffuseBands::flux, DiffuseBands::cone}) {
      RenderOptions job = runs.job(scene, 8, 8);
      job.size_px = {8, 8};
      job.settings.lighting = LightingModel::thesis;
      job.settings.diffuse_rays = 2500;
      job.settings.diffuse_bands = bands;
      runs.run(job, runs.scratch("sky.exr"));
      section += fmt::format("| {} | {:.4f} ", bands == DiffuseBands::flux ? sky.flux : sky.cone,
                             mean(runs.scratch("sky.exr")));
    }
    section += "|\n";
  }
  std::array<std::vector<float>, 2> pictures;
  std::array<int, 2> size{};
  for (const DiffuseBands bands : {DiffuseBands::flux, DiffuseBands::cone}) {
    RenderOptions job = runs.job(runs.scene("diffuse_room.yaml"), kWidth_px, kHeight_px);
    sample_corners(job.settings, 4);
    gather_diffuse_light(job.settings, 8);
    job.settings.diffuse_bands = bands;
    runs.run(job, runs.scratch("bands.exr"));
    pictures[bands == DiffuseBands::cone ? 1 : 0] = read_channels(runs.scratch("bands.exr"));
    size = *job.size_px;
  }
  const auto& [flux, cone] = pictures;
  Image image{size[0], size[1], {0, 0, size[0], size[1]}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (size_t i = 0; i < flux.size(); ++i)
    image.pixels.push_back(static_cast<std::byte>(std::lround(
        255 *
        std::clamp(0.5 + 8.0 * (static_cast<double>(cone[i]) - static_cast<double>(flux[i])), 0.0, 1.0))));
  write_image(runs.file("bands.png").string(), image, {});
  const ScreenDifference apart = screen_difference(cone, flux);
  section += fmt::format(
      "\nIn the diffuse room with 200 directions a pixel the two are {:.2f} thousandths apart (RMS, linear), "
      "and "
      "{:.1f} % of the pixels visibly; the mean level on a screen is {:.1f} with flux, {:.1f} with cone. "
      "Grey is "
      "no difference, brighter is more light with cone, eight times enlarged: the floor gets more of the "
      "green "
      "ceiling above it, and less of the walls.\n\n"
      "![cone minus flux, enlarged](bands.png)\n",
      1e3 * apart.rms, 100 * apart.visible, mean_level(flux), mean_level(cone));
  return section;
}

std::string study_times(const LightingRuns& runs) {
  // Whitted's model, the thesis's directions, directions that are turned: in turn, the least time of three.
  std::array<Outcome, 3> best;
  for (int repeat = 0; repeat < 3; ++repeat)
    for (size_t i = 0; i < best.size(); ++i) {
      RenderOptions job = runs.job(runs.scene("goral_room.yaml"), 512, 512);
      sample_corners(job.settings, 4);
      if (i > 0) gather_diffuse_light(job.settings, 1);
      if (i == 1) lay_out_as_in_thesis(job.settings);
      const Outcome outcome = runs.run(job, runs.scratch("timed.png"));
      if (repeat == 0 || outcome.trace_s < best[i].trace_s) best[i] = outcome;
    }
  const auto& [whitted, thesis, turned] = best;
  const double rays = total(thesis) / total(whitted), time = thesis.trace_s / whitted.trace_s;
  return fmt::format(
      "\n## The time of Plate 3.1b\n\n"
      "The thesis gives it twice the time of 3.1a. Here it takes {:.2f} times the time for {:.2f} times the "
      "rays "
      "(the least of three runs each, in turn): a further ray, which is a diffuse ray or the shadow ray from "
      "what it meets, costs {:.1f} times as much as an eye ray or its shadow ray. With sets that are turned, "
      "the "
      "default, it is {:.2f} times the time: random numbers, a random order and a sine and cosine for each "
      "hit. "
      "Where the rest goes a profile of one core says (`perf record build/rayfarm render "
      "scenes/goral_room.yaml "
      "-o x.png --sampling corners --subpixels 4x4 --size 1024x1024 --local-nodes 1`, and the same with "
      "`--lighting "
      "thesis --diffuse-set fixed --min-weight 0.41`). Hits cost the same to light and shade, about 40 ns "
      "each on "
      "the machine at hand. But to find what it meets a diffuse ray takes 73 ns where an eye ray takes 37, "
      "and its "
      "shadow ray 62 where an eye ray's takes 31: eye rays walk the hierarchy in packets of up to eight "
      "neighbours, as do the shadow rays from where they arrive, while the diffuse rays of a packet scatter "
      "to all "
      "sides and walk alone. (Diffuse rays of several surfaces that share packets take as long: the signs of "
      "their directions differ.) And a seventh of the time goes into the lighting tree, into surfaces that "
      "wait "
      "for their rays and directions that are set up about normals. The thesis's program traced every ray "
      "alone, "
      "so that its time followed its rays more closely.\n",
      time, rays, (time - 1) / (rays - 1), turned.trace_s / whitted.trace_s);
}

}  // namespace rayfarm
