#include "host/commands/render_words.h"

#include <fmt/core.h>

#include <charconv>
#include <filesystem>

#include "common/scene/settings_codec.h"
#include "host/commands/colour_option.h"
#include "host/commands/hierarchy_options.h"
#include "host/commands/job_options.h"
#include "host/commands/load_options.h"
#include "host/commands/net_options.h"
#include "host/commands/render_checks.h"
#include "host/commands/zone_options.h"
#include "host/render/output_pattern.h"

namespace rayfarm {
namespace {

constexpr double kMostTime_s = 366.0 * 24 * 3600;

template <size_t N>
std::array<int, N> parse_numbers(const char* option, const std::string& text, char separator,
                                 const std::string& form) {
  std::array<int, N> numbers{};
  size_t begin = 0;
  for (size_t i = 0; i < N; ++i) {
    const size_t end = i + 1 == N ? text.size() : text.find(separator, begin);
    if (end == std::string::npos)
      throw UsageError(fmt::format("{} {}: not of the form {}", option, text, form));
    const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, numbers[i]);
    if (error != std::errc{} || stop != text.data() + end || begin == end)
      throw UsageError(fmt::format("{} {}: not of the form {}", option, text, form));
    begin = end + 1;
  }
  return numbers;
}

Subpixels parse_subpixels(const std::string& text) {
  const auto parts = parse_numbers<2>("--subpixels", text, 'x', "COLUMNSxROWS");
  const auto is_cut = [](int n) { return n >= 1 && n <= static_cast<int>(Subpixels::kMost); };
  if (!is_cut(parts[0]) || !is_cut(parts[1]))
    throw UsageError(
        fmt::format("--subpixels {}: a pixel is cut into 1 to {} columns and rows", text, Subpixels::kMost));
  return {static_cast<uint32_t>(parts[0]), static_cast<uint32_t>(parts[1])};
}

/// Seconds of SS, MM:SS or HH:MM:SS.
double parse_duration(const std::string& option, const std::string& text) {
  double seconds = 0;
  int parts = 0;
  for (size_t begin = 0; begin <= text.size(); ++parts) {
    const size_t end = std::min(text.find(':', begin), text.size());
    int value = 0;
    const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    if (error != std::errc{} || stop != text.data() + end || value < 0 || (parts > 0 && value > 59))
      parts = 3;
    seconds = 60 * seconds + value;
    begin = end + 1;
  }
  if (parts > 3 || seconds < 1 || seconds > kMostTime_s)
    throw UsageError(fmt::format(
        "{} {}: is no time from a second to a year; write HH:MM:SS, MM:SS or seconds", option, text));
  return seconds;
}

void add_picture(Options& options, RenderOptions& o) {
  options.begin_group("Picture");
  options
      .text("-o,--output", o.output,
            "FILE.exr or FILE.png, required; #### becomes the frame number; its folder is made if the one "
            "above it is there",
            "FILE")
      .required();
  options.text("--frames", o.frames,
               "1-10, 1-10x2 or 1,5,9 (default: the scene's frames if the name has ####, else the first)",
               "FRAMES");
  options.begin_group("Picture", AskedBy::scenes_too);
  options.text(
      "--size",
      [&o](const std::string& text) {
        const auto size = parse_numbers<2>("--size", text, 'x', "WIDTHxHEIGHT");
        if (size[0] < 1 || size[1] < 1 || size[0] > 65536 || size[1] > 65536)
          throw UsageError(
              fmt::format("--size {}: an image has 1 to 65536 pixels a side, because the net carries "
                          "coordinates of 16 bits",
                          text));
        o.size_px = size;
      },
      "image size in pixels (default: the scene's)", "WxH");
  options.choice<Fit>(
      "--fit", o.fit, choices<Fit>(kFitWords),
      "in an image of another aspect than the view's: the view is as wide as it; covers it, and is "
      "cropped; or stands whole between bars (default: width)");
  options.text(
      "--crop",
      [&o](const std::string& text) { o.crop = parse_numbers<4>("--crop", text, ',', "x0,x1,y0,y1"); },
      "render only these pixels; x1 and y1 are excluded", "x0,x1,y0,y1");
  options
      .number("--exposure", o.settings.exposure_stops, -kMostExposure_stops, kMostExposure_stops,
              "stops by which the picture is brighter than the light that the scene has (default: 0)")
      .takes("STOPS");
  options.begin_group("Picture");
  options.choice<PixelFormat>(
      "--pixel-format", o.pixel_format,
      {{"rgb8", PixelFormat::rgb8}, {"half", PixelFormat::half_float}, {"float", PixelFormat::float32}},
      "of pixels on the net and in the frame buffer (default: what the file holds: PNG rgb8, EXR half)");
  options.number(
      "--passes", o.passes, 1, PicturesPhase::kMostPasses,
      "the samples come in so many passes, after each of which the output file is a whole picture with the "
      "samples until then; the last is what one pass would give (default: 1)");
  options.flag("--skip-existing", o.skip_existing,
               "leave out frames whose file is there, whole, and of this scene and these settings");
  options.flag(
      "--resume", o.resume,
      "go on where an earlier run of this job was stopped, with any number of nodes: frames that are there "
      "are left out, and what is in a frame's journal is not traced again");
  options.text(
      "--max-time", [&o](const std::string& text) { o.most_time_s = parse_duration("--max-time", text); },
      "stop after so long as if by Ctrl-C: what there is can be looked at, and --resume goes on",
      "[[HH:]MM:]SS");
  options.number(
      "--journal", o.journal_every_s, 0, 3600,
      "seconds between two times that results of frames in the making are written to FILE.journal; 0: "
      "they are not (default: 2)");
  options.number("--frame-memory", o.frame_memory_GiB, 0.0001, 65536,
                 "GiB that pixels of pictures in the making may take on the host; what a larger picture does "
                 "not need any more leaves for its file (default: 1)");
}

void add_light(Options& options, RenderOptions& o) {
  options.begin_group("Light", AskedBy::scenes_too);
  options.choice<LightingModel>("--lighting", o.settings.lighting,
                                {{"path", LightingModel::path},
                                 {"phong", LightingModel::phong},
                                 {"radiosity", LightingModel::radiosity},
                                 {"thesis", LightingModel::thesis},
                                 {"torrance-sparrow", LightingModel::torrance_sparrow},
                                 {"whitted", LightingModel::whitted},
                                 {"zonal", LightingModel::zonal}},
                                "lighting model (default: whitted)");
  options.number("--diffuse-rays", o.settings.diffuse_rays, 1, 10000,
                 "thesis's model: diffuse rays at each hit (default: 1)");
  options
      .number("--diffuse-reach", o.settings.diffuse_reach, 0, 1e15,
              "thesis's model: the length at which a diffuse ray has lost half of its strength to "
              "ambient light (default: 0, it loses none)")
      .takes("LENGTH");
  options.number("--diffuse-contrast", o.settings.diffuse_contrast, 0, 1e6,
                 "thesis's model: trace a ray between neighbours that differ by more in the pixel (default: "
                 "0, never)");
  options.flag("--diffuse-jitter", o.settings.diffuse_jitter,
               "thesis's model: diffuse rays at random in their parts of the bands: noise where fixed "
               "places are wrong on curved bodies");
  options.choice<DiffuseBands>(
      "--diffuse-bands", o.settings.diffuse_bands,
      {{"cone", DiffuseBands::cone}, {"flux", DiffuseBands::flux}},
      "thesis's model: what diffuse rays share evenly: light, or the volume of cones, as the thesis has it, "
      "which favours light from along the normal (default: flux)");
  options.choice<DiffuseSet>("--diffuse-set", o.settings.diffuse_set,
                             {{"fixed", DiffuseSet::fixed}, {"turned", DiffuseSet::turned}},
                             "thesis's model: diffuse rays turned at random in each pixel, or the same "
                             "everywhere, as the thesis has "
                             "it: false reflections in place of noise (default: turned)");
  options.number("--reflected-rays", o.settings.reflected_rays, 1, kMostLobeRays,
                 "whitted and thesis: rays that a surface with an `exponent` reflects, spread over its lobe "
                 "(default: 1, along the mirror direction)");
  options.number("--transmitted-rays", o.settings.transmitted_rays, 1, kMostLobeRays,
                 "the same of rays that pass (default: 1, along the refracted direction)");
  options.choice<GlassShadows>("--glass-shadows", o.settings.glass_shadows,
                               {{"blocked", GlassShadows::blocked},
                                {"none", GlassShadows::none},
                                {"transparent", GlassShadows::transparent}},
                               "not path: bodies that transmit stop light from sources, cast no shadow, or "
                               "let it straight on, weakened (default: blocked)");
  options.choice<AmbientColour>(
      "--ambient-colour", o.settings.ambient_colour,
      {{"light", AmbientColour::light}, {"surface", AmbientColour::surface}},
      "phong, torrance-sparrow and whitted: ambient light has its own colour alone, or is weighed by the "
      "surface's (default: surface)");
  add_colour_option(options, o.settings);
  add_depth_options(options, o);
  options.number("--min-weight", o.settings.min_weight, 0, 1,
                 "do not trace rays that would contribute less (0: no cut-off; default: 1e-6)");
  add_self_hit_option(options, o);
}

void add_sampling(Options& options, RenderOptions& o) {
  options.begin_group("Sampling", AskedBy::scenes_too);
  options.number("--samples,--spp", o.settings.samples, 1, kMostSamples, "rays per pixel (default: 1)");
  options.number("--adaptive", o.settings.adaptive_contrast, 0, 1e6,
                 "trace all samples only in pixels whose first sample differs by more than this from a "
                 "neighbour's (default: 0, in all); not with --lighting path");
  options
      .number("--noise", o.settings.noise, 0, 1,
              "a pixel gets no more samples when the standard error of its mean, in parts of the display's "
              "range from black to white, is no greater: 0.01 is 2.5 of 255 (default: 0, all get --samples); "
              "where light is found by chance, and with a lens or a shutter")
      .takes("E");
  options.choice<SamplingPattern>("--sampling", o.settings.sampling,
                                  {{"corners", SamplingPattern::corners},
                                   {"jittered", SamplingPattern::jittered},
                                   {"n-rooks", SamplingPattern::n_rooks},
                                   {"poisson", SamplingPattern::poisson},
                                   {"regular", SamplingPattern::regular},
                                   {"sobol", SamplingPattern::sobol},
                                   {"uncorrelated", SamplingPattern::uncorrelated}},
                                  "pattern of the samples (default: sobol)");
  options.text(
      "--subpixels", [&o](const std::string& text) { o.subpixels = parse_subpixels(text); },
      "with --sampling corners: rays go through the corners of so many parts of a pixel (default: 1x1)",
      "COLUMNSxROWS");
  options.choice<FilterKind>("--filter", o.settings.filter,
                             {{"box", FilterKind::box},
                              {"gaussian", FilterKind::gaussian},
                              {"mitchell", FilterKind::mitchell},
                              {"tent", FilterKind::tent}},
                             "how a pixel weighs what is around its centre (default: box)");
  options.number("--shutter", o.settings.shutter, 0, 1000,
                 "how long it is open, in frames: what moves is blurred (default: 0)");
  options.number("--seed", o.settings.seed, "of the random numbers (default: 0)");
}

void add_items(Options& options, RenderOptions& o) {
  RenderSettings& s = o.settings;
  options.choice<ItemBuffer>(
      "--item-buffer", s.item_buffer,
      {{"bound", ItemBuffer::bound},
       {"checked", ItemBuffer::checked},
       {"none", ItemBuffer::none},
       {"trusted", ItemBuffer::trusted}},
      "a z-buffer tells which item an eye ray is tested with first, and its hit bounds the "
      "search (bound: the same picture), or ends it (trusted; checked: counts the eye rays "
      "that would have hit something else) (default: none)");
  options.number("--item-radius", s.item_radius_px, kLeastItemRadius_px, kMostItemRadius_px,
                 "with --item-buffer: pixel corners so near to a sample tell of it (default: 1)");
  options.number(
      "--light-buffer", s.light_cells, 0, kMostLightCells,
      "points along a side of each light's map of the items that it sees: a shadow ray is tested with "
      "that item first; the same picture (default: 0, none; 128 will do)");
}

void add_net(Options& options, RenderOptions& o) {
  options.begin_group("Nodes and net");
  add_assign_option(options, o);
  options.choice<Wire>(
      "--wire", o.wire, {{"block", Wire::block}, {"pixel", Wire::pixel}},
      "form of results: a block per subpolygon, or the thesis's 9 bytes per pixel (default: block)");
  options.choice<bool>("--compression", o.compresses, {{"none", false}, {"lossless", true}},
                       "of RGB8 blocks (default: lossless)");
  add_node_options(options, o);
  add_sets(options, o.sets);
  options.flag("!--no-rotation", o.rotates,
               "interleaved: each node keeps its own set in every frame, where the sets move on otherwise");
  options.number("--subpolygons", o.subpolygons_per_processor, 1, 1 << 20,
                 "per node, as far as the picture has room (default: the thesis's 64)");
  options.number("--least-side", o.least_side_px, 1, 65536,
                 "of a subpolygon in pixels (default: 1 on the pixel wire; 8 for blocks, of which smaller "
                 "ones are mostly header)");
  options
      .number("--processor-time", o.ray_time_s, 0, 1e3,
              "emulate slow processors: seconds that a node takes for each ray, mostly asleep "
              "(default: 0, as fast as it can)")
      .takes("S");
  options.numbers("--processor-times", o.time_factors, 1e-3, 1e3,
                  "1,1,2: factors on --processor-time by node, in turn; 2 takes twice as long");
}

/// Of --view; nothing means any that is free.
int parse_view_port(const std::string& text) {
  if (text.empty()) return 0;
  int port = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc{} || stop != text.data() + text.size() || port < 0 || port > 65535)
    throw UsageError(
        fmt::format("--view {}: a port is a number from 1 to 65535 (0: any that is free); if '{}' is "
                    "something else, let --view follow it, or write --view=0",
                    text, text));
  return port;
}

