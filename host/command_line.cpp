#include "host/command_line.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <filesystem>
#include <sstream>

#include "common/sampling/sampler.h"
#include "common/scene/settings_codec.h"
#include "host/exit_code.h"
#include "host/help.h"
#include "host/net/net_commands.h"
#include "host/output_pattern.h"

namespace rayfarm {
namespace {

template <size_t N>
std::array<int, N> parse_numbers(const std::string& text, char separator, const std::string& form) {
  std::array<int, N> numbers{};
  size_t begin = 0;
  for (size_t i = 0; i < N; ++i) {
    const size_t end = i + 1 == N ? text.size() : text.find(separator, begin);
    if (end == std::string::npos)
      throw CLI::ValidationError(fmt::format("'{}' is not of the form {}", text, form));
    const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, numbers[i]);
    if (error != std::errc{} || stop != text.data() + end || begin == end)
      throw CLI::ValidationError(fmt::format("'{}' is not of the form {}", text, form));
    begin = end + 1;
  }
  return numbers;
}

template <typename Enum>
CLI::Option* add_choice(CLI::App* app, const std::string& name, Enum& target,
                        const std::map<std::string, Enum>& choices, const std::string& help) {
  std::string list;
  for (const auto& [word, value] : choices) list += (list.empty() ? "" : "|") + word;
  return app
      ->add_option_function<std::string>(
          name,
          [&target, choices, name, list](const std::string& word) {
            const auto found = choices.find(word);
            if (found == choices.end())
              throw CLI::ValidationError(fmt::format("{}: '{}' is unknown; choose {}", name, word, list));
            target = found->second;
          },
          help)
      ->type_name(list);
}

void add_render(CLI::App& app, CommandLine& line, std::optional<PixelFormat>& pixel_format) {
  RenderOptions& o = line.render;
  CLI::App* render = app.add_subcommand("render", "render a scene to image files");
  render->add_option("SCENE", o.scene, ".yaml or .nff")->required();
  render
      ->add_option(
          "-o,--output", o.output,
          "FILE.exr or FILE.png, required; #### becomes the frame number; its folder is made if the one "
          "above it is there")
      ->required()
      ->type_name("FILE");
  render
      ->add_option("--frames", o.frames,
                   "1-10, 1-10x2 or 1,5,9 (default: the scene's frames if the name has ####, else the first)")
      ->type_name("FRAMES");
  render
      ->add_option_function<std::string>(
          "--size",
          [&o](const std::string& text) {
            const auto size = parse_numbers<2>(text, 'x', "WIDTHxHEIGHT");
            if (size[0] < 1 || size[1] < 1 || size[0] > 65536 || size[1] > 65536)
              throw CLI::ValidationError(
                  fmt::format("--size {}: an image has 1 to 65536 pixels a side, because the net carries "
                              "coordinates of 16 bits",
                              text));
            o.size_px = size;
          },
          "image size in pixels (default: the scene's)")
      ->type_name("WxH");
  render
      ->add_option_function<std::string>(
          "--crop", [&o](const std::string& text) { o.crop = parse_numbers<4>(text, ',', "x0,x1,y0,y1"); },
          "render only these pixels; x1 and y1 are excluded")
      ->type_name("x0,x1,y0,y1");
  add_choice<LightingModel>(render, "--lighting", o.settings.lighting,
                            {{"phong", LightingModel::phong},
                             {"torrance-sparrow", LightingModel::torrance_sparrow},
                             {"whitted", LightingModel::whitted},
                             {"thesis", LightingModel::thesis},
                             {"path", LightingModel::path}},
                            "lighting model (default: whitted)");
  render
      ->add_option("--diffuse-rays", o.settings.diffuse_rays,
                   "thesis's model: diffuse rays at each hit (default: 1)")
      ->check(CLI::Range(1u, 10000u));
  render
      ->add_option("--diffuse-reach", o.settings.diffuse_reach,
                   "thesis's model: the length at which a diffuse ray has lost half of its strength to "
                   "ambient light (default: 0, it loses none)")
      ->check(CLI::Range(0.0, 1e15));
  render
      ->add_option(
          "--diffuse-contrast", o.settings.diffuse_contrast,
          "thesis's model: trace a ray between neighbours that differ by more in the pixel (default: "
          "0, never)")
      ->check(CLI::Range(0.0, 1e6));
  render->add_flag("--diffuse-jitter", o.settings.diffuse_jitter,
                   "thesis's model: diffuse rays at random in their parts of the bands: noise where fixed "
                   "places are wrong on curved bodies");
  render->add_option("--samples,--spp", o.settings.samples, "rays per pixel (default: 1)")
      ->check(CLI::Range(1u, 1u << 20));
  render
      ->add_option("--adaptive", o.settings.adaptive_contrast,
                   "trace all samples only in pixels whose first sample differs by more than this from a "
                   "neighbour's (default: 0, in all); not with --lighting path")
      ->check(CLI::Range(0.0, 1e6));
  add_choice<SamplingPattern>(render, "--sampling", o.settings.sampling,
                              {{"sobol", SamplingPattern::sobol},
                               {"regular", SamplingPattern::regular},
                               {"jittered", SamplingPattern::jittered},
                               {"uncorrelated", SamplingPattern::uncorrelated},
                               {"n-rooks", SamplingPattern::n_rooks},
                               {"poisson", SamplingPattern::poisson},
                               {"corners", SamplingPattern::corners}},
                              "pattern of the samples (default: sobol)");
  add_choice<ColourModel>(
      render, "--colour", o.settings.colour,
      {{"rgb", ColourModel::rgb}, {"meyer4", ColourModel::meyer4}, {"spectral20", ColourModel::spectral20}},
      "what colours are computed as: red, green and blue, or spectra at 4 or 20 "
      "wavelengths (default: rgb)");
  add_choice<FilterKind>(render, "--filter", o.settings.filter,
                         {{"box", FilterKind::box},
                          {"tent", FilterKind::tent},
                          {"gaussian", FilterKind::gaussian},
                          {"mitchell", FilterKind::mitchell}},
                         "how a pixel weighs what is around its centre (default: box)");
  render
      ->add_option("--max-depth", o.max_depth,
                   "depth of the lighting tree; the eye ray is 1 (default: 5; path: 100)")
      ->check(CLI::Range(1u, 1000u));
  render
      ->add_option("--min-weight", o.settings.min_weight,
                   "do not trace rays that would contribute less (0: no cut-off; default: 1e-6)")
      ->check(CLI::Range(0.0, 1.0));
  render
      ->add_option("--shutter", o.settings.shutter,
                   "how long it is open, in frames: what moves is blurred (default: 0)")
      ->check(CLI::Range(0.0, 1000.0));
  render->add_option("--seed", o.settings.seed, "of the random numbers (default: 0)");
  render
      ->add_option_function<std::string>(
          "--pixel-format",
          [&pixel_format](const std::string& word) {
            if (word == "rgb8")
              pixel_format = PixelFormat::rgb8;
            else if (word == "half")
              pixel_format = PixelFormat::half_float;
            else if (word == "float")
              pixel_format = PixelFormat::float32;
            else
              throw CLI::ValidationError(
                  fmt::format("--pixel-format: '{}' is unknown; choose rgb8|half|float", word));
          },
          "of pixels on the net and in the frame buffer (default: what the file holds: PNG rgb8, EXR half)")
      ->type_name("rgb8|half|float");
  add_choice<SplitRule>(
      render, "--hierarchy", o.split_rule, {{"sah", SplitRule::sah}, {"thesis", SplitRule::thesis}},
      "how volumes are split: by the surface area heuristic, or about the centre of the data (default: sah)");
  render->add_option("--max-primitives", o.max_primitives, "in a leaf of the hierarchy (default: 8)")
      ->check(CLI::Range(1u, 1000u));
  add_choice<AssignmentPolicy>(
      render, "--assign", o.policy,
      {{"on-demand", AssignmentPolicy::on_demand}, {"interleaved", AssignmentPolicy::interleaved}},
      "who traces what (default: on-demand)");
  add_choice<Wire>(
      render, "--wire", o.wire, {{"block", Wire::block}, {"pixel", Wire::pixel}},
      "form of results: a block per subpolygon, or the thesis's 9 bytes per pixel (default: block)");
  add_choice<bool>(render, "--compression", o.compresses, {{"zstd", true}, {"none", false}},
                   "of RGB8 blocks (default: zstd)");
  render
      ->add_option("--local-nodes", o.local_nodes,
                   "without mpirun: how many nodes run inside this process (default: one per core)")
      ->check(CLI::Range(1, 256));
  render
      ->add_option("--node-timeout", o.node_timeout_s,
                   "seconds of silence after which a node is lost (default: 8)")
      ->check(CLI::Range(liveness::kLeastNodeTimeout_s, 3600.0));
  render->add_flag(
      "!--no-rotation", o.rotates,
      "interleaved: each node keeps its own set in every frame, where the sets move on otherwise");
  render
      ->add_option("--subpolygons", o.subpolygons_per_processor,
                   "per node, none narrower than 8 pixels (default: the thesis's 64)")
      ->check(CLI::Range(1, 1 << 20));
  render
      ->add_option("--processor-time", o.ray_time_s,
                   "emulate slow processors: seconds that a node takes for each ray, mostly asleep "
                   "(default: 0, as fast as it can)")
      ->check(CLI::Range(0.0, 1e3));
  render
      ->add_option("--processor-times", o.time_factors,
                   "1,1,2: factors on --processor-time by node, in turn; 2 takes twice as long")
      ->delimiter(',')
      ->check(CLI::Range(1e-3, 1e3));
  render
      ->add_option("--cost-map", o.cost_map,
                   "write to this JSON file what each subpolygon took and weighs (rayfarm simulate reads it)")
      ->type_name("FILE");
  render->add_flag("--skip-existing", o.skip_existing,
                   "leave out frames whose file is there, whole, and of this scene and these settings");
  render->add_option("--stats", o.stats, "write statistics to this JSON file")->type_name("FILE");
  add_choice<ProgressStyle>(render, "--progress", o.progress,
                            {{"auto", ProgressStyle::automatic},
                             {"tty", ProgressStyle::tty},
                             {"plain", ProgressStyle::plain},
                             {"none", ProgressStyle::none}},
                            "progress display (default: auto)");
  add_choice<bool>(render, "--report", o.is_full_report, {{"short", false}, {"full", true}},
                   "what is said at the end: ten lines, or all that an experimenter asks (default: short)");
  render->add_flag("-q,--quiet", o.is_quiet, "errors only");
  render->add_flag("-v,--verbose", o.is_verbose, "tell more");
  group_options(
      *render,
      {{"Picture", {"--output", "--frames", "--size", "--crop", "--pixel-format", "--skip-existing"}},
       {"Sampling", {"--samples", "--adaptive", "--sampling", "--filter", "--shutter", "--seed"}},
       {"Light",
        {"--lighting", "--max-depth", "--min-weight", "--colour", "--diffuse-rays", "--diffuse-reach",
         "--diffuse-contrast", "--diffuse-jitter"}},
       {"Hierarchy", {"--hierarchy", "--max-primitives"}},
       {"Nodes and net",
        {"--local-nodes", "--node-timeout", "--assign", "--no-rotation", "--subpolygons", "--wire",
         "--compression", "--processor-time", "--processor-times"}},
       {"Messages", {"--progress", "--report", "--quiet", "--verbose", "--stats", "--cost-map"}}});
  render->callback([&line] { line.kind = CommandKind::render; });
}

/// What CLI11 can't check by itself.
void check_render(const RenderOptions& o) {
  if (!is_writable_image(o.output))
    throw CLI::ValidationError(fmt::format("-o {}: the name must end in .exr or .png", o.output));
  if (has_frame_pattern(std::filesystem::path(o.output).parent_path().string()))
    throw CLI::ValidationError(
        fmt::format("-o {}: the #### must stand in the file's name, not in its folder's", o.output));
  if (!o.frames.empty()) {
    std::vector<int> frames;
    try {
      frames = parse_frames(o.frames);
    } catch (const std::invalid_argument& e) {
      throw CLI::ValidationError(fmt::format("--frames: {}", e.what()));
    }
    if (frames.size() > 1 && !has_frame_pattern(o.output))
      throw CLI::ValidationError(fmt::format("-o {}: several frames need #### in the file's name", o.output));
  }
  try {
    check_settings(o.settings);
  } catch (const SettingsError& e) {
    throw CLI::ValidationError(e.what());
  }
  if (o.settings.sampling == SamplingPattern::poisson && o.settings.samples > Sampler::kMostPoissonSamples)
    throw CLI::ValidationError(fmt::format(
        "--sampling poisson lays out at most {} samples; use sobol for more", Sampler::kMostPoissonSamples));
  if (o.settings.sampling == SamplingPattern::corners && o.settings.filter != FilterKind::box)
    throw CLI::ValidationError("--sampling corners weighs the four corners alike; leave --filter at box");
  if (o.settings.sampling == SamplingPattern::corners && o.settings.shutter > 0)
    throw CLI::ValidationError("--sampling corners takes one ray per corner, too few for --shutter");
  if (o.settings.sampling == SamplingPattern::corners && o.settings.samples != 1)
    throw CLI::ValidationError("--sampling corners takes one ray per corner; leave --samples at 1");
  if (o.settings.adaptive_contrast > 0 && o.settings.samples < 2)
    throw CLI::ValidationError("--adaptive chooses where more than one sample is taken; set --samples");
  if (o.settings.adaptive_contrast > 0 && o.settings.lighting == LightingModel::path)
    throw CLI::ValidationError(
        "--adaptive compares the first samples of neighbouring pixels, which differ everywhere where "
        "light is found by chance: it suits phong, torrance-sparrow, whitted and thesis, not path");
  if (!o.time_factors.empty() && !(o.ray_time_s > 0))
    throw CLI::ValidationError("--processor-times are factors on --processor-time; give that, too");
  if (o.wire == Wire::pixel && o.pixel_format && *o.pixel_format != PixelFormat::rgb8)
    throw CLI::ValidationError(
        "--wire pixel carries three bytes of colour; use --pixel-format rgb8 or --wire block");
}

}  // namespace

