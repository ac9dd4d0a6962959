#include "common/lighting/zones/zone_solution.h"

namespace rayfarm {

std::vector<std::byte> encode_zone_solution(std::span<const ZonePassSolution> passes) {
  PackedWriter out;
  out.number(passes.size());
  for (const ZonePassSolution& pass : passes) {
    out.number(pass.total.slots());
    for (const double worth : pass.quantum.worth) out.real(worth);
    for (const Power* power : {&pass.primary, &pass.absorbed, &pass.escaped, &pass.unsent}) out.power(*power);
    out.number(pass.rounds);
    out.sums(pass.total);
    out.sums(pass.direct);
  }
  return out.take();
}

std::vector<ZonePassSolution> decode_zone_solution(std::span<const std::byte> bytes, size_t passes,
                                                   uint64_t slots) {
  PackedReader in(bytes);
  if (in.number() != passes) throw std::runtime_error("the zones are of another number of colour passes");
  std::vector<ZonePassSolution> result;
  for (size_t i = 0; i < passes; ++i) {
    if (in.number() != slots) throw std::runtime_error("the zones are of another number");
    ZonePassSolution& pass = result.emplace_back(slots);
    for (double& worth : pass.quantum.worth) {
      worth = in.real();
      if (!(worth >= 0) || !std::isfinite(worth)) throw PackedReader::damaged();
    }
    for (Power* power : {&pass.primary, &pass.absorbed, &pass.escaped, &pass.unsent}) *power = in.power();
    pass.rounds = in.number();
    in.sums(slots, [&](uint64_t slot, const Power& power) { pass.total[slot] = power; });
    in.sums(slots, [&](uint64_t slot, const Power& power) { pass.direct[slot] = power; });
  }
  in.expect_end();
  return result;
}

}  // namespace rayfarm
