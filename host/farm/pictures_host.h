#pragma once
// Pictures: pixels go into frame buffers, and whole frames to their files.
#include <map>
#include <optional>
#include <set>

#include "host/farm/farm_options.h"
#include "host/farm/frame_writer.h"
#include "host/farm/job_result.h"
#include "host/farm/phase_host.h"

namespace rayfarm {

class PicturesHost : public PhaseHost {
 public:
  /// Fills result.frames with all frames of the job.
  PicturesHost(Transport& transport, const FarmHostOptions& options, JobResult& result, const Tell& tell,
               Assignment& assignment);

  /// These frames are at work until `end`.
  void begin(const FrameGroup& group);
  void end() { is_at_work_ = false; }

  /// These throw ProtocolError if what came means nothing; what is not of the phase at work is dropped.
  void receive_block(NodeId node, std::span<const std::byte> bytes, double now);
  void receive_pixels(NodeId node, std::span<const std::byte> bytes);
  void end_of_pixels(NodeId node, const SubpolygonReport& report, double now);

  /// Takes note of frames that were written.
  void take_written(double now);
  /// Waits until all frames that are whole are written, and what there is of others is in their journals.
  /// `with_previews`: pictures of these, too.
  void finish(double now, bool with_previews);

  const Phase& phase() const override { return phase_; }
  PhaseWork work() const override;
  void assign(const AssignItem& assign) override;
  std::string name_of(ItemIndex item) const override;
  void complete(StepIndex step, double now) override;
  void fail(const StepFailed& failed, double now) override;
  void forget(NodeId node) override;

 private:
  struct FrameBuffer {
    std::vector<std::byte> pixels;
    std::vector<bool> is_there;  ///< by subpolygon; empty: no result has come
    int64_t pixels_there = 0;    ///< of all passes
    /// By subpolygon: what its next pass goes on from; empty where there is one pass.
    std::vector<Bytes> running;
    bool is_pass_in_writing = false;
  };

  const PicturesPhase& pictures() const { return std::get<PicturesPhase>(phase_); }
  /// Among the job's frames.
  FrameIndex of_job(StepIndex step) const {
    return FrameIndex(pictures().first.value() + pictures().frame_of(step).value());
  }
  bool is_last_pass(StepIndex step) const { return pictures().pass_of(step) + 1 == pictures().passes; }
  const std::string& file_of(FrameNumber frame) const {
    return result_.frames[index_of_frame_.at(frame).place()].file;
  }
  /// Throws ProtocolError if the job has no such subpolygon.
  void check(const SubpolygonReport& report) const;
  /// Nothing if it is not of the phase at work.
  std::optional<ItemIndex> item_of(const SubpolygonReport& report, int pass) const;
  /// `result` with its pixels as they are; `bytes`: of these on the net. True if it was news.
  bool keep_result(NodeId node, const BlockResult& result, size_t bytes, double now);
  /// Into the frame buffer. Throws ProtocolError if the pixels are not those of the subpolygon.
  void store(const BlockResult& result);
  /// To those who watch.
  void show(NodeId node, const BlockResult& result) const;
  /// Throws ProtocolError if there is no such pass, or it has more or fewer bytes.
  void check_size(const BlockResult& result) const;
  /// The picture that the passes until now make, into the frame's own file.
  void write_pass(StepIndex step);
  Bytes pixels_of(const BlockResult& block) const;
  void begin_frame(FrameIndex frame);
  /// What is in the frame's journal needs no work.
  void resume(FrameIndex frame, const JournalHead& head);
  void tell_of_unfinished(bool with_previews);
  void tell_what_is_odd(const FrameResult& frame) const;

  Transport& transport_;
  const FarmHostOptions& options_;
  JobResult& result_;
  const Tell& tell_;
  Assignment& assignment_;
  Phase phase_;
  bool is_at_work_ = false;
  FrameWriter writer_;
  JournalWriter journal_;
  std::set<ItemIndex> resumed_;  ///< of the phase at work: what journals of an earlier run brought
  std::map<FrameNumber, FrameIndex> index_of_frame_;      ///< among the job's
  std::vector<FrameBuffer> frames_;                       ///< of the job
  std::vector<std::vector<PixelResult>> pixels_of_node_;  ///< pixel wire: of the subpolygon being returned
  std::vector<std::optional<StepIndex>> step_of_node_;    ///< the step last selected at each node
};

}  // namespace rayfarm
