#pragma once
// Pictures in the making: what comes of them goes into their buffers, and whole bands of these to their
// files.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/farm/farm_options.h"
#include "host/farm/frame_buffer.h"
#include "host/farm/frame_writer.h"
#include "host/farm/job_result.h"

namespace rayfarm {

/// Frames are known by their places among the job's.
class PictureFiles {
 public:
  PictureFiles(const FarmHostOptions& options, JobResult& result, const Tell& tell);

  /// The frame has a buffer from now on, if it has none.
  void begin(FrameIndex frame);

  /// Subpolygons of a frame that has begun, before this one, have room.
  SubpolygonId end_of_room(FrameIndex frame) const;
  /// The same of one of them, after waiting for the disk, if that would make room and the user does not
  /// interrupt. `turn` is called while it waits.
  bool comes_to_have_room(FrameIndex frame, SubpolygonId subpolygon, const std::function<void()>& turn);

  /// The pixels of a subpolygon, and what its next pass goes on from.
  void store(FrameIndex frame, const BlockResult& result);
  const Bytes& running(FrameIndex frame, SubpolygonId subpolygon) const {
    return frames_[frame.place()].running[subpolygon.place()];
  }
  /// The picture that all passes up to this one make, into the frame's own file.
  void write_pass(FrameIndex frame, int pass);
  /// All of it is stored.
  void complete(FrameIndex frame);
  /// Nothing comes of it.
  void drop(FrameIndex frame);

  /// Takes note of what was written. Gives the frames that are written or could not be, each once, with what
  /// came of them in the job's result.
  std::vector<FrameIndex> take_written();
  /// Waits until all that are complete are written, and drops all others.
  void finish();

  /// Of its pixels, in all passes.
  double share_there(FrameIndex frame) const;
  uint64_t pixels_there(FrameIndex frame) const { return frames_[frame.place()].pixels_there; }
  /// A picture of what there is of a frame that is not whole, and its file's name; empty if there is nothing
  /// to be seen.
  std::string write_preview(FrameIndex frame);

 private:
  struct Frame {
    std::unique_ptr<FrameBuffer> buffer;  ///< null: no result has come, or all is written
    /// By subpolygon: what its next pass goes on from; empty where there is one pass.
    std::vector<Bytes> running;
    uint64_t pixels_there = 0;  ///< of all passes
    std::optional<PictureInWriting> writing;
    int bands_in_writing = 0;
    bool is_pass_in_writing = false, is_complete = false;
  };

  bool is_last_pass(int pass) const { return pass + 1 == options_.plan.pictures.passes; }
  FrameWriter::Job job_of(FrameIndex frame) const;
  void take_bands();

  const FarmHostOptions& options_;
  JobResult& result_;
  const Tell& tell_;
  std::vector<Frame> frames_;
  FrameWriter writer_;  // last: it looks at bands of the others
};

}  // namespace rayfarm
