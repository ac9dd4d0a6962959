#include "protocol/job_plan.h"

namespace rayfarm {
namespace {
// Times and factors travel as whole numbers.
constexpr double kTicksPerSecond = 1e12, kFactorUnit = 1e6;
}  // namespace

Bytes encode_plan(const JobPlan& plan) {
  ByteWriter w;
  w.text(plan.build);
  w.varint(plan.frames.size());
  for (const int frame : plan.frames) w.u32(static_cast<uint32_t>(frame));
  w.u8(static_cast<uint8_t>(plan.policy));
  w.u8(static_cast<uint8_t>(plan.wire));
  w.u8(plan.compresses ? 1 : 0);
  w.u32(static_cast<uint32_t>(plan.processors));
  w.u32(static_cast<uint32_t>(plan.host_timeout_s * 1000));
  const SubpolygonGrid& g = plan.grid;
  for (const int v : {g.left, g.top, g.width, g.height, g.columns, g.rows}) w.u32(static_cast<uint32_t>(v));
  w.u8(plan.rotates ? 1 : 0);
  w.varint(static_cast<uint64_t>(plan.ray_time_s * kTicksPerSecond));
  w.varint(plan.time_factors.size());
  for (const double factor : plan.time_factors) w.varint(static_cast<uint64_t>(factor * kFactorUnit));
  w.varint(plan.settings.size());
  w.bytes(plan.settings);
  return w.take();
}

JobPlan decode_plan(std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  JobPlan plan;
  plan.build = r.text();
  const uint64_t frames = r.varint();
  if (frames > bytes.size() / 4) throw ProtocolError("a plan has more frames than bytes");
  for (uint64_t i = 0; i < frames; ++i) plan.frames.push_back(static_cast<int>(r.u32()));
  const uint8_t policy = r.u8(), wire = r.u8();
  if (policy > 1 || wire > 1) throw ProtocolError("a plan of unknown policy or wire");
  plan.policy = static_cast<AssignmentPolicy>(policy);
  plan.wire = static_cast<Wire>(wire);
  plan.compresses = r.u8() != 0;
  plan.processors = static_cast<int>(r.u32());
  plan.host_timeout_s = r.u32() / 1000.0;
  SubpolygonGrid& g = plan.grid;
  for (int* v : {&g.left, &g.top, &g.width, &g.height, &g.columns, &g.rows}) {
    const uint32_t value = r.u32();
    if (value > 65536) throw ProtocolError("a plan's grid is out of range");
    *v = static_cast<int>(value);
  }
  if (plan.processors < 1 || plan.processors > kMostProcessors || g.columns < 1 || g.rows < 1 ||
      g.width < g.columns || g.height < g.rows)
    throw ProtocolError("a plan's grid is empty");
  plan.rotates = r.u8() != 0;
  plan.ray_time_s = static_cast<double>(r.varint()) / kTicksPerSecond;
  const uint64_t factors = r.varint();
  if (factors > bytes.size()) throw ProtocolError("a plan has more time factors than bytes");
  for (uint64_t i = 0; i < factors; ++i)
    plan.time_factors.push_back(static_cast<double>(r.varint()) / kFactorUnit);
  const auto settings = r.bytes(r.varint());
  plan.settings.assign(settings.begin(), settings.end());
  return plan;  // load code pads its payload to whole words, so bytes may follow
}

}  // namespace rayfarm