CommandLine parse_command_line(int argc, char** argv) {
  CommandLine line;
  CLI::App app{"Rayfarm: a ray tracing render farm on Open MPI", "rayfarm"};
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", "rayfarm " RAYFARM_VERSION);
  app.require_subcommand(1);
  std::optional<PixelFormat> pixel_format;
  add_render(app, line, pixel_format);
  CLI::App* check = app.add_subcommand("check", "validate a scene and list every file it uses");
  check->add_option("SCENE", line.scene, ".yaml or .nff")->required();
  check->callback([&line] { line.kind = CommandKind::check; });
  CLI::App* info = app.add_subcommand("info", "print a scene's counts, bounds, object tree and memory");
  info->add_option("SCENE", line.scene, ".yaml or .nff")->required();
  info->callback([&line] { line.kind = CommandKind::info; });
  CLI::App* compare = app.add_subcommand("compare", "compare two images; exit code 1 if they differ");
  compare->add_option("A", line.compare.a)->required();
  compare->add_option("B", line.compare.b)->required();
  compare
      ->add_option("--tolerance", line.compare.tolerance,
                   "largest difference of a channel that counts as equal (default: 0)")
      ->check(CLI::Range(0.0, 1e6));
  compare->add_option("--share", line.compare.share, "share of pixels that may differ by more (default: 0)")
      ->check(CLI::Range(0.0, 1.0));
  compare->callback([&line] { line.kind = CommandKind::compare; });
  CLI::App* experiment =
      app.add_subcommand("experiment", "reproduce an experiment of the seeds, and write a page about it");
  experiment
      ->add_option(
          "NAME", line.experiment.name,
          "lighting: the pictures of the thesis's chapter 3; net-load: processor counts against the net's "
          "load, section 4.4.4.2; working-sets: Table 4.12")
      ->required()
      ->check(CLI::IsMember({"lighting", "net-load", "working-sets"}));
  experiment->add_option("-o,--output", line.experiment.output,
                         "folder for page, pictures and numbers (default: out/NAME)");
  experiment->add_option("--scenes", line.experiment.scenes,
                         "folder that holds the scenes (default: scenes)");
  experiment
      ->add_option("--width", line.experiment.width_px, "of the pictures in pixels (default: the scenes')")
      ->check(CLI::Range(8, 65536));
  experiment->add_option(
      "--cluster", line.experiment.cluster,
      "net-load: the script that makes a virtual cluster (default: deploy/virtual-cluster)");
  experiment->callback([&line] {
    line.kind = CommandKind::experiment;
    if (line.experiment.output.empty()) line.experiment.output = "out/" + line.experiment.name;
  });
  add_model_command(app, line);
  add_simulate_command(app, line);
  try {
    app.parse(argc, argv);
    line.render.pixel_format = pixel_format;
    if (line.kind == CommandKind::render) {
      check_render(line.render);
      RenderSettings& settings = line.render.settings;
      settings.max_depth = line.render.max_depth.value_or(
          settings.lighting == LightingModel::path ? kPathDepth : settings.max_depth);
    }
  } catch (const CLI::ParseError& e) {
    std::ostringstream out, err;
    const int code = app.exit(e, out, err);
    line.kind = CommandKind::none;
    line.exit_code = code == 0 ? kComplete : kUsageError;
    const std::string unknown = find_unknown_word(app, argc, argv);
    line.message = code == 0 ? out.str()
                             : fmt::format("rayfarm: {}\nTry 'rayfarm --help' or 'rayfarm COMMAND --help'.\n",
                                           unknown.empty() ? e.what() : unknown);
  }
  return line;
}

}  // namespace rayfarm
