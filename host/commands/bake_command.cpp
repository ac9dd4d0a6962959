#include <fmt/core.h>

#include "common/image/image_file.h"
#include "common/scene/settings_codec.h"
#include "host/bake/bake.h"
#include "host/commands/colour_option.h"
#include "host/commands/commands.h"
#include "host/commands/hierarchy_options.h"
#include "host/commands/job_options.h"
#include "host/commands/load_options.h"
#include "host/commands/zone_options.h"
#include "host/render/output_pattern.h"

namespace rayfarm {
namespace {

struct BakeWords {
  RenderOptions job;
  std::optional<double> exposure_stops;
  std::optional<int> frame;
};

void check_bake(BakeWords& words) {
  RenderOptions& o = words.job;
  if (!is_bakable(o.output))
    throw UsageError(
        fmt::format("-o {}: the name must end in .glb (colours of vertices) or .exr (an atlas of "
                    "zones)",
                    o.output));
  if (has_frame_pattern(o.output) || has_frame_pattern(o.zones_file))
    throw UsageError("one frame is baked, which --frame chooses: leave #### out of the names of files");
  if (words.exposure_stops && extension_of(o.output) != ".glb")
    throw UsageError("--exposure belongs to .glb, whose colours end at 1; an atlas holds radiance as it is");
  if (words.frame) o.frames = fmt::format("{}", *words.frame);
  o.bake = BakeOptions{words.exposure_stops};
  o.pixel_format = PixelFormat::float32;
  set_limits(o);
  try {
    check_settings(o.settings);
  } catch (const SettingsError& e) {
    throw UsageError(e.what());
  }
}

}  // namespace

void add_bake_command(CommandLine& line) {
  const auto words = std::make_shared<BakeWords>();
  RenderOptions& o = words->job;
  o.settings.lighting = LightingModel::zonal;
  Verb verb;
  verb.name = "bake";
  verb.help = "write the light of a scene's zones for other programs";
  verb.examples = {
      {"rayfarm bake room.yaml -o room.glb", "a glTF file whose vertices have the room's light"}};
  verb.check = [words](const auto&) { check_bake(*words); };
  verb.run = [words](const Renders& renders) { return renders.as_launched(words->job); };
  verb.is_for_all_ranks = true;
  Options options = line.add(std::move(verb));
  options.text("SCENE", o.scene, kSceneKinds).required();
  add_load_options(options, o.load);
  options.begin_group("Output");
  options
      .text("-o,--output", o.output,
            "FILE.glb: the scene as triangles, coloured by light at the corners of zones; or FILE.exr: an "
            "image with a rectangle of zones for each primitive; required",
            "FILE")
      .required();
  options.number("--exposure", words->exposure_stops, -64, 64,
                 ".glb: colours are radiance times 2 to this, and end at 1 (default: 0)");
  options.number("--frame", words->frame, -1'000'000'000, 1'000'000'000,
                 "the one whose poses and view are baked (default: the scene's first)");
  options.begin_group("Light");
  options.choice<LightingModel>("--lighting", o.settings.lighting,
                                {{"radiosity", LightingModel::radiosity}, {"zonal", LightingModel::zonal}},
                                "lighting model (default: zonal)");
  add_colour_option(options, o.settings);
  add_depth_options(options, o);
  add_self_hit_option(options, o);
  options.number("--seed", o.settings.seed, "of the random numbers (default: 0)");
  options.begin_group("Zones");
  add_zone_options(options, o);
  options.begin_group("Hierarchy");
  add_hierarchy_options(options, o.build);
  options.begin_group("Nodes");
  add_assign_option(options, o);
  add_node_options(options, o);
  options.begin_group("Messages");
  add_progress_option(options, o);
  add_quiet_options(options, o);
}

}  // namespace rayfarm
