#include "common/sampling/random.h"

#include <Random123/philox.h>

#include <bit>

namespace rayfarm {

std::array<double, 2> random_pair(uint64_t seed, int frame, const SampleId& id, uint32_t dimension) {
  const r123::Philox4x32::ctr_type counter{
      {static_cast<uint32_t>(id.x), static_cast<uint32_t>(id.y), id.sample, dimension}};
  // The frame is mixed into the key: every frame has its own noise, and the same on every node.
  const r123::Philox4x32::key_type key{
      {static_cast<uint32_t>(seed),
       static_cast<uint32_t>(seed >> 32) ^ (static_cast<uint32_t>(frame) * 0x9e3779b9u)}};
  const auto r = r123::Philox4x32()(counter, key);
  const auto unit = [](uint32_t high, uint32_t low) {
    return static_cast<double>((uint64_t{high} << 32 | low) >> 11) * 0x1p-53;
  };
  return {unit(r[0], r[1]), unit(r[2], r[3])};
}

uint32_t permuted(uint32_t i, uint32_t n, uint64_t seed) {
  if (n <= 1) return 0;
  const int bits = std::bit_width(n - 1);
  const auto mask = static_cast<uint32_t>((uint64_t{1} << bits) - 1);
  // Steps that are one-to-one on the next power of two; numbers beyond n walk on until they are inside.
  do {
    uint64_t keys = seed;
    for (int round = 0; round < 8; ++round) {
      keys = mix_bits(keys);
      i ^= static_cast<uint32_t>(keys) & mask;
      i = i * (static_cast<uint32_t>(keys >> 32) | 1) & mask;
      i ^= i >> (bits + 1) / 2;
    }
  } while (i >= n);
  return i;
}

}  // namespace rayfarm
