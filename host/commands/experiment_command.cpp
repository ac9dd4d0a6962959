#include <memory>

#include "host/commands/commands.h"
#include "host/experiments/bounding-volumes/bounding_volumes_experiment.h"
#include "host/experiments/colour/colour_experiment.h"
#include "host/experiments/depth/depth_experiment.h"
#include "host/experiments/hierarchies/hierarchies_experiment.h"
#include "host/experiments/lighting/lighting_experiment.h"
#include "host/experiments/net-load/net_load_experiment.h"
#include "host/experiments/sampling/sampling_experiment.h"
#include "host/experiments/smoothing/smoothing_experiment.h"
#include "host/experiments/working-sets/working_sets.h"
#include "host/experiments/zones/zones_experiment.h"

namespace rayfarm {
namespace {

struct ExperimentChoice {
  std::string name;
  ExperimentOptions options;
};

int run_experiment(const ExperimentChoice& choice, const Renders& renders) {
  ExperimentOptions options = choice.options;
  if (options.output.empty()) options.output = "out/" + choice.name;
  if (choice.name == "bounding-volumes") return run_bounding_volumes_experiment(options);
  if (choice.name == "depth") return run_depth_experiment(options, renders.here);
  if (choice.name == "hierarchies") return run_hierarchies_experiment(options);
  if (choice.name == "net-load") return run_net_load_experiment(options, renders.here);
  if (choice.name == "sampling") return run_sampling_experiment(options, renders.here);
  if (choice.name == "smoothing") return run_smoothing_experiment(options);
  if (choice.name == "working-sets") return run_working_set_experiment(options);
  if (choice.name == "zones") return run_zones_experiment(options, renders.here);
  if (choice.name == "colour") return run_colour_experiment(options, renders.here);
  return run_lighting_experiment(options, renders.here);
}

}  // namespace

void add_experiment_command(CommandLine& line) {
  const auto choice = std::make_shared<ExperimentChoice>();
  ExperimentOptions& o = choice->options;
  Verb verb;
  verb.name = "experiment";
  verb.help = "repeat an experiment of the papers behind Rayfarm, and write a page about it";
  verb.examples = {
      {"rayfarm experiment sampling --seeds 1", "its page, pictures and plots go to out/sampling"}};
  verb.check = [choice](const auto&) {
    if (choice->name != "sampling" && (choice->options.samples || choice->options.seeds))
      throw UsageError("--samples and --seeds belong to the experiment sampling");
    if (choice->name != "hierarchies" && choice->options.is_picture_of_tests)
      throw UsageError("--picture belongs to the experiment hierarchies");
    if (!choice->options.is_picture_of_tests && !choice->options.scene.empty())
      throw UsageError("--scene belongs to --picture");
  };
  verb.run = [choice](const Renders& renders) { return run_experiment(*choice, renders); };
  Options options = line.add(std::move(verb));
  options
      .word(
          "NAME", [choice = choice.get()](const std::string& name) { choice->name = name; },
          {"bounding-volumes", "colour", "depth", "hierarchies", "lighting", "net-load", "sampling",
           "smoothing", "working-sets", "zones"},
          "bounding-volumes: what they, clusters and an item buffer save, Weghorst, Hooper and "
          "Greenberg 1984; colour: RGB and spectra at 4, 20 and any wavelengths, section 2.1 of Shirley, "
          "Sung and Brown; "
          "depth: "
          "limits of the lighting tree, section 2.3.4; hierarchies: what arranging primitives costs and "
          "saves, chapter 4; lighting: the pictures of the thesis's chapter 3; "
          "net-load: processor counts against the net's load, section 4.4.4.2; sampling: the accuracy of "
          "patterns, section 2.2.1 of Shirley, Sung and Brown; smoothing: the light of a turning mesh, "
          "section "
          "2.3.5; working-sets: Table 4.12; zones: errors, time and rays of zonal lighting against paths, "
          "section 3 of Shirley, Sung and Brown")
      .required();
  options.text("-o,--output", o.output, "folder for page, pictures and numbers (default: out/NAME)",
               "FOLDER");
  options.text("--scenes", o.scenes, "folder that holds the scenes (default: scenes)", "FOLDER");
  options.number("--width", o.width_px, 8, 65536, "of the pictures in pixels (default: the scenes')");
  options.number("--samples", o.samples, 2, 256, "sampling: the most per pixel (default: 256)");
  options.number("--seeds", o.seeds, 1, 1000, "sampling: pictures of each kind (default: 5)");
  options.word(
      "--picture",
      [choice = choice.get()](const std::string&) { choice->options.is_picture_of_tests = true; }, {"tests"},
      "hierarchies: only draw how many primitives the rays of each pixel test, for every hierarchy side by "
      "side");
  options.text("--scene", o.scene, "--picture: of this scene (default: the thesis's three images)", "FILE");
  options.text("--cluster", o.cluster,
               "net-load: the script that makes a virtual cluster (default: deploy/virtual-cluster)", "FILE");
}

}  // namespace rayfarm
