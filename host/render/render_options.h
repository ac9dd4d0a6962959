#pragma once
// What a render is asked for.
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/description/scene_description.h"
#include "common/hierarchy/builder.h"
#include "common/image/image_file.h"
#include "common/scene/render_settings.h"
#include "host/bake/bake_options.h"
#include "host/farm/progress.h"
#include "host/view/tev_display.h"
#include "protocol/job_plan.h"

namespace rayfarm {

struct RenderOptions {
  std::string scene;
  std::string output;
  std::string frames;  ///< empty: the scene's, or frame 0
  std::optional<std::array<int, 2>> size_px;
  std::optional<Fit> fit;
  std::optional<std::array<int, 4>> crop;   ///< x0, x1, y0, y1, half-open
  std::optional<SourcePlace> crop_place;    ///< where the scene asks for it
  RenderSettings settings;                  ///< size, crop and pixel format are set when the scene is known
  std::optional<PixelFormat> pixel_format;  ///< empty: what the output file holds
  std::optional<Subpixels> subpixels;       ///< empty: one
  /// Limits of the lighting tree; empty: what follows from the others and the lighting model.
  std::optional<uint32_t> max_depth, max_reflections, max_transmissions;
  AssignmentPolicy policy = AssignmentPolicy::on_demand;
  Wire wire = Wire::block;
  bool compresses = true;
  SetPattern sets = SetPattern::lattice;  ///< interleaved
  bool rotates = true;                    ///< interleaved: sets move on from frame to frame
  int subpolygons_per_processor = kSubpolygonsPerProcessor;
  std::optional<int> least_side_px;  ///< of a subpolygon; empty: the wire's
  double ray_time_s = 0;             ///< of emulated processors; 0: none
  std::vector<double> time_factors;  ///< of emulated processors
  LoadOptions load;
  BuildOptions build;
  int local_nodes = 0;  ///< 0: one per core
  double node_timeout_s = liveness::kNodeTimeout_s;
  double frame_memory_GiB = 1;  ///< that pixels of frames in the making may take on the host
  int passes = 1;               ///< of each picture, which can be looked at after each
  bool skip_existing = false;
  bool resume = false;         ///< goes on from journals of an earlier run
  double journal_every_s = 2;  ///< between two times that journals are written to the disk; 0: none are kept
  double most_time_s = 0;      ///< from the beginning, after which the job stops; 0: as long as it takes
  std::string stats, cost_map;
  std::optional<BakeOptions> bake;  ///< the light of zones is written in place of pictures
  std::string zones_file;           ///< where the light of zones is kept; empty: nowhere
  ProgressStyle progress = ProgressStyle::automatic;
  std::optional<int> view_port;       ///< where a page shows the job; 0: at any port that is free
  std::optional<TevAddress> display;  ///< of a viewer that pictures are sent to while they grow
  bool is_quiet = false, is_verbose = false, is_full_report = false;

  /// These options and those that the loaded scene asks for beside them; unset: it is not asked. Throws
  /// InputError and JobError.
  std::function<RenderOptions(const SceneDescription&)> adopt;

  /// Of a subpolygon: what was asked for, or the wire's.
  int least_side() const { return least_side_px.value_or(least_side_of(wire)); }
};

}  // namespace rayfarm
