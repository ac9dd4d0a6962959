#pragma once
// The command line: long GNU options in any order.
#include <optional>
#include <string>

#include "common/hierarchy/builder.h"
#include "common/image/image_file.h"
#include "common/scene/render_settings.h"
#include "host/net/net_options.h"
#include "host/progress.h"
#include "protocol/job_plan.h"

namespace rayfarm {

struct RenderOptions {
  std::string scene;
  std::string output;
  std::string frames;  ///< empty: the scene's, or frame 0
  std::optional<std::array<int, 2>> size_px;
  std::optional<std::array<int, 4>> crop;   ///< x0, x1, y0, y1, half-open
  RenderSettings settings;                  ///< size, crop and pixel format are set when the scene is known
  std::optional<PixelFormat> pixel_format;  ///< empty: what the output file holds
  std::optional<uint32_t> max_depth;        ///< empty: by the lighting model
  AssignmentPolicy policy = AssignmentPolicy::on_demand;
  Wire wire = Wire::block;
  bool compresses = true;
  bool rotates = true;  ///< interleaved: sets move on from frame to frame
  int subpolygons_per_processor = kSubpolygonsPerProcessor;
  double ray_time_s = 0;             ///< of emulated processors; 0: none
  std::vector<double> time_factors;  ///< of emulated processors
  SplitRule split_rule = SplitRule::sah;
  uint32_t max_primitives = 8;  ///< in a leaf of the hierarchy
  int local_nodes = 0;          ///< 0: one per core
  double node_timeout_s = liveness::kNodeTimeout_s;
  bool skip_existing = false;
  std::string stats, cost_map;
  ProgressStyle progress = ProgressStyle::automatic;
  bool is_quiet = false, is_verbose = false, is_full_report = false;
};

struct CompareOptions {
  std::string a, b;
  double tolerance = 0;  ///< largest difference of a channel that counts as equal
  double share = 0;      ///< of pixels that may differ by more, 0 to 1
};

struct ExperimentOptions {
  std::string name;
  std::string output;
  std::string scenes = "scenes";                   ///< the folder that holds them
  int width_px = 0;                                ///< of the pictures; 0: as the scenes have it
  std::string cluster = "deploy/virtual-cluster";  ///< the program that makes one
};

enum class CommandKind { render, check, info, compare, experiment, model, simulate, none };

struct CommandLine {
  CommandKind kind = CommandKind::none;
  RenderOptions render;
  std::string scene;  ///< of check and info
  CompareOptions compare;
  ExperimentOptions experiment;
  ModelOptions model;
  SimulateOptions simulate;
  int exit_code = 0;    ///< for kind none: help and version give 0, errors 2
  std::string message;  ///< for kind none: what to print
};

CommandLine parse_command_line(int argc, char** argv);

}  // namespace rayfarm
