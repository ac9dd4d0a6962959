#pragma once
// Rank 0 while the net works: it decides which phase comes next, feeds the assignment's state machine with
// what comes from the nodes, and carries out its actions. Nothing in it waits for any single node.
#include "host/farm/pictures_host.h"
#include "host/farm/zones_host.h"
#include "protocol/phase_data.h"

namespace rayfarm {

class FarmHost {
 public:
  /// result.nodes holds all nodes.
  FarmHost(Transport& transport, const FarmHostOptions& options, JobResult& result, Tell tell);

  /// For each group of frames: light is spread over zones, if pictures read any, then pictures are made.
  /// Until every frame is written or has failed, all nodes are lost, zones fail, or the user interrupts.
  /// Frames that are whole are written in any case.
  void run();

 private:
  /// What pictures of a group read of zones; nothing if the job is over.
  std::optional<Bytes> solve_zones(const FrameGroup& group);
  Bytes spread(ZoneSolver& solver, FrameNumber frame);
  void make_pictures(const FrameGroup& group, Bytes solution);
  /// All nodes hold `data` before they do an item.
  void run_phase(PhaseHost& phase, uint64_t address, Bytes data);
  bool take_messages(double now);
  bool take_blocks(double now);
  void receive(Message message, double now);
  void receive_control(NodeId node, const Control& control, double now);
  void receive_failure(NodeId node, const ItemFailed& failed, double now);
  void carry_out(const Action& action);
  void carry_out(const AssignItem& assign) { phase_->assign(assign); }
  void carry_out(const OpenedSteps& opened);
  void carry_out(const StepComplete& complete) { phase_->complete(complete.step, listening_.now()); }
  void carry_out(const StepFailed& failed) { phase_->fail(failed, listening_.now()); }
  void carry_out(const NodeLost& lost);
  void carry_out(const NodeReturned& returned);
  void carry_out(const AllNodesLost&);
  void expel_the_gone(double now);
  void expel(NodeId node, const std::string& problem, double now);
  void tell_if_none_is_heard();
  void show_progress(bool at_end);
  /// To those who watch, a few times a second.
  void tell_watchers(FarmStage stage, double now);

  Transport& transport_;
  const FarmHostOptions& options_;
  JobResult& result_;
  Tell tell_;
  ListeningClock listening_;  // before the assignment, which begins by it
  Assignment assignment_;
  PicturesHost pictures_;
  ZonesHost zones_;
  PhaseHost* phase_ = nullptr;    ///< at work
  uint32_t next_number_ = 0;      ///< of the phase that will begin next
  std::optional<DataFeed> feed_;  ///< of the phase at work
  Progress progress_;
  std::vector<NodeId> watched_;  ///< processes of this machine
  size_t next_watched_ = 0;
  double phase_began_s_ = 0;  ///< see now_s, as all these
  double traced_s_ = 0;       ///< when the last pixels came
  double looked_s_ = 0;       ///< until when watched_ was looked through
  double ticked_s_ = 0, watchers_told_s_ = 0;
  bool is_waiting_for_any_ = false;  ///< all nodes are lost, and it was told
  bool is_over_ = false;
};

}  // namespace rayfarm
