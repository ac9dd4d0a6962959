#pragma once
// What a farm is told about its job.
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/image/image_file.h"
#include "common/lighting/zones/zone_solver.h"
#include "host/farm/journal.h"
#include "host/farm/progress.h"
#include "host/view/watcher.h"
#include "protocol/job_plan.h"
#include "protocol/liveness.h"

namespace rayfarm {

/// Frames that follow each other and share a pose: nothing moves between them but the camera.
struct FrameGroup {
  FrameIndex first;
  int count = 0;
};

/// Where pictures take light from zones: one solution for each group of frames, known by its first frame.
struct ZonesOfJob {
  /// Empty: pictures need none.
  std::function<std::unique_ptr<ZoneSolver>(FrameNumber frame)> make_solver;
  /// A solution that is there already; may be empty.
  std::function<std::optional<Bytes>(FrameNumber frame)> find;
  /// Given each that was found by work; may be empty.
  std::function<void(FrameNumber frame, std::span<const std::byte> solution)> keep;
  /// Given each in place of pictures, of which none are made then; may be empty.
  std::function<void(FrameNumber frame, Bytes solution)> take;
};

/// Results that are kept on disk until a frame's file is whole, for a job that has to go on later.
struct JournalsOfJob {
  double every_s = 0;  ///< between two times that the disk is written; 0: nothing is kept
  JournalLines lines;  ///< of all frames
  /// By the job's frames: journals of an earlier run, whose results need no work. They go on.
  std::map<FrameIndex, JournalHead> found;
};

/// Of frames that come in passes, as many as the plan's pictures have.
struct PassesOfJob {
  uint32_t samples = 1;      ///< of a pixel, in all passes
  size_t running_bytes = 0;  ///< of a pixel, between two passes
};

struct FarmHostOptions {
  JobPlan plan;
  std::vector<FrameGroup> groups;  ///< all frames of the plan's pictures, in order; empty: they are one group
  ZonesOfJob zones;
  JournalsOfJob journals;
  PassesOfJob passes;
  Image image;                                    ///< size, window and format of every frame; no pixels
  std::map<std::string, std::string> attributes;  ///< of every file
  std::vector<std::string> files;                 ///< one per frame of the pictures
  double node_timeout_s = liveness::kNodeTimeout_s;
  int window_frames = 3;  ///< in memory at a time
  /// What a frame's pixels may take of it; a larger one leaves for its file in bands (see FrameBuffer).
  size_t frame_bytes = std::numeric_limits<size_t>::max();
  // In the result, by subpolygon of every frame that was begun:
  bool keeps_traced_by = false;
  bool keeps_costs = false;
  std::vector<ProcessSign> signs;  ///< of the nodes, in order; empty: none can be lost alone
  ProgressStyle progress = ProgressStyle::automatic;
  std::vector<Watcher*> watchers;  ///< who else looks at pictures while they grow

  size_t picture_bytes() const { return static_cast<size_t>(image.window.area()) * image.layout.bytes; }
  bool is_streamed() const { return picture_bytes() > frame_bytes; }
  /// Of the largest band.
  size_t band_bytes() const {
    return static_cast<size_t>(plan.pictures.grid.most_row_height()) *
           static_cast<size_t>(image.window.width()) * image.layout.bytes;
  }
};

/// Tells people what happens; the argument is one line of text.
using Tell = std::function<void(const std::string&)>;

}  // namespace rayfarm
