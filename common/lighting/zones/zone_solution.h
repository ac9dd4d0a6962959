#pragma once
// What is known of light at the end: the power that zones got, as it travels to nodes and lies in files.
#include "common/lighting/zones/power.h"

namespace rayfarm {

/// Of one colour pass.
struct ZonePassSolution {
  explicit ZonePassSolution(uint64_t slots) : total(slots), direct(slots) {}
  ZoneQuantum quantum;
  PowerSums total;   ///< that leaves, but for what is emitted
  PowerSums direct;  ///< of that, what came straight from sources that shadow rays ask
  // The balance: primary = absorbed + escaped + unsent.
  Power primary, absorbed, escaped, unsent;
  uint64_t rounds = 0;
};

std::vector<std::byte> encode_zone_solution(std::span<const ZonePassSolution> passes);
/// Throws std::runtime_error if the bytes are damaged, or of zones of another number.
std::vector<ZonePassSolution> decode_zone_solution(std::span<const std::byte> bytes, size_t passes,
                                                   uint64_t slots);

}  // namespace rayfarm
