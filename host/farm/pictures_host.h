#pragma once
// Pictures: pixels go into frame buffers, and whole frames to their files.
#include <map>
#include <optional>

#include "host/farm/block_decoders.h"
#include "host/farm/farm_options.h"
#include "host/farm/job_result.h"
#include "host/farm/phase_host.h"
#include "host/farm/picture_files.h"

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
  void receive_block(NodeId node, Bytes message, double now);
  void receive_pixels(NodeId node, std::span<const std::byte> bytes);
  void end_of_pixels(NodeId node, const SubpolygonReport& report, double now);

  /// Blocks that were received and are being decompressed, or were: `keep_block` is to follow each.
  bool has_blocks() const { return decoders_.has_work(); }
  std::optional<BlockDecoders::Decoded> take_block() { return decoders_.try_take(); }
  /// Throws ProtocolError if it is damaged.
  void keep_block(const BlockDecoders::Decoded& decoded, double now);

  /// Takes note of frames that were written.
  void take_written(double now);
  /// Waits until all frames that are whole are written, and what there is of others is in their journals.
  /// `with_previews`: pictures of these, too.
  void finish(double now, bool with_previews);

  const Phase& phase() const override { return phase_; }
  PhaseWork work() override;
  void assign(const AssignItem& assign) override;
  std::string name_of(ItemIndex item) const override;
  void complete(StepIndex step, double now) override;
  void fail(const StepFailed& failed, double now) override;
  void forget(NodeId node) override;

 private:
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
  /// Into the frame's buffer.
  void store(const BlockResult& result);
  /// To those who watch.
  void show(NodeId node, const BlockResult& result) const;
  /// Throws ProtocolError if there is no such pass, or it has more or fewer bytes.
  void check_size(const BlockResult& result) const;
  /// An item that needs no work: a journal has brought it, or its frame failed. Reads the journals of frames
  /// when they are first asked for.
  bool needs_no_work(ItemIndex item);
  ItemIndex first_item_of(FrameIndex frame) const;
  /// What of a picture that is larger than its memory may be handed out.
  ItemIndex end_of_room();
  /// The step needs no more memory.
  void release(StepIndex step, double now);
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
  PictureFiles files_;
  JournalWriter journal_;
  std::vector<bool> has_journal_;  ///< by frame of the job
  /// Of frames at work: by item of the frame (its passes, one after the other), what a journal of an earlier
  /// run has brought. Empty: there was none.
  std::map<FrameIndex, std::vector<bool>> resumed_;
  StepIndex room_step_;                               ///< whose picture has the memory, where only one has
  std::map<FrameNumber, FrameIndex> index_of_frame_;  ///< among the job's
  std::vector<std::vector<PixelResult>> pixels_of_node_;  ///< pixel wire: of the subpolygon being returned
  std::vector<std::optional<StepIndex>> step_of_node_;    ///< the step last selected at each node
  BlockDecoders decoders_;
};

}  // namespace rayfarm
