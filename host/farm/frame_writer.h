#pragma once
// Writes frames in a thread of its own, so that the host never keeps its nodes waiting for a disk.
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/image/image_file.h"
#include "protocol/index.h"

namespace rayfarm {

class FrameWriter {
 public:
  struct Job {
    FrameIndex frame;
    std::string path;
    Image image;
    std::map<std::string, std::string> attributes;
    bool is_last_pass = true;  ///< the frame is whole with it
  };
  struct Written {
    FrameIndex frame;
    bool is_last_pass = true;
    std::string problem;    ///< empty: the file is in place
    std::string sha256;     ///< of the pixels' bytes
    bool is_black = false;  ///< all bytes are 0
    double seconds = 0;
  };

  FrameWriter();
  /// Waits until all frames are written.
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  void submit(Job job);
  std::optional<Written> try_take();
  /// Waits until all frames are written; what came of them can still be taken.
  void finish();

 private:
  void run();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> queue_;
  std::deque<Written> written_;
  bool is_ending_ = false;
  std::thread thread_;
};

}  // namespace rayfarm
