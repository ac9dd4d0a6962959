#include "protocol/job_plan.h"

#include <algorithm>
#include <limits>

namespace rayfarm {
namespace {
// Times and factors travel as whole numbers.
constexpr double kTicksPerSecond = 1e12, kFactorUnit = 1e6;

enum Flag : uint8_t { kPixelWire = 1, kCompresses = 2, kRotates = 4, kRows = 8, kPasses = 16 };
constexpr int kAllFlags = kPixelWire | kCompresses | kRotates | kRows | kPasses;

void write_pictures(ByteWriter& w, const PicturesPhase& phase) {
  w.varint(phase.frames.size());
  for (const FrameNumber frame : phase.frames) w.u32(static_cast<uint32_t>(frame.value()));
  const SubpolygonGrid& g = phase.grid;
  for (const int v :
       {g.left, g.top, g.width, g.height, g.columns, g.rows, g.small_height, g.small_columns, g.small_rows})
    w.u32(static_cast<uint32_t>(v));
}

PicturesPhase read_pictures(ByteReader& r, size_t plan_bytes) {
  PicturesPhase phase;
  const uint64_t frames = r.varint();
  if (frames > plan_bytes / 4) throw ProtocolError("a plan has more frames than bytes");
  for (uint64_t i = 0; i < frames; ++i) phase.frames.emplace_back(static_cast<int>(r.u32()));
  SubpolygonGrid& g = phase.grid;
  for (int* v : {&g.left, &g.top, &g.width, &g.height, &g.columns, &g.rows, &g.small_height, &g.small_columns,
                 &g.small_rows}) {
    const uint32_t value = r.u32();
    if (value > 65536) throw ProtocolError("a plan's grid is out of range");
    *v = static_cast<int>(value);
  }
  const bool has_small = g.small_height > 0;
  if (g.columns < 1 || g.rows < 1 || g.width < g.columns || g.height - g.small_height < g.rows ||
      g.small_height < g.small_rows || g.width < g.small_columns || has_small != (g.small_rows > 0) ||
      has_small != (g.small_columns > 0))
    throw ProtocolError("a plan's grid is empty");
  if (int64_t{g.columns} * g.rows + int64_t{g.small_columns} * g.small_rows >
          std::numeric_limits<int>::max() ||
      g.left + g.width > 65536 || g.top + g.height > 65536)
    throw ProtocolError("a plan's grid is out of range");
  return phase;
}

}  // namespace

Bytes encode_plan(const JobPlan& plan) {
  ByteWriter w;
  w.text(plan.build);
  w.u8(static_cast<uint8_t>(plan.policy));
  w.u8(static_cast<uint8_t>((plan.wire == Wire::pixel ? kPixelWire : 0) |
                            (plan.compresses ? kCompresses : 0) | (plan.rotates ? kRotates : 0) |
                            (plan.sets == SetPattern::rows ? kRows : 0) |
                            (plan.pictures.passes > 1 ? kPasses : 0)));
  w.u32(static_cast<uint32_t>(plan.processors));
  w.u32(static_cast<uint32_t>(plan.host_timeout_s * 1000));
  w.u32(static_cast<uint32_t>(plan.beat_s * 1000));
  w.varint(static_cast<uint64_t>(plan.ray_time_s * kTicksPerSecond));
  w.varint(plan.time_factors.size());
  for (const double factor : plan.time_factors) w.varint(static_cast<uint64_t>(factor * kFactorUnit));
  w.varint(plan.settings.size());
  w.bytes(plan.settings);
  write_pictures(w, plan.pictures);
  if (plan.pictures.passes > 1) w.varint(static_cast<uint64_t>(plan.pictures.passes));
  return w.take();
}

JobPlan decode_plan(std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  JobPlan plan;
  plan.build = r.text();
  const uint8_t policy = r.u8(), flags = r.u8();
  if (policy > 1 || (flags & ~kAllFlags) != 0) throw ProtocolError("a plan of unknown policy, wire or sets");
  plan.policy = static_cast<AssignmentPolicy>(policy);
  plan.wire = flags & kPixelWire ? Wire::pixel : Wire::block;
  plan.compresses = flags & kCompresses;
  plan.rotates = flags & kRotates;
  plan.sets = flags & kRows ? SetPattern::rows : SetPattern::lattice;
  plan.processors = static_cast<int>(r.u32());
  if (plan.processors < 1 || plan.processors > kMostProcessors)
    throw ProtocolError("a plan for no processor, or for too many");
  plan.host_timeout_s = r.u32() / 1000.0;
  plan.beat_s = r.u32() / 1000.0;
  if (plan.beat_s < liveness::kBeat_s || plan.beat_s > liveness::kMostBeat_s)
    throw ProtocolError("a plan of hearts that beat too fast or too seldom");
  plan.ray_time_s = static_cast<double>(r.varint()) / kTicksPerSecond;
  const uint64_t factors = r.varint();
  if (factors > bytes.size()) throw ProtocolError("a plan has more time factors than bytes");
  for (uint64_t i = 0; i < factors; ++i)
    plan.time_factors.push_back(static_cast<double>(r.varint()) / kFactorUnit);
  const auto settings = r.bytes(r.varint());
  plan.settings.assign(settings.begin(), settings.end());
  plan.pictures = read_pictures(r, bytes.size());
  if (plan.policy == AssignmentPolicy::interleaved && plan.pictures.grid.small_height > 0)
    throw ProtocolError("a plan of sets that do not lie in one grid");
  if (flags & kPasses) {
    const uint64_t passes = r.varint();
    if (passes < 1 || passes > PicturesPhase::kMostPasses) throw ProtocolError("a plan of too many passes");
    if (plan.policy == AssignmentPolicy::interleaved || plan.wire == Wire::pixel)
      throw ProtocolError("a plan of passes that nodes or wire can't go through");
    plan.pictures.passes = static_cast<int>(passes);
  }
  if (plan.pictures.frames.size() * static_cast<size_t>(plan.pictures.passes) >
      static_cast<size_t>(std::numeric_limits<int>::max()))
    throw ProtocolError("a plan has more passes of frames than can be counted");
  return plan;  // load code pads its payload to whole words, so bytes may follow
}

BeginPhase beginning_of(const Phase& phase, uint32_t number, uint64_t data_bytes) {
  if (const auto* zones = std::get_if<ZonePhase>(&phase))
    return {number, PhaseKind::zones, zones->frame.value(), zones->units, zones->units_per_item, data_bytes};
  const auto& pictures = std::get<PicturesPhase>(phase);
  return {number, PhaseKind::pictures, pictures.first.value(), pictures.frames.size(), 1, data_bytes};
}

Phase phase_of(const JobPlan& plan, const BeginPhase& begin) {
  if (begin.kind == PhaseKind::zones) {
    if (begin.units > ZonePhase::kMostUnits)
      throw ProtocolError("a phase has more units than 32 bits address");
    return ZonePhase{FrameNumber(begin.frame), begin.units, std::min(begin.units_per_item, begin.units)};
  }
  const std::vector<FrameNumber>& frames = plan.pictures.frames;
  const size_t all = frames.size(), first = static_cast<size_t>(std::max(begin.frame, 0));
  if (begin.frame < 0 || first > all || begin.units > all - first)
    throw ProtocolError("a phase has frames that the plan has not");
  const auto at = frames.begin() + begin.frame;
  return PicturesPhase{{at, at + static_cast<std::ptrdiff_t>(begin.units)},
                       plan.pictures.grid,
                       FrameIndex(begin.frame),
                       plan.pictures.passes};
}

namespace {
/// How often the sets of a phase's frame have moved on.
FrameIndex moves_of(const JobPlan& plan, const PicturesPhase& phase, FrameIndex frame) {
  return plan.rotates ? FrameIndex(phase.first.value() + frame.value()) : FrameIndex(0);
}
}  // namespace

NodeId owner_of(const JobPlan& plan, const PicturesPhase& phase, ItemIndex item) {
  const FrameIndex moves = moves_of(plan, phase, phase.frame_of(item));
  const SubpolygonId subpolygon = phase.subpolygon_of(item);
  return NodeId(interleaved_owner(phase.grid, plan.sets, plan.processors, moves, subpolygon) + 1);
}

SubpolygonId own_subpolygon(const JobPlan& plan, const PicturesPhase& phase, FrameIndex frame,
                            SubpolygonId of_set) {
  return moved_right(phase.grid, of_set, moves_of(plan, phase, frame));
}

}  // namespace rayfarm
