#include "host/farm/zones_host.h"

#include <fmt/core.h>

#include <limits>

#include "protocol/byte_codec.h"

namespace rayfarm {

void ZonesHost::begin(const ZoneStage& stage, FrameNumber frame, uint32_t number, ZoneSolver& solver) {
  if (stage.units_per_item == 0) throw std::runtime_error(fmt::format("{} has nothing to do", stage.name));
  if (stage.units > ZonePhase::kMostUnits ||
      stage.items() > static_cast<uint64_t>(std::numeric_limits<int>::max()))
    throw std::runtime_error(
        fmt::format("{} has {} rays or zones in batches of {}, more than the net addresses (2^32 in 2^31 "
                    "batches); ask for fewer rays or larger batches",
                    stage.name, stage.units, stage.units_per_item));
  if (stage.data.size() > kMostPhaseDataBytes)
    throw std::runtime_error(
        fmt::format("{} needs {} GiB of data at every node, more than the net addresses "
                    "(32 GiB); ask for larger zones",
                    stage.name, stage.data.size() >> 30));
  phase_ = ZonePhase{frame, stage.units, std::min(stage.units_per_item, stage.units)};
  name_ = stage.name;
  number_ = number;
  solver_ = &solver;
  ++result_.zones.stages;
  result_.zones.data_bytes += stage.data.size();
}

PhaseWork ZonesHost::work() {
  PhaseWork work;
  work.items_per_step = static_cast<int>(zones().items());
  if (plan_.policy == AssignmentPolicy::interleaved)
    work.owner_of = [number = number_, processors = plan_.processors](ItemIndex item) {
      return zone_owner(number, processors, item);
    };
  return work;
}

void ZonesHost::assign(const AssignItem& assign) {
  Bytes message = encode_unit_range(processor_of(assign.node), zones().units_of(assign.item));
  result_.zones.assignment_bytes += message.size();
  transport_.send(assign.node, Channel::command, std::move(message));
}

std::string ZonesHost::name_of(ItemIndex item) const {
  const UnitRange units = zones().units_of(item);
  return fmt::format("units {} to {} of zones, {}", units.first, units.last, name_);
}

void ZonesHost::fail(const StepFailed& failed, double) {
  result_.problem = fmt::format("zones of frame {}, {}: a part failed three times: {}", zones().frame.value(),
                                name_, failed.problem);
}

void ZonesHost::receive(NodeId node, std::span<const std::byte> message, double now) {
  const ZoneResult answer = decode_zone_result(message);
  const RayCounts rays{answer.rays, answer.ray_tallies};
  if (assignment_.is_expelled(node)) return;
  NodeResult& of_node = result_.node(node);
  result_.zones.result_bytes += message.size();
  ++of_node.zone_items;
  of_node.zone_busy_s += static_cast<double>(answer.busy_us) * 1e-6;
  if (!is_at_work() || answer.phase != number_) {  // too late for its phase
    ++result_.duplicates;
    return;
  }
  if (!zones().has(answer.item)) throw ProtocolError("an item that does not exist");
  if (assignment_.needs(node, answer.item)) {
    Bytes plain;
    if (answer.is_compressed) plain = decompress_bytes(answer.bytes, kMostZoneResultBytes);
    try {
      solver_->add(static_cast<uint64_t>(answer.item.value()), answer.is_compressed ? plain : answer.bytes);
    } catch (const std::runtime_error& e) {
      throw ProtocolError(fmt::format("a result of zones: {}", e.what()));
    }
    result_.zones.rays += rays;
    ++result_.zones.results;
  }
  if (!assignment_.accept(node, answer.item, now)) ++result_.duplicates;
}

}  // namespace rayfarm
