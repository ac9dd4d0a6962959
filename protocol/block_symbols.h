#pragma once
// What a block comes to before it is coded: apart from the coder for the trainer of its tables.
#include <span>
#include <vector>

#include "protocol/block_model.h"

namespace rayfarm::block_model {

/// A folded difference and the context that it is met in.
struct Symbol {
  uint8_t context = 0, folded = 0;
};

struct Symbols {
  size_t red_slope = 0, blue_slope = 0;  ///< which of kRedSlopes, kBlueSlopes
  std::vector<Symbol> symbols;           ///< red, blue of the first pixel, then green, red, blue of each
};

/// `pixels`: height × width × 3 bytes. `out` is overwritten; its memory is used again.
void make_symbols(std::span<const std::byte> pixels, int width, int height, Symbols& out);

}  // namespace rayfarm::block_model
