#pragma once
// Who looks at pictures while they grow. The host's thread tells them; they take note and return at once,
// because nobody who looks may hold up the work.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/image/image.h"
#include "protocol/index.h"
#include "protocol/messages.h"

namespace rayfarm {

/// What does not change while a job makes pictures.
struct WatchedJob {
  Image image;                     ///< size, window and layout of every frame; no pixels
  std::vector<std::string> files;  ///< of the frames, in order
};

/// A result that was kept. It is looked at during the call alone.
struct SeenSubpolygon {
  FrameIndex frame;
  FrameNumber number;
  NodeId node;  ///< that traced it; 0: it comes from a journal
  DisplayPolygon polygon;
  std::span<const std::byte> pixels;  ///< rows of the polygon, top to bottom, in the image's layout
};

enum class FarmStage : uint8_t { loading, zones, pictures, writing, ended };
inline constexpr std::array kFarmStageWords{"loading", "zones", "pictures", "writing", "ended"};

enum class NodeActivity : uint8_t { working, waiting, lost, failed };
inline constexpr std::array kNodeActivityWords{"working", "waiting", "lost", "failed"};

struct NodeStatus {
  NodeId id;
  std::string machine;
  uint32_t pid = 0;
  NodeActivity activity = NodeActivity::waiting;
  uint64_t items = 0;  ///< subpolygons, and items of zones, that it returned
  uint64_t rays = 0;   ///< of pictures
  double busy_s = 0;
  std::string problem;  ///< for which it failed
};

struct TrafficStatus {
  std::string command;
  uint64_t messages = 0, bytes = 0;
};

/// How the farm does, a few times a second.
struct FarmStatus {
  FarmStage stage = FarmStage::loading;
  double now_s = 0;      ///< see now_s()
  double elapsed_s = 0;  ///< of work on pictures; in the stage of zones, of work on these
  std::optional<double> left_s;
  uint64_t pixels_done = 0, pixels_total = 0;
  uint64_t rays = 0;
  size_t frames_written = 0, frames_failed = 0;
  uint64_t result_bytes = 0;   ///< of pictures, on the net
  uint64_t result_pixels = 0;  ///< that came in them
  std::vector<TrafficStatus> traffic;
  int zone_rounds = 0;
  double zone_unsent = 1;  ///< part of all primary power
  uint64_t zone_rays = 0;
  std::vector<NodeStatus> nodes;
};

class Watcher {
 public:
  virtual ~Watcher() = default;
  /// Before all else, once.
  virtual void begin(const WatchedJob& job) = 0;
  virtual void see(const SeenSubpolygon& subpolygon) = 0;
  virtual void hear(FarmStatus status) = 0;
};

}  // namespace rayfarm
