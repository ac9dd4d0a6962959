#include "protocol/block_tables.h"

#include <cstring>
#include <numeric>

namespace rayfarm::block_tables {
namespace {

using block_model::kContexts;
using block_model::kTokens;

constexpr size_t kTables = static_cast<size_t>(kSets * kContexts);

int whole_log2(uint32_t value) {
  int log = 0;
  while (value >> log > 1) ++log;
  return log;
}

/// -log2(frequency / kStates) in 1/256 bits, by squaring: the same on every machine, as no library's is.
uint32_t cost_of(uint32_t frequency) {
  const int whole = whole_log2(frequency);
  uint64_t mantissa = uint64_t{frequency} << (31 - whole);  // 1 to 2, with 31 bits behind the point
  uint32_t fraction = 0;
  for (int bit = 7; bit >= 0; --bit) {
    mantissa = mantissa * mantissa >> 31;
    if (mantissa >> 32) {
      mantissa >>= 1;
      fraction |= 1u << bit;
    }
  }
  return static_cast<uint32_t>((kStateBits - whole) * 256) - fraction;
}

/// Which token each state stands for: spread evenly.
std::array<uint8_t, kStates> spread(const Frequencies& frequencies) {
  constexpr int kStep = (kStates >> 1) + (kStates >> 3) + 3;
  std::array<uint8_t, kStates> tokens{};
  int at = 0;
  for (size_t token = 0; token < kTokens; ++token)
    for (int i = 0; i < frequencies[token]; ++i) {
      tokens[static_cast<size_t>(at)] = static_cast<uint8_t>(token);
      at = (at + kStep) % kStates;
    }
  return tokens;
}

std::array<uint32_t, kStates> make_decoding(const Frequencies& frequencies) {
  const auto tokens = spread(frequencies);
  std::array<block_model::Token, kTokens> parts{};
  for (int folded = 255; folded >= 0; --folded) {
    const block_model::Token t = block_model::token_of(folded);
    parts[t.token] = t;
  }
  Frequencies seen = frequencies;
  std::array<uint32_t, kStates> table{};
  for (size_t state = 0; state < kStates; ++state) {
    const uint32_t of_token = seen[tokens[state]]++;
    const int bits = kStateBits - whole_log2(of_token);
    const block_model::Token& part = parts[tokens[state]];
    table[state] = static_cast<uint32_t>(bits) | static_cast<uint32_t>(bits + part.bits) << kBothAt |
                   ((of_token << bits) - kStates) << kNextAt | uint32_t{part.base} << kFoldedAt |
                   block_model::size_of_token(tokens[state]) << kSizeAt;
  }
  return table;
}

EncodingTable make_encoding(const Frequencies& frequencies) {
  const auto tokens = spread(frequencies);
  EncodingTable table;
  std::array<int, kTokens> place{};
  int sum = 0;
  for (size_t token = 0; token < kTokens; ++token) {
    const int frequency = frequencies[token];
    place[token] = sum;
    table.first[token] = static_cast<int16_t>(sum - frequency);
    // States from frequency << bits on put out `bits` bits, those before it one fewer.
    const int bits = kStateBits - (frequency > 1 ? whole_log2(static_cast<uint32_t>(frequency - 1)) : 0);
    table.add[token] = (static_cast<uint32_t>(bits) << 16) - (static_cast<uint32_t>(frequency) << bits);
    sum += frequency;
  }
  for (size_t state = 0; state < kStates; ++state)
    table.next[static_cast<size_t>(place[tokens[state]]++)] = static_cast<uint16_t>(state);
  return table;
}

DecodingTables make_decoding_tables() {
  DecodingTables tables;
  for (const char* costs : kCosts) tables.states.push_back(make_decoding(frequencies_of(costs)));
  return tables;
}

EncodingTables make_encoding_tables() {
  EncodingTables tables;
  tables.costs.resize(static_cast<size_t>(kContexts * kTokens));
  for (size_t i = 0; i < kTables; ++i) {
    const Frequencies frequencies = frequencies_of(kCosts[i]);
    tables.contexts.push_back(make_encoding(frequencies));
    for (size_t token = 0; token < kTokens; ++token)
      tables.costs[i % kContexts * kTokens + token][i / kContexts] = cost_of(frequencies[token]);
  }
  return tables;
}

}  // namespace

Frequencies frequencies_of(const char* costs) {
  constexpr std::array<int, 4> kQuarters{1024, 861, 724,
                                         609};  // 1024 × 2 to the power of -0, -1/4, -1/2, -3/4
  static_assert(kStates == kQuarters[0]);
  Frequencies frequencies{};
  for (size_t token = 0; token < kTokens; ++token) {
    const int cost = static_cast<int>(std::strchr(kCostDigits, costs[token]) - kCostDigits);
    frequencies[token] =
        static_cast<uint16_t>(std::max(1, kQuarters[static_cast<size_t>(cost & 3)] >> (cost >> 2)));
  }
  // What is too much or too little goes where it matters least: to the most frequent, as long as it stays so.
  int rest = kStates - std::accumulate(frequencies.begin(), frequencies.end(), 0);
  while (rest != 0) {
    auto most = std::max_element(frequencies.begin(), frequencies.end());
    const int change = rest > 0 ? rest : -std::min(-rest, std::max(1, *most / 8));
    *most = static_cast<uint16_t>(*most + change);
    rest -= change;
  }
  return frequencies;
}

const DecodingTables& decoding_tables() {
  static const DecodingTables tables = make_decoding_tables();
  return tables;
}

const EncodingTables& encoding_tables() {
  static const EncodingTables tables = make_encoding_tables();
  return tables;
}

}  // namespace rayfarm::block_tables
