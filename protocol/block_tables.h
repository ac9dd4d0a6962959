#pragma once
// The tables by which blocks are coded: the same for all blocks, so that none carries its own, and small ones
// begin with what large ones have to learn. There are three sets, for even, busy and noisy pixels; a block
// names the one that makes it least. The coder is a table-driven asymmetric numeral system (tANS; Duda 2013,
// "Asymmetric numeral systems", arXiv:1311.2540; spread and state transitions as in Collet's Finite State
// Entropy), whose state goes on from table to table.
#include <array>
#include <cstdint>
#include <vector>

#include "protocol/block_model.h"

namespace rayfarm::block_tables {

inline constexpr int kSets = 3;
inline constexpr int kStateBits = 10, kStates = 1 << kStateBits;

/// What a state means to the decoder. From the lowest bit: 5 bits of how many bits are read for the next
/// state, 5 of how many for that and the plain bits; 10 of the next state without the bits read; 8 of the
/// folded difference without its plain bits, 2 of the token's size.
inline constexpr int kBothAt = 5, kNextAt = 10, kFoldedAt = 20, kSizeAt = 28;

struct DecodingTables {
  /// [set × contexts + context][state]
  std::vector<std::array<uint32_t, kStates>> states;
};
const DecodingTables& decoding_tables();

/// Of one context: a token at a state s puts out the low `bits = (s + kStates + add[token]) >> 16` bits of it
/// and goes on to next[((s + kStates) >> bits) + first[token]].
struct EncodingTable {
  std::array<uint16_t, kStates> next{};
  std::array<uint32_t, block_model::kTokens> add{};
  std::array<int16_t, block_model::kTokens> first{};
};
struct EncodingTables {
  std::vector<EncodingTable> contexts;  ///< [set × contexts + context]
  /// [context × tokens + token][set]: 1/256 bits. A fourth makes it the width of a register.
  std::vector<std::array<uint32_t, 4>> costs;
};
const EncodingTables& encoding_tables();

/// Of kStates parts, one at least for each token.
using Frequencies = std::array<uint16_t, block_model::kTokens>;
/// Quarters of a bit, from 0 on.
inline constexpr const char* kCostDigits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcde";
/// From what each token costs: `kTokens` digits.
Frequencies frequencies_of(const char* costs);
/// [set × contexts + context]: what its tokens cost.
extern const std::array<const char*, static_cast<size_t>(kSets* block_model::kContexts)> kCosts;

}  // namespace rayfarm::block_tables
