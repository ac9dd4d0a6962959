#pragma once
// What a page shows of a job: the last frames as 8-bit pictures with what changed in them, and how the farm
// does. The host's thread hands over copies; a thread of its own makes pictures of them, and those that serve
// pages read them.
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "host/view/subpolygon_queue.h"
#include "host/view/watcher.h"

namespace rayfarm {

class FarmView : public Watcher {
 public:
  /// Larger pictures are shown by every other pixel, or fewer.
  static constexpr int kLongestSide_px = 4096;

  /// As the user named them.
  FarmView(std::string scene, std::string output);
  ~FarmView() override;
  FarmView(const FarmView&) = delete;
  FarmView& operator=(const FarmView&) = delete;

  void begin(const WatchedJob& job) override;
  void see(const SeenSubpolygon& subpolygon) override { queue_.push(subpolygon); }
  void hear(FarmStatus status) override;
  /// The job is over; `outcome` says how, a line. Waits until all that was seen is in the pictures.
  void end(const std::string& outcome);

  // Any thread may ask:
  /// All but pictures, as JSON.
  std::string state() const;
  /// What was drawn after the first `since` updates, about 4 MB at most, little-endian: updates until now (8
  /// bytes), width and height of frames (2 each), how many records (4). A record: number of the frame (4,
  /// signed), node (2; 0: from a journal), x, y, width, height in the frame (2 each), and its pixels, row by
  /// row, 3 bytes of sRGB each.
  std::string updates(uint64_t since) const;

 private:
  struct Canvas {
    FrameIndex frame;
    FrameNumber number;
    uint64_t pixels_there = 0;  ///< of the picture, not of what is shown of it
    std::vector<uint8_t> rgb;
  };
  struct Update {
    uint64_t sequence;  ///< from 1
    FrameIndex frame;
    uint16_t node, x, y, width, height;
  };
  struct Speed {
    double now_s = 0, rays = 0;
    std::vector<uint64_t> node_rays;
  };

  void run();
  void draw(const SeenSubpolygon& subpolygon);
  /// None: the frame's picture was dropped.
  Canvas* canvas_of(const SeenSubpolygon& subpolygon);
  const Canvas* find(FrameIndex frame) const;
  void encode_pixel(const std::byte* pixel, uint8_t* rgb) const;

  const std::string scene_, output_;
  SubpolygonQueue queue_;
  // Of the job; set before the thread draws:
  WatchedJob job_;
  std::vector<uint8_t> srgb8_of_half_;  ///< by its 16 bits
  std::array<PixelChannel, 3> channels_;
  int step_ = 1, width_px_ = 0, height_px_ = 0;  ///< of what is shown

  mutable std::mutex mutex_;  ///< of the job and of all below
  std::deque<Canvas> canvases_;
  FrameIndex first_kept_;  ///< pictures of earlier frames were dropped
  std::deque<Update> updates_;
  uint64_t sequence_ = 0;

  mutable std::mutex status_mutex_;  ///< of all below: whoever reads pictures does not hold up the host
  std::shared_ptr<const FarmStatus> status_ = std::make_shared<FarmStatus>();
  std::deque<Speed> speeds_;  ///< of the last seconds
  std::string outcome_;

  std::thread thread_;
};

}  // namespace rayfarm
