// The host's part of progressive refinement: it holds the sums.
#include <fmt/core.h>

#include <algorithm>

#include "common/lighting/zones/measured_light.h"
#include "common/lighting/zones/shooting.h"
#include "common/lighting/zones/zone_solution.h"
#include "common/lighting/zones/zone_solver.h"

namespace rayfarm {
namespace {

class ZonalSolver : public ZoneSolver {
 public:
  ZonalSolver(const Scene& scene, const RenderSettings& settings, int frame)
      : settings_(settings),
        zones_(scene, settings, frame),
        mirrors_(zones_.map()),
        measured_(zones_),
        emitted_(slots()),
        unsent_(slots()),
        next_(slots()) {}

  std::optional<ZoneStage> next_stage() override {
    if (stage_) end_stage();
    if (solved_.size() == zones_.passes()) return std::nullopt;
    const auto pass = static_cast<uint32_t>(solved_.size());
    if (!stage_) {
      head_ = {ZoneStageKind::light, pass, 0, {}, 0, 1};
      current_.emplace(slots());
      unsent_.clear();
      stage_ = ZoneStageKind::light;
      const uint64_t batch =
          std::max<uint64_t>(1, settings_.zones.batch / (uint64_t{2} * settings_.zones.samples));
      measured_.begin(batch);
      return make_stage("light from sources", measured_.units(), batch);
    }
    if (stage_ == ZoneStageKind::light && mirrors_.count() > 0) {
      head_.kind = ZoneStageKind::mirrors;
      stage_ = ZoneStageKind::mirrors;
      const uint64_t points = settings_.zones.samples;
      return make_stage("light by mirrors and glass", mirrors_.count(),
                        std::max<uint64_t>(1, settings_.zones.batch / points));
    }
    return next_round();
  }

  void add(uint64_t item, std::span<const std::byte> result) override {
    if (stage_ == ZoneStageKind::light) {
      measured_.add(item, result);
      return;
    }
    PackedReader in(result);
    const Power sent = in.power(), absorbed = in.power(), escaped = in.power();
    PowerSums kept(slots()), direct(slots());
    Power left = sent;  // what was sent is somewhere, to the quantum
    left -= absorbed;
    left -= escaped;
    bool is_sound = is_possible(sent) && is_possible(absorbed) && is_possible(escaped);
    in.sums(slots(), [&](uint64_t slot, const Power& power) {
      is_sound = is_sound && is_possible(power) && is_possible(left);
      if (is_sound) left -= power;
      kept[slot] = power;
    });
    in.sums(slots(), [&](uint64_t slot, const Power& power) {
      is_sound = is_sound && is_possible(power);
      direct[slot] = power;
    });
    in.expect_end();
    if (!is_sound || !left.is_zero()) throw PackedReader::damaged();
    if (stage_ == ZoneStageKind::mirrors) current_->primary += sent;
    current_->absorbed += absorbed;
    current_->escaped += escaped;
    kept.for_each([&](uint64_t slot, const Power& power) { next_[slot] += power; });
    direct.for_each([&](uint64_t slot, const Power& power) { current_->direct[slot] += power; });
  }

  ZoneProgress progress() const override {
    ZoneProgress progress;
    progress.rounds = static_cast<int>(head_.round);
    progress.rays = rays_;
    const double primary = current_ ? current_->primary.total() : 0;
    progress.unsent = (stage_ == ZoneStageKind::shoot || stage_ == ZoneStageKind::emit) && primary > 0
                          ? unsent_total_ / primary
                          : 1;
    return progress;
  }

  std::vector<std::byte> solution() const override { return encode_zone_solution(solved_); }

 private:
  uint64_t slots() const { return zones_.slot_count(); }
  const Scene& scene() const { return zones_.scene(head_.pass); }

  ZoneStage make_stage(const std::string& name, uint64_t units, uint64_t units_per_item) {
    PackedWriter out;
    write(out, head_);
    if (head_.kind == ZoneStageKind::emit) out.sums(emitted_);
    if (head_.kind == ZoneStageKind::shoot) out.sums(sending_ ? *sending_ : unsent_);
    return {name, out.take(), units, units_per_item};
  }

  void end_light() {
    Color primary = measured_.total();
    const std::vector<std::pair<uint64_t, Color>> shot = find_shot(zones_, scene(), settings_.zones);
    for (const auto& [slot, power] : shot) primary += power;
    head_.quantum = ZoneQuantum(primary);
    current_->quantum = head_.quantum;
    measured_.for_each([](const Color&) {},
                       [&](uint64_t slot, const Color& direct, const Color& by_chance) {
                         const Power from_sources = head_.quantum.quantized(direct),
                                     by_others = head_.quantum.quantized(by_chance);
                         current_->direct[slot] += from_sources;
                         Power both = from_sources;
                         both += by_others;
                         current_->primary += both;
                         keep(slot, both);
                       });
    for (const auto& [slot, power] : shot) {
      const Power quanta = head_.quantum.quantized(power);
      current_->primary += quanta;
      emitted_[slot] += quanta;  // what is emitted is seen as such, and not counted as reflected
    }
    measured_.begin(1);
  }

  /// Power that a zone got: it is to be sent on, unless its material doesn't.
  void keep(uint64_t slot, const Power& power) {
    current_->total[slot] += power;
    if (is_sent_on(zones_, slot))
      unsent_[slot] += power;
    else
      current_->absorbed += power;
  }