void add_watching(Options& options, RenderOptions& o) {
  options.begin_group("Watching");
  options
      .text(
          "--view", [&o](const std::string& text) { o.view_port = parse_view_port(text); },
          "serve a page to this machine alone (127.0.0.1) on which a browser shows the picture as it grows, "
          "nodes, "
          "traffic and the time left; its address, with a secret in it, is said on stderr; it ends with the "
          "job "
          "(no PORT: any that is free)",
          "[PORT]")
      .may_stand_alone();
  options.text(
      "--display",
      [&o](const std::string& text) {
        try {
          o.display = parse_tev_address(text);
        } catch (const std::invalid_argument& e) {
          throw UsageError(fmt::format("--display {}: {}", text, e.what()));
        }
      },
      "tev://HOST[:PORT]: send pictures, in linear light, to the viewer tev while they grow (default port: "
      "14158)",
      "URL");
}

void add_messages(Options& options, RenderOptions& o) {
  options.begin_group("Messages");
  options.text("--cost-map", o.cost_map,
               "write to this JSON file what each subpolygon took and weighs (rayfarm simulate reads it)",
               "FILE");
  options.text("--stats", o.stats, "write statistics to this JSON file", "FILE");
  add_progress_option(options, o);
  options.choice<bool>(
      "--report", o.is_full_report, {{"full", true}, {"short", false}},
      "what is said at the end: ten lines, or all that an experimenter asks (default: short)");
  add_quiet_options(options, o);
}

}  // namespace

