// Makes the tables of the block coder (protocol/block_costs.cpp) from pictures: cuts them into blocks of
// several sizes, and sorts the blocks into sets, each of which gets the frequencies of its own blocks, until
// no block finds another set cheaper. `deploy/bench` does not run it: the tables are part of the wire.
//   block_tables PICTURE.png ... > protocol/block_costs.cpp
#include "protocol/block_tables.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <string>

#include "common/image/image_file.h"
#include "protocol/block_symbols.h"

namespace {

using namespace rayfarm;
using namespace rayfarm::block_model;
using namespace rayfarm::block_tables;

/// Of one set: how often each token was met in each context. What was never met still may be.
using Counts = std::vector<std::array<double, kTokens>>;
Counts no_counts() {
  Counts counts(kContexts);
  for (auto& of_context : counts) of_context.fill(0.3);
  return counts;
}

struct Block {
  std::vector<Symbol> symbols;
  size_t set = 0;
};

/// The pixels that a render to PNG has.
std::vector<std::byte> read_pixels(const std::string& path, int& width, int& height) {
  ImageReader reader(path, 1 << 26);
  width = reader.width_px();
  height = reader.height_px();
  std::vector<std::byte> pixels;
  for (int y = 0; y < height; ++y)
    for (const float v : reader.next_row()) pixels.push_back(static_cast<std::byte>(std::lround(255 * v)));
  return pixels;
}

void cut(const std::string& path, std::vector<Block>& blocks) {
  int width = 0, height = 0;
  const auto pixels = read_pixels(path, width, height);
  Symbols symbols;
  std::vector<std::byte> part;
  for (const int side : {9, 14, 32})
    for (int top = 0; top + side <= height; top += side)
      for (int left = 0; left + side <= width; left += side) {
        part.clear();
        for (int y = top; y < top + side; ++y) {
          const auto row = pixels.begin() + 3 * (std::ptrdiff_t{y} * width + left);
          part.insert(part.end(), row, row + 3 * side);
        }
        // One colour is not coded.
        if (std::equal(part.begin() + 3, part.end(), part.begin())) continue;
        make_symbols(part, side, side, symbols);
        blocks.push_back({symbols.symbols});
      }
}

std::string costs_of(const std::array<double, kTokens>& counts) {
  double sum = 0;
  for (const double count : counts) sum += count;
  std::string costs;
  for (const double count : counts)
    costs += kCostDigits[std::clamp<int>(static_cast<int>(std::lround(-4 * std::log2(count / sum))), 0,
                                         4 * kStateBits)];
  return costs;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Block> blocks;
  for (int i = 1; i < argc; ++i) cut(argv[i], blocks);
  if (blocks.empty()) {
    fmt::print(stderr, "block_tables: no pictures; give it PNG files\n");
    return 2;
  }
  // To begin with, by how many differences are more than a little.
  for (Block& b : blocks) {
    size_t large = 0;
    for (const Symbol s : b.symbols) large += s.folded > 4;
    b.set = std::min<size_t>(kSets - 1, 2 * kSets * large / b.symbols.size());
  }
  std::array<std::vector<std::string>, kSets> costs;
  for (int round = 0; round < 12; ++round) {
    std::array<Counts, kSets> counts{no_counts(), no_counts(), no_counts()};
    for (const Block& b : blocks)
      for (const Symbol s : b.symbols) counts[b.set][s.context][token_of(s.folded).token] += 1;
    std::array<std::vector<double>, kSets> bits;
    for (size_t set = 0; set < kSets; ++set) {
      costs[set].clear();
      for (const auto& of_context : counts[set]) {
        costs[set].push_back(costs_of(of_context));
        for (const uint16_t f : frequencies_of(costs[set].back().c_str()))
          bits[set].push_back(kStateBits - std::log2(f));
      }
    }
    double all = 0;
    size_t moved = 0;
    for (Block& b : blocks) {
      std::array<double, kSets> sums{};
      for (const Symbol s : b.symbols)
        for (size_t set = 0; set < kSets; ++set)
          sums[set] += bits[set][size_t{s.context} * kTokens + token_of(s.folded).token];
      const auto least = static_cast<size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
      all += sums[least];
      moved += least != b.set;
      b.set = least;
    }
    fmt::print(stderr, "round {}: {:.0f} bytes, {} of {} blocks moved\n", round, all / 8, moved,
               blocks.size());
  }
  fmt::print(
      "#include \"protocol/block_tables.h\"\n\n// Made by tests/bench/block_tables.cpp; its README says of "
      "what.\n"
      "namespace rayfarm::block_tables {{\n\n// clang-format off\n"
      "const std::array<const char*, static_cast<size_t>(kSets * block_model::kContexts)> kCosts{{{{\n");
  for (const auto& set : costs)
    for (size_t i = 0; i < set.size(); ++i)
      fmt::print("{}\"{}\",{}", i % 3 == 0 ? "  " : " ", set[i],
                 i % 3 == 2 || i + 1 == set.size() ? "\n" : "");
  fmt::print("}}}};\n// clang-format on\n\n}}  // namespace rayfarm::block_tables\n");
}
