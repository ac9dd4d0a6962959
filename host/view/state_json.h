#pragma once
// The state of a job as JSON, for pages and programs.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "host/view/watcher.h"

namespace rayfarm {

struct StateOfJob {
  std::string scene, output;
  std::string outcome;  ///< empty: it is not over
  std::shared_ptr<const FarmStatus> status;
  uint64_t updates = 0;  ///< of pictures, until now
  uint64_t dropped = 0;  ///< results that are not shown, because the view was too slow
  std::array<int, 2> image_px{};
  PixelRect window{};
  std::array<int, 2> shown_px{};
  size_t frames_total = 0;
  struct Frame {
    FrameNumber number;
    double share = 0;  ///< of its pixels that are there
  };
  std::vector<Frame> frames;            ///< whose pictures are kept
  double rays_per_s = 0;                ///< in the last seconds
  std::vector<double> node_rays_per_s;  ///< the same of each node; may be shorter than the nodes
};

std::string to_json(const StateOfJob& state);

}  // namespace rayfarm
