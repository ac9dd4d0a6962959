#pragma once
// Rank 0 while the net works: it feeds the assignment's state machine with what comes from the nodes, carries
// out its actions, and puts pixels into frame buffers. Nothing in it waits for any single node.
#include <functional>

#include "common/image/image_file.h"
#include "host/farm/assignment.h"
#include "host/farm/frame_writer.h"
#include "host/farm/job_result.h"
#include "host/farm/progress.h"
#include "protocol/job_plan.h"
#include "protocol/liveness.h"
#include "protocol/transport.h"

namespace rayfarm {

struct FarmHostOptions {
  JobPlan plan;
  Image image;                                    ///< size, window and format of every frame; no pixels
  std::map<std::string, std::string> attributes;  ///< of every file
  std::vector<std::string> files;                 ///< one per frame of the pictures
  double node_timeout_s = liveness::kNodeTimeout_s;
  int window_frames = 3;           ///< in memory at a time
  bool keeps_costs = false;        ///< what each subpolygon took, in the result
  std::vector<ProcessSign> signs;  ///< of the nodes, in order; empty: none can be lost alone
  ProgressStyle progress = ProgressStyle::automatic;
};

/// Tells people what happens; the argument is one line of text.
using Tell = std::function<void(const std::string&)>;

class FarmHost {
 public:
  /// result.nodes holds all nodes.
  FarmHost(Transport& transport, const FarmHostOptions& options, JobResult& result, Tell tell);

  /// Until every frame is written or has failed, all nodes are lost, or the user interrupts. Frames that are
  /// whole are written in any case.
  void run();

 private:
  struct FrameBuffer {
    std::vector<std::byte> pixels;
    bool is_begun = false;
  };

  void receive(const Message& message, double now);
  void receive_control(NodeId node, const Control& control, double now);
  void receive_block(NodeId node, std::span<const std::byte> bytes, double now);
  void receive_pixels(NodeId node, std::span<const std::byte> bytes);
  void end_of_pixels(NodeId node, const SubpolygonReport& report, double now);
  /// `bytes`: of the pixels on the net.
  void keep_result(NodeId node, const SubpolygonReport& report, std::span<const std::byte> pixels,
                   size_t bytes, double now);
  void carry_out(const Action& action);
  void carry_out(const AssignItem& assign);
  void carry_out(const OpenedSteps& opened);
  void carry_out(const StepComplete& complete);
  void carry_out(const StepFailed& failed);
  void carry_out(const NodeLost& lost);
  void carry_out(const NodeReturned& returned);
  void carry_out(const AllNodesLost&);
  void take_written(double now);
  void tell_what_is_odd(const FrameResult& frame) const;
  void expel_the_gone(double now);
  void expel(NodeId node, const std::string& problem, double now);
  /// Throws ProtocolError if the phase has no such item.
  ItemIndex item_of(const SubpolygonReport& report) const;

  Transport& transport_;
  const FarmHostOptions& options_;
  const PicturesPhase& pictures_;  ///< the phase that is at work
  JobResult& result_;
  Tell tell_;
  FrameWriter writer_;
  ListeningClock listening_;  // before the assignment, which begins by it
  Assignment assignment_;
  Progress progress_;
  std::map<FrameNumber, FrameIndex> index_of_frame_;
  std::vector<FrameBuffer> frames_;
  std::vector<std::vector<PixelResult>> pixels_of_node_;  ///< pixel wire: of the subpolygon being returned
  std::vector<std::optional<StepIndex>> step_of_node_;    ///< the step last selected at each node
  bool is_waiting_for_any_ = false;                       ///< all nodes are lost, and it was told
  bool is_over_ = false;
};

}  // namespace rayfarm