void add_render_options(Options& options, RenderOptions& o) {
  options.text("SCENE", o.scene, kSceneKinds).required();
  add_load_options(options, o.load);
  add_picture(options, o);
  add_light(options, o);
  options.begin_group("Zones (--lighting radiosity and zonal)", AskedBy::scenes_too);
  add_zone_options(options, o);
  add_zone_view_option(options, o);
  add_sampling(options, o);
  options.begin_group("Hierarchy");
  add_hierarchy_options(options, o.build);
  add_items(options, o);
  add_net(options, o);
  add_watching(options, o);
  add_messages(options, o);
}

void check_output(const RenderOptions& o) {
  if (!is_writable_image(o.output))
    throw UsageError(fmt::format("-o {}: the name must end in .exr or .png", o.output));
  if (has_frame_pattern(std::filesystem::path(o.output).parent_path().string()))
    throw UsageError(
        fmt::format("-o {}: the #### must stand in the file's name, not in its folder's", o.output));
  if (has_frame_pattern(std::filesystem::path(o.zones_file).parent_path().string()))
    throw UsageError(
        fmt::format("--zones {}: the #### must stand in the file's name, not in its folder's", o.zones_file));
  if (o.frames.empty()) return;
  std::vector<FrameNumber> frames;
  try {
    frames = parse_frames(o.frames);
  } catch (const std::invalid_argument& e) {
    throw UsageError(fmt::format("--frames: {}", e.what()));
  }
  if (frames.size() > 1 && !has_frame_pattern(o.output))
    throw UsageError(fmt::format("-o {}: several frames need #### in the file's name", o.output));
}

void check_render(RenderOptions& o) {
  o.settings.subpixels = o.subpixels.value_or(Subpixels());
  set_limits(o);
  check_output(o);
  try {
    check_settings(o.settings);
  } catch (const SettingsError& e) {
    throw UsageError(e.what());
  }
  check_combinations(o);
}

}  // namespace rayfarm
