#pragma once
// Writes pictures in a thread of its own, band by band as they come, so that the host never keeps its nodes
// waiting for a disk. What a picture in the making takes is that of an ImageWriter and of the bands that
// wait.
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "common/files/sha256.h"
#include "common/image/image_writer.h"
#include "protocol/index.h"

namespace rayfarm {

/// A picture that is being written, by the order in which they were begun.
using PictureInWriting = Index<struct PictureInWritingKind, int64_t>;

/// A picture to write.
struct PictureJob {
  FrameIndex frame;
  std::string path;
  Image image;  ///< its pixels come in bands
  std::map<std::string, std::string> attributes;
  bool is_last_pass = true;         ///< the frame is whole with it
  std::vector<std::string> late{};  ///< names of attributes whose values come at the end
};

/// All but what its thread does is for one thread at a time.
class FrameWriter {
 public:
  using Job = PictureJob;
  struct Written {
    FrameIndex frame;
    bool is_last_pass = true;
    std::string problem;    ///< empty: the file is in place
    std::string sha256;     ///< of all pixels' bytes in order; empty if there is a problem
    bool is_black = false;  ///< all bytes are 0
    double seconds = 0;     ///< at work
    PictureInWriting picture;
  };
  /// A band that is let go of: written, or swallowed because its picture had failed.
  struct BandWritten {
    FrameIndex frame;
    int rows = 0;
    PictureInWriting picture;
  };

  FrameWriter();
  /// As finish().
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Each picture ends by `end` or `drop`. Several may be in writing, of one frame too: the file is then that
  /// of the last that ends.
  PictureInWriting begin(Job job);
  /// The next whole rows of the window, from the top. They may not change any more.
  void write(PictureInWriting picture, std::shared_ptr<const std::vector<std::byte>> rows);
  /// All rows are there. `late`: values of at most kLateAttributeBytes.
  void end(PictureInWriting picture, std::map<std::string, std::string> late = {});
  /// It will not be whole: nothing is left of it, nor told, unless that is of a failure before, or of bands
  /// that were let go of.
  void drop(PictureInWriting picture);

  /// What came of a picture: once, at its end, or as soon as it could not be written.
  std::optional<Written> try_take();
  std::optional<BandWritten> try_take_band();
  /// Waits until all pictures that were ended are written, and drops the others; what came of them can still
  /// be taken.
  void finish();

 private:
  struct Begin {
    Job job;
  };
  struct Band {
    std::shared_ptr<const std::vector<std::byte>> rows;
  };
  struct End {
    std::map<std::string, std::string> late;
  };
  struct Drop {};
  struct Order {
    PictureInWriting picture;
    std::variant<Begin, Band, End, Drop> what;
  };
  /// What the thread knows of a picture.
  struct Open {
    Written written;
    size_t row_bytes = 0;
    Sha256 sum;
    std::unique_ptr<ImageWriter> writer;  ///< none: it has failed
  };

  void submit(Order order);
  void run();
  void carry_out(Order order);
  static void take(Open& open, const Begin& begin);
  static void take(Open& open, const Band& band);
  static void take(Open& open, const End& end);
  static void take(Open&, const Drop&) {}

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Order> queue_;
  std::deque<Written> written_;
  std::deque<BandWritten> bands_;
  bool is_ending_ = false;
  PictureInWriting next_;
  std::map<PictureInWriting, Open> open_;  ///< the thread's own
  std::thread thread_;
};

}  // namespace rayfarm