  void end_stage() {
    if (stage_ == ZoneStageKind::light) end_light();
    if (stage_ == ZoneStageKind::emit) {
      emitted_.clear();
      ++head_.round;
    }
    if (stage_ == ZoneStageKind::shoot) {
      if (sending_) {  // the others keep what they have
        sending_->for_each([&](uint64_t slot, const Power& power) { unsent_[slot] -= power; });
        sending_.reset();
      } else {
        unsent_.clear();
      }
      ++head_.round;
    }
    next_.for_each([&](uint64_t slot, const Power& power) { keep(slot, power); });
    next_.clear();
  }

  /// Sums have room for light that is sent on so often, and no more. Where all send in each round, what the
  /// rounds to come would add is foreseen from how fast what is unsent gets less: it falls ever more evenly.
  void refuse_endless(const Power& unsent) {
    constexpr uint32_t kFirstForesight = 32;
    const bool is_foreseen = settings_.zones.shooting == ZoneShooting::all && head_.round >= kFirstForesight;
    Power had = unsent;
    current_->total.for_each([&](uint64_t, const Power& power) { had += power; });
    for (size_t c = 0; c < 3; ++c) {
      const auto now = static_cast<double>(unsent[c]);
      const double lost = static_cast<double>(unsent_before_[c]) - now;
      const double most_rounds = 4 * kMostSendings;
      const double to_come =
          is_foreseen ? now * (lost > 0 ? std::min(now / lost / 4, most_rounds) : most_rounds) : 0;
      if (static_cast<double>(had[c]) + to_come > kMostSendings * kQuanta)
        throw std::runtime_error(fmt::format(
            "light does not come to rest: in {} rounds and those to come zones send more than {:g} times "
            "what "
            "there was; surfaces and media must take up a part of the light that they get (albedos below "
            "{:.3f}), or light must get out",
            head_.round, kMostSendings, 1 - 1 / kMostSendings));
    }
    unsent_before_ = unsent;
  }

  std::optional<ZoneStage> next_round() {
    Power unsent;
    ZoneSenders senders(zones_);
    unsent_.for_each([&](uint64_t slot, const Power& power) {
      unsent += power;
      senders.add(slot, power);
    });
    Power emitted;
    emitted_.for_each([&](uint64_t, const Power& power) { emitted += power; });
    unsent_total_ = unsent.total() + emitted.total();
    refuse_endless(unsent);
    const bool is_enough = unsent_total_ <= settings_.zones.tolerance * current_->primary.total();
    if (is_enough || !(unsent_total_ > 0)) {
      current_->unsent = unsent;
      current_->unsent += emitted;
      emitted_.clear();
      current_->rounds = head_.round;
      solved_.push_back(std::move(*current_));
      current_.reset();
      stage_.reset();
      return next_stage();
    }
    if (stage_ != ZoneStageKind::shoot && stage_ != ZoneStageKind::emit) {
      head_.rays = static_cast<double>(settings_.zones.rays);
      head_.first = unsent_total_;
    }
    if (!emitted.is_zero()) {
      head_.kind = ZoneStageKind::emit;
      stage_ = ZoneStageKind::emit;
      ZoneSenders shining(zones_);
      emitted_.for_each([&](uint64_t slot, const Power& power) { shining.add(slot, power); });
      uint64_t rays = 0;
      for (const ZoneSender& sender : shining.all()) rays += ray_count(sender, head_);
      rays_ += rays;
      return make_stage("light of luminous zones", rays, settings_.zones.batch);
    }
    head_.kind = ZoneStageKind::shoot;
    stage_ = ZoneStageKind::shoot;
    uint64_t rays = 0;
    if (settings_.zones.shooting == ZoneShooting::one) {
      const ZoneSender& fullest =
          *std::max_element(senders.all().begin(), senders.all().end(),
                            [](const ZoneSender& x, const ZoneSender& y) { return x.power < y.power; });
      sending_.emplace(slots());
      unsent_.for_each([&](uint64_t slot, const Power& power) {
        if (sender_of(zones_, slot) == fullest.first_slot) (*sending_)[slot] = power;
      });
      rays = ray_count(fullest, head_);
    } else {
      for (const ZoneSender& sender : senders.all()) rays += ray_count(sender, head_);
    }
    rays_ += rays;
    return make_stage(fmt::format("round {}", head_.round + 1), rays, settings_.zones.batch);
  }

  RenderSettings settings_;
  ZoneScene zones_;
  MirrorUnits mirrors_;
  MeasuredLight measured_;
  std::vector<ZonePassSolution> solved_;
  // Of the pass that is worked on.
  std::optional<ZonePassSolution> current_;
  PowerSums emitted_;                 ///< by sources that shoot, until they have
  PowerSums unsent_, next_;           ///< to send; and what came in this stage
  std::optional<PowerSums> sending_;  ///< of it, what is sent, if not all
  Power unsent_before_;               ///< when the round before began
  double unsent_total_ = 0;
  uint64_t rays_ = 0;
  // Of the stage that is worked on; none before a pass's first.
  std::optional<ZoneStageKind> stage_;
  ZoneStageHead head_;
};

}  // namespace

std::unique_ptr<ZoneSolver> make_zonal_solver(const Scene& scene, const RenderSettings& settings, int frame) {
  return std::make_unique<ZonalSolver>(scene, settings, frame);
}

}  // namespace rayfarm
