#pragma once
// What the coder of blocks expects of a pixel before it knows it: a prediction and a context for each
// channel. Encoder, decoder and the trainer of the tables (tests/bench/block_tables.cpp) go through the same
// pixels in the same order.
//
// A pixel is green, red - green and blue - green. Each is predicted from its left and upper neighbours by the
// median edge detector of LOCO-I, and what it differs by has a probability that depends on how much the
// neighbours differ among each other (Weinberger, Seroussi, Sapiro 2000, "The LOCO-I lossless image
// compression algorithm"). Red and blue know more: by how much green (for blue: red) was mispredicted in the
// same pixel. A multiple of that, chosen for the block, is added to the prediction, and its sign turns the
// sign of the difference. How large the difference coded before was, in the same pixel, is part of the
// context: it is known as soon as the token is, so that a decoder need not wait for the value.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

namespace rayfarm::block_model {

// Contexts, numbered through. All of red and blue are one: their statistics are alike.
inline constexpr int kGreenLevels = 13, kGreenTopLevels = 5;
inline constexpr int kColourLevels = 6, kColourSizes = 4, kColourTopLevels = 4;
inline constexpr int kGreen = 0, kGreenTop = kGreen + kGreenLevels, kColour = kGreenTop + kGreenTopLevels,
                     kColourTop = kColour + kColourLevels * kColourSizes,
                     kFirstColour = kColourTop + kColourTopLevels * kColourSizes,
                     kContexts = kFirstColour + 1;

// A difference modulo 256 is folded to 0, -1, 1, -2 ... = 0, 1, 2, 3 ... Up to 15 each is a token of its own;
// above, a token stands for a quarter of an octave, and the rest follows as plain bits.
inline constexpr int kTokens = 32, kPlainTokens = 16;
constexpr uint8_t fold(int difference) {
  const int signed_difference = static_cast<int8_t>(difference);
  return static_cast<uint8_t>(signed_difference * 2 ^ -(signed_difference < 0));
}
constexpr int unfold(int folded) {
  return folded >> 1 ^ -(folded & 1);
}
/// Of a token, roughly how large the difference is: 0, to 2, to 9, more.
constexpr uint32_t size_of_token(int token) {
  return token == 0 ? 0 : token <= 4 ? 1 : token <= kPlainTokens ? 2 : 3;
}
struct Token {
  uint8_t token = 0;
  uint8_t bits = 0;  ///< that follow the token
  uint8_t base = 0;  ///< what the token alone stands for
};
constexpr Token token_of(int folded) {
  if (folded < kPlainTokens) return {static_cast<uint8_t>(folded), 0, static_cast<uint8_t>(folded)};
  int octave = 4;
  while (folded >> octave > 1) ++octave;
  const int bits = octave - 2, quarter = folded >> bits & 3;
  return {static_cast<uint8_t>(kPlainTokens + (octave - 4) * 4 + quarter), static_cast<uint8_t>(bits),
          static_cast<uint8_t>((4 | quarter) << bits)};
}

// Slopes, in quarters: how much of what green was mispredicted by red - green is expected to be, and how much
// of red - green's blue - green's.
inline constexpr std::array<int, 6> kRedSlopes{0, -2, -1, 1, 2, 4};
inline constexpr std::array<int, 7> kBlueSlopes{0, -4, -2, -1, 1, 2, 4};
constexpr int share(int slope, int misprediction) {
  return slope * misprediction >> 2;
}

/// The median of left, up and left + up - corner.
constexpr int median(int left, int up, int corner) {
  return std::max(std::min(left, up), std::min(std::max(left, up), left + up - corner));
}
constexpr int clamped(int value) {
  return std::clamp(value, 0, 255);
}

/// Number of limits that are exceeded.
template <size_t N>
constexpr int level(int value, const std::array<int, N>& limits) {
  int exceeded = 0;
  for (const int limit : limits) exceeded += value > limit;
  return exceeded;
}

/// Contexts by differences of neighbours: green's go up to 3 × 255, a colour's to 3 × 510. To a colour's
/// comes the size of the token before. × `scale`.
struct ContextTables {
  std::array<uint32_t, 3 * 255 + 1> green{};
  std::array<uint32_t, 2 * 255 + 1> green_top{};
  std::array<uint32_t, 3 * 510 + 1> colour{}, colour_top{};
};
constexpr ContextTables make_context_tables(uint32_t scale) {
  ContextTables t;
  const auto fill = [&](auto& table, int base, int step, const auto& limits) {
    for (size_t i = 0; i < table.size(); ++i)
      table[i] = scale * static_cast<uint32_t>(base + step * level(static_cast<int>(i), limits));
  };
  fill(t.green, kGreen, 1, std::array{0, 1, 2, 3, 5, 8, 12, 18, 27, 40, 64, 110});
  fill(t.green_top, kGreenTop, 1, std::array{0, 4, 16, 48});
  fill(t.colour, kColour, kColourSizes, std::array{0, 2, 6, 16, 48});
  fill(t.colour_top, kColourTop, kColourSizes, std::array{0, 4, 16});
  return t;
}

/// What follows from the neighbours of a value of one channel. Left of a row's first value stands the one
/// above it, right of the row above once more its last.
struct Expected {
  int prediction = 0;
  uint32_t unrest = 0;  ///< how much the neighbours differ
};
constexpr Expected expect(int left, int up, int corner, int right) {
  return {median(left, up, corner),
          static_cast<uint32_t>(std::abs(left - corner) + std::abs(up - corner) + std::abs(up - right))};
}
constexpr Expected expect_in_top_row(int left, int before_left) {
  return {left, static_cast<uint32_t>(2 * std::abs(left - before_left))};
}

}  // namespace rayfarm::block_model
