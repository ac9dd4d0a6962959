#include "protocol/block_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <thread>

#include "common/image/image_file.h"
#include "protocol/block_tables.h"

namespace rayfarm {
namespace {

size_t bytes_of_block(int width, int height) {
  return 3 * static_cast<size_t>(width) * static_cast<size_t>(height);
}

/// Blocks of every kind that a render gives, and that none does.
std::vector<Bytes> make_blocks(int width, int height, std::mt19937& random) {
  Bytes flat(bytes_of_block(width, height)), gradient = flat, noise = flat, soft = flat, edge = flat,
                                             extremes = flat;
  for (size_t i = 0; i < flat.size(); ++i) {
    const size_t c = i % 3, x = i / 3 % static_cast<size_t>(width), y = i / 3 / static_cast<size_t>(width);
    flat[i] = static_cast<std::byte>(70 * c + 9);
    gradient[i] = static_cast<std::byte>(x * (c + 1) + 2 * y + 40 * c);
    noise[i] = static_cast<std::byte>(random());
    soft[i] = static_cast<std::byte>(100 + 20 * c + random() % 12);
    edge[i] = static_cast<std::byte>(x > y ? 30 * c : 255 - 60 * c);
    extremes[i] = static_cast<std::byte>(random() % 2 ? 255 : 0);
  }
  return {flat, gradient, noise, soft, edge, extremes};
}

TEST(BlockCodec, LosslessForAnyContentAndSize) {
  std::mt19937 random(2);
  std::vector<std::pair<int, int>> sizes{{64, 64}, {91, 90}, {1, 700}, {700, 1}, {65'535, 1}};
  for (int width = 1; width < 13; ++width)
    for (int height = 1; height < 13; ++height) sizes.emplace_back(width, height);
  for (const auto& [width, height] : sizes)
    for (const Bytes& block : make_blocks(width, height, random)) {
      const Bytes compressed = compress_rgb8(block, width, height);
      ASSERT_EQ(decompress_rgb8(compressed, width, height), block) << width << " × " << height;
      Bytes back(block.size());
      decompress_rgb8(compressed, width, height, back);
      ASSERT_EQ(back, block);
    }
}

TEST(BlockCodec, OneColourTakesFourBytesAndNoiseHardlyMoreThanItIs) {
  std::mt19937 random(3);
  const auto blocks = make_blocks(40, 30, random);
  EXPECT_EQ(compress_rgb8(blocks[0], 40, 30).size(), 4u);
  EXPECT_LT(compress_rgb8(blocks[1], 40, 30).size(), blocks[1].size() * 3 / 10);
  EXPECT_LT(compress_rgb8(blocks[2], 40, 30).size(), blocks[2].size() * 5 / 4);
  EXPECT_LT(compress_rgb8(blocks[3], 40, 30).size(), blocks[3].size() * 63 / 100);
}

/// Of pictures that this project renders: small blocks must not take much more than large ones.
TEST(BlockCodec, SmallBlocksOfPicturesStaySmall) {
  struct Case {
    const char* name;
    double small, large;  ///< bytes a pixel at most, of 8 × 8 and 40 × 40: 3 % more than measured
  };
  for (const Case& c :
       {Case{"primitives", 0.36, 0.28}, Case{"textures", 1.25, 1.16}, Case{"glasses", 1.29, 1.24}}) {
    ImageReader reader(std::string(RAYFARM_SOURCE "/scenes/") + c.name + ".png", 1 << 20);
    const size_t width = static_cast<size_t>(reader.width_px()),
                 height = static_cast<size_t>(reader.height_px());
    Bytes pixels;
    for (size_t y = 0; y < height; ++y)
      for (const float v : reader.next_row()) pixels.push_back(static_cast<std::byte>(std::lround(255 * v)));
    for (const auto& [side, most] : {std::pair{8, c.small}, std::pair{40, c.large}}) {
      const auto step = static_cast<size_t>(side);
      size_t bytes = 0, blocks = 0;
      for (size_t top = 0; top + step <= height; top += step)
        for (size_t left = 0; left + step <= width; left += step, ++blocks) {
          Bytes block;
          for (size_t y = top; y < top + step; ++y) {
            const auto row = pixels.begin() + static_cast<std::ptrdiff_t>(3 * (y * width + left));
            block.insert(block.end(), row, row + 3 * side);
          }
          const Bytes compressed = compress_rgb8(block, side, side);
          ASSERT_EQ(decompress_rgb8(compressed, side, side), block);
          bytes += compressed.size();
        }
      EXPECT_LT(static_cast<double>(bytes) / static_cast<double>(blocks * step * step), most)
          << c.name << side;
    }
  }
}

TEST(BlockCodec, DamagedBytesAreRefusedOrABlockNeverReadBeyond) {
  std::mt19937 random(4);
  int refused = 0, taken = 0;
  for (int i = 0; i < 4000; ++i) {
    const int width = 1 + static_cast<int>(random() % 12), height = 1 + static_cast<int>(random() % 12);
    Bytes bytes = compress_rgb8(make_blocks(width, height, random)[random() % 6], width, height);
    switch (random() % 4) {
      case 0:
        bytes.resize(random() % bytes.size());
        break;
      case 1:
        bytes.push_back(static_cast<std::byte>(random()));
        break;
      case 2:
        bytes[random() % bytes.size()] ^= static_cast<std::byte>(1 << random() % 8);
        break;
      default:
        for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    }
    try {
      EXPECT_EQ(decompress_rgb8(bytes, width, height).size(), bytes_of_block(width, height));
      ++taken;
    } catch (const ProtocolError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 3000);
  EXPECT_GT(taken, 0);  // a block of one colour is one with another, too
}

TEST(BlockCodec, AnotherSizeIsRefused) {
  std::mt19937 random(5);
  for (const Bytes& block : make_blocks(20, 17, random)) {
    Bytes compressed = compress_rgb8(block, 20, 17);
    EXPECT_THROW(compress_rgb8(block, 20, 18), ProtocolError);
    Bytes less(block.size() - 3);
    EXPECT_THROW(decompress_rgb8(compressed, 20, 17, less), ProtocolError);
    EXPECT_THROW(decompress_rgb8(compressed, 0, 17), ProtocolError);
    EXPECT_THROW(decompress_rgb8(compressed, 20, -1), ProtocolError);
    if (compressed.size() != 4) {
      EXPECT_THROW(decompress_rgb8(compressed, 21, 17), ProtocolError);
      EXPECT_THROW(decompress_rgb8(compressed, 20, 16), ProtocolError);
    }
  }
  EXPECT_THROW(decompress_rgb8({}, 4, 4), ProtocolError);
}

TEST(BlockCodec, ThreadsDoNotDisturbEachOther) {
  std::vector<std::thread> threads;
  std::array<bool, 4> is_right{};
  for (unsigned t = 0; t < is_right.size(); ++t)
    threads.emplace_back([&, t] {
      std::mt19937 random(t);
      bool all = true;
      for (int i = 1; i < 40; ++i)
        for (const Bytes& block : make_blocks(i, 41 - i, random))
          all = all && decompress_rgb8(compress_rgb8(block, i, 41 - i), i, 41 - i) == block;
      is_right[t] = all;
    });
  for (std::thread& thread : threads) thread.join();
  for (const bool right : is_right) EXPECT_TRUE(right);
}

TEST(BlockTables, EveryTokenCanBeCodedInEveryContext) {
  using namespace block_tables;
  for (const char* costs : kCosts) {
    ASSERT_EQ(std::string(costs).size(), static_cast<size_t>(block_model::kTokens));
    const Frequencies f = frequencies_of(costs);
    EXPECT_EQ(std::accumulate(f.begin(), f.end(), 0), kStates);
    EXPECT_GE(*std::min_element(f.begin(), f.end()), 1);
  }
}

TEST(BlockModel, DifferencesAreTokensAndBack) {
  using namespace block_model;
  for (int difference = -128; difference < 128; ++difference) {
    const int folded = fold(difference);
    EXPECT_EQ(unfold(folded), difference);
    const Token t = token_of(folded);
    EXPECT_LT(t.token, kTokens);
    EXPECT_GE(folded, t.base);
    EXPECT_LT(folded - t.base, 1 << t.bits);
  }
}

}  // namespace
}  // namespace rayfarm
