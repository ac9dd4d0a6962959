// Pixels of pictures in the making: bands that leave from the top, and the memory that they take.
#include "host/farm/frame_buffer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "host/farm/block_decoders.h"
#include "protocol/block_codec.h"

namespace rayfarm {
namespace {

constexpr PixelRect kWindow{5, 7, 5 + 61, 7 + 47};  // of odd size, off the origin
constexpr size_t kPixelOfTwoBytes = 2;

SubpolygonGrid grid_of_window(int columns, int rows) {
  return {kWindow.x0, kWindow.y0, kWindow.width(), kWindow.height(), columns, rows};
}

/// A pixel tells where it is.
std::vector<std::byte> pixels_of_polygon(const DisplayPolygon& p, int salt = 0) {
  std::vector<std::byte> pixels;
  for (int y = p.top; y <= p.bottom; ++y)
    for (int x = p.left; x <= p.right; ++x)
      for (const int v : {x + salt, y}) pixels.push_back(static_cast<std::byte>(v));
  return pixels;
}

std::vector<std::byte> whole_picture(int salt = 0) {
  return pixels_of_polygon({kWindow.x0, kWindow.y0, kWindow.x1 - 1, kWindow.y1 - 1}, salt);
}

void append(std::vector<std::byte>& all, const FrameBuffer::Band& band) {
  all.insert(all.end(), band->begin(), band->end());
}

TEST(FrameBuffer, BandsLeaveFromTheTopInWhateverOrderTheyBecomeWhole) {
  const SubpolygonGrid grid = grid_of_window(4, 6);
  std::vector<int> order(static_cast<size_t>(grid.count()));
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    FrameBuffer buffer(kWindow, kPixelOfTwoBytes, grid, 1 << 20);
    EXPECT_FALSE(buffer.is_streamed());
    EXPECT_EQ(buffer.end_of_room(), SubpolygonId(grid.count()));
    std::vector<std::byte> left;
    std::vector<int> come(6);
    for (const int i : order) {
      const SubpolygonId id(i);
      EXPECT_FALSE(buffer.is_there(id));
      buffer.store(id, pixels_of_polygon(grid.polygon(id)), true);
      EXPECT_TRUE(buffer.is_there(id));
      ++come[static_cast<size_t>(i / 4)];
      while (const auto band = buffer.take_band()) append(left, band);
      const auto whole = std::find_if(come.begin(), come.end(), [](int n) { return n < 4; }) - come.begin();
      const int bottom =
          whole == 6 ? kWindow.y1 : grid.polygon(SubpolygonId(static_cast<int>(whole) * 4)).top;
      ASSERT_EQ(left.size(), size_t(bottom - kWindow.y0) * 61 * kPixelOfTwoBytes);
    }
    EXPECT_EQ(left, whole_picture());
    for (int y = kWindow.y0; y < kWindow.y1; ++y)
      for (int x = kWindow.x0; x < kWindow.x1; ++x) ASSERT_EQ(int(buffer.pixel(x, y)[0]), x) << y;
  }
}

TEST(FrameBuffer, ALargerPictureKeepsNoMoreThanItMay) {
  const SubpolygonGrid grid = grid_of_window(3, 12);
  const size_t most = 4 * 4 * 61 * kPixelOfTwoBytes;  // four bands of at most four rows
  FrameBuffer buffer(kWindow, kPixelOfTwoBytes, grid, most);
  EXPECT_TRUE(buffer.is_streamed());
  std::vector<std::weak_ptr<const std::vector<std::byte>>> taken;
  std::vector<std::byte> left;
  size_t largest = 0;
  for (SubpolygonId i; i.value() < grid.count(); ++i) {
    ASSERT_LT(i, buffer.end_of_room());
    buffer.store(i, pixels_of_polygon(grid.polygon(i)), true);
    while (const auto band = buffer.take_band()) {
      append(left, band);
      taken.push_back(band);
    }
    size_t held = 0;
    for (const auto& band : taken)
      if (const auto there = band.lock()) held += there->size();
    largest = std::max(largest, held);
    EXPECT_LE(held, most);
    // The writer is two bands behind.
    if (i.value() % 3 == 2 && i.value() / 3 >= 2) buffer.let_go_band();
  }
  EXPECT_GT(largest, most / 2);
  EXPECT_EQ(left, whole_picture());
}

TEST(FrameBuffer, TwoBandsHaveRoomHoweverLittleThereIs) {
  const SubpolygonGrid grid = grid_of_window(3, 12);
  FrameBuffer buffer(kWindow, kPixelOfTwoBytes, grid, 1);
  EXPECT_EQ(buffer.end_of_room(), SubpolygonId(6));
  for (SubpolygonId i; i.value() < 3; ++i) buffer.store(i, pixels_of_polygon(grid.polygon(i)), true);
  ASSERT_TRUE(buffer.take_band());
  EXPECT_EQ(buffer.end_of_room(), SubpolygonId(6));
  buffer.let_go_band();
  EXPECT_EQ(buffer.end_of_room(), SubpolygonId(9));
}

TEST(FrameBuffer, WhatIsLentStaysAsItIs) {
  const SubpolygonGrid grid = grid_of_window(2, 3);
  FrameBuffer buffer(kWindow, kPixelOfTwoBytes, grid, 1 << 20);
  const auto store_all = [&](int salt, bool is_final) {
    for (SubpolygonId i; i.value() < grid.count(); ++i)
      buffer.store(i, pixels_of_polygon(grid.polygon(i), salt), is_final);
  };
  const auto together = [](const std::vector<FrameBuffer::Band>& bands) {
    std::vector<std::byte> all;
    for (const auto& band : bands) append(all, band);
    return all;
  };
  store_all(1, false);
  EXPECT_FALSE(buffer.take_band());
  const auto first = buffer.lend();
  store_all(2, false);
  EXPECT_EQ(together(first), whole_picture(1));
  buffer.end_lending();
  const auto second = buffer.lend();
  EXPECT_EQ(together(second), whole_picture(2));
  buffer.end_lending();
  store_all(3, true);
  std::vector<FrameBuffer::Band> last;
  while (auto band = buffer.take_band()) last.push_back(std::move(band));
  EXPECT_EQ(together(last), whole_picture(3));
  EXPECT_NE(last[0], first[0]);   // it was lent
  EXPECT_EQ(last[0], second[0]);  // it was no more: no copy was made
}

TEST(BlockDecoders, GiveAllBlocksOnceAndTellOfDamage) {
  constexpr int kBlocks = 300, kWidth = 24, kHeight = 17;
  std::mt19937 random(2);
  std::vector<std::vector<std::byte>> pixels(kBlocks);
  BlockDecoders decoders(3);
  EXPECT_FALSE(decoders.has_work());
  EXPECT_FALSE(decoders.try_take());
  for (int i = 0; i < kBlocks; ++i) {
    auto& own = pixels[static_cast<size_t>(i)];
    for (int j = 0; j < kWidth * kHeight * 3; ++j)
      own.push_back(static_cast<std::byte>(random() % 7 + unsigned(j % 24)));
    Bytes compressed = compress_rgb8(own, kWidth, kHeight);
    if (i % 10 == 9) compressed.resize(compressed.size() / 2);
    BlockResult block;
    block.report.subpolygon = SubpolygonId(i);
    block.is_compressed = true;
    block.pixels = compressed;
    Bytes message = encode_block(7, block);
    const BlockResult come = decode_block(message);
    decoders.submit(NodeId(i % 5 + 1), std::move(message), come, kWidth, kHeight);
  }
  std::vector<int> times(kBlocks);
  while (decoders.has_work()) {
    const auto decoded = decoders.try_take();
    if (!decoded) continue;
    const int i = decoded->block.report.subpolygon.value();
    ++times[static_cast<size_t>(i)];
    EXPECT_EQ(decoded->node, NodeId(i % 5 + 1));
    EXPECT_EQ(decode_block(decoded->message).report.subpolygon, SubpolygonId(i));
    EXPECT_EQ(decoded->problem.empty(), i % 10 != 9);
    if (!decoded->problem.empty()) continue;
    EXPECT_LT(decoded->net_bytes, decoded->pixels.size());
    EXPECT_TRUE(std::ranges::equal(decoded->block.pixels, pixels[static_cast<size_t>(i)]));
  }
  EXPECT_EQ(times, std::vector<int>(kBlocks, 1));
}

TEST(BlockDecoders, EndWithWorkLeft) {
  const std::vector<std::byte> pixels(3 * 64 * 64);
  BlockDecoders decoders(2);
  for (int i = 0; i < 100; ++i) {
    BlockResult block;
    const Bytes compressed = compress_rgb8(pixels, 64, 64);
    block.is_compressed = true;
    block.pixels = compressed;
    Bytes message = encode_block(7, block);
    const BlockResult come = decode_block(message);
    decoders.submit(NodeId(1), std::move(message), come, 64, 64);
  }
}

}  // namespace
}  // namespace rayfarm
