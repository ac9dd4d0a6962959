#pragma once
// Stages of zones: what nodes answer goes to the solver, each item once.
#include "common/lighting/zones/zone_solver.h"
#include "host/farm/job_result.h"
#include "host/farm/phase_host.h"

namespace rayfarm {

/// What an item of zones answers at most, uncompressed.
inline constexpr size_t kMostZoneResultBytes = size_t{1} << 30;

class ZonesHost : public PhaseHost {
 public:
  ZonesHost(Transport& transport, const JobPlan& plan, JobResult& result, Assignment& assignment)
      : transport_(transport), plan_(plan), result_(result), assignment_(assignment) {}

  /// The stage is phase `number`; the solver takes its results until `end`. Throws std::runtime_error if the
  /// stage has more units or items than can be addressed.
  void begin(const ZoneStage& stage, FrameNumber frame, uint32_t number, ZoneSolver& solver);
  void end() { solver_ = nullptr; }
  bool is_at_work() const { return solver_ != nullptr; }
  ZoneProgress progress() const { return solver_->progress(); }

  /// A return result in the zone form. Throws ProtocolError if it means nothing; one of a phase that is over
  /// is dropped.
  void receive(NodeId node, std::span<const std::byte> message, double now);

  const Phase& phase() const override { return phase_; }
  PhaseWork work() override;
  void assign(const AssignItem& assign) override;
  std::string name_of(ItemIndex item) const override;
  void complete(StepIndex step, double now) override { assignment_.release(step, now); }
  void fail(const StepFailed& failed, double now) override;
  void forget(NodeId) override {}

 private:
  const ZonePhase& zones() const { return std::get<ZonePhase>(phase_); }

  Transport& transport_;
  const JobPlan& plan_;
  JobResult& result_;
  Assignment& assignment_;
  Phase phase_ = ZonePhase();
  std::string name_;
  uint32_t number_ = 0;
  ZoneSolver* solver_ = nullptr;
};

}  // namespace rayfarm
