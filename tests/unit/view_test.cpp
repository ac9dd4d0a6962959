#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "host/view/farm_view.h"
#include "host/view/tev_display.h"
#include "protocol/byte_stream.h"
#include "protocol/subpolygons.h"

namespace rayfarm {
namespace {

WatchedJob job_of(int width, int height, size_t frames) {
  WatchedJob job;
  job.image.width_px = width;
  job.image.height_px = height;
  job.image.window = {0, 0, width, height};
  job.image.layout = make_pixel_layout(PixelFormat::rgb8);
  job.files.resize(frames, "a.png");
  return job;
}

/// Every pixel of the subpolygon has this value.
void show(Watcher& watcher, int frame, NodeId node, const DisplayPolygon& p, int value) {
  const std::vector<std::byte> pixels(
      static_cast<size_t>(3 * (p.right - p.left + 1) * (p.bottom - p.top + 1)),
      static_cast<std::byte>(value));
  watcher.see({FrameIndex(frame), FrameNumber(frame + 10), node, p, pixels});
}

struct Update {
  int frame, node, x, y, width, height, value;
  bool operator==(const Update&) const = default;
};

struct Answer {
  uint64_t last = 0;
  std::vector<Update> updates;
};

Answer read_updates(const std::string& text) {
  ByteReader reader(std::as_bytes(std::span(text)));
  Answer answer{reader.u64(), {}};
  reader.u32();
  for (uint32_t left = reader.u32(); left > 0; --left) {
    Update u{static_cast<int>(reader.u32()),
             reader.u16(),
             reader.u16(),
             reader.u16(),
             reader.u16(),
             reader.u16(),
             0};
    const auto pixels = reader.bytes(static_cast<size_t>(3 * u.width * u.height));
    u.value = static_cast<int>(pixels.front());
    for (const std::byte b : pixels) EXPECT_EQ(b, pixels.front());
    answer.updates.push_back(u);
  }
  reader.expect_end();
  return answer;
}

}  // namespace

TEST(SubpolygonQueue, HoldsNoMoreThanItMay) {
  SubpolygonQueue queue(100);
  const std::vector<std::byte> pixels(60);
  SeenSubpolygon seen;
  seen.pixels = pixels;
  for (int i = 0; i < 3; ++i) queue.push(seen);
  EXPECT_EQ(queue.dropped(), 2u);
  const auto item = queue.pop();
  ASSERT_TRUE(item);
  EXPECT_EQ(item->subpolygon.pixels.size(), 60u);
  EXPECT_EQ(item->subpolygon.pixels.data(), item->pixels.data());
  queue.push(seen);
  queue.close();
  queue.push(seen);
  EXPECT_EQ(queue.dropped(), 3u);
  EXPECT_TRUE(queue.pop());
  EXPECT_FALSE(queue.pop());
}

TEST(FarmView, TellsWhatChangedSince) {
  FarmView view("s.yaml", "a.#.png");
  view.begin(job_of(8, 4, 2));
  show(view, 0, NodeId(1), {0, 0, 3, 3}, 7);
  show(view, 1, NodeId(2), {4, 0, 7, 1}, 9);
  view.end("all is done");
  const Answer all = read_updates(view.updates(0));
  EXPECT_EQ(all.last, 2u);
  EXPECT_EQ(all.updates, (std::vector<Update>{{10, 1, 0, 0, 4, 4, 7}, {11, 2, 4, 0, 4, 2, 9}}));
  EXPECT_EQ(read_updates(view.updates(1)).updates, (std::vector<Update>{{11, 2, 4, 0, 4, 2, 9}}));
  EXPECT_TRUE(read_updates(view.updates(2)).updates.empty());
  EXPECT_TRUE(read_updates(view.updates(~uint64_t{0})).updates.empty());
  EXPECT_NE(view.state().find("\"outcome\":\"all is done\""), std::string::npos);
}

TEST(FarmView, KeepsTheLastFrames) {
  FarmView view("s.yaml", "a.#.png");
  view.begin(job_of(8, 4, 20));
  for (int frame = 0; frame < 20; ++frame) show(view, frame, NodeId(1), {0, 0, 7, 3}, frame);
  show(view, 1, NodeId(1), {0, 0, 7, 3}, 200);  // late: its picture is gone
  view.end("all is done");
  const Answer all = read_updates(view.updates(0));
  ASSERT_EQ(all.updates.size(), 16u);
  EXPECT_EQ(all.updates.front().frame, 14);
  EXPECT_EQ(all.updates.back().frame, 29);
}

TEST(FarmView, AnswersInParts) {
  FarmView view("s.yaml", "a.png");
  view.begin(job_of(3000, 1000, 1));
  for (uint16_t row = 0; row < 1000; ++row) show(view, 0, NodeId(1), {0, row, 2999, row}, row % 251);
  view.end("all is done");
  uint64_t since = 0;
  size_t answers = 0, updates = 0;
  for (; since < 1000; ++answers) {
    const std::string text = view.updates(since);
    EXPECT_LT(text.size(), 5u << 20);
    const Answer answer = read_updates(text);
    updates += answer.updates.size();
    ASSERT_EQ(answer.last, since + answer.updates.size());
    since = answer.last;
  }
  EXPECT_EQ(updates, 1000u);
  EXPECT_EQ(answers, 3u);
}

TEST(FarmView, IsReadWhileItGrows) {
  FarmView view("s\xff.yaml", "a.png");  // a name that is no UTF-8
  std::atomic<bool> is_over = false;
  std::thread reader([&] {
    while (!is_over) {
      read_updates(view.updates(0));
      EXPECT_NE(view.state().find("s?.yaml"), std::string::npos);
    }
  });
  view.begin(job_of(64, 64, 1));
  for (uint16_t i = 0; i < 64; ++i) {
    show(view, 0, NodeId(1), {0, i, 63, i}, i);
    FarmStatus status;
    status.now_s = i;
    status.rays = static_cast<uint64_t>(100 * i);
    status.nodes.resize(2);
    view.hear(status);
  }
  EXPECT_NE(view.state().find("\"rays_per_s\":100.0"), std::string::npos) << view.state();
  view.end("all is done");
  is_over = true;
  reader.join();
  EXPECT_EQ(read_updates(view.updates(0)).updates.size(), 64u);
}

TEST(TevAddress, IsRead) {
  EXPECT_EQ(parse_tev_address("tev://localhost").port, "14158");
  EXPECT_EQ(parse_tev_address("tev://localhost:5/").host, "localhost");
  EXPECT_EQ(parse_tev_address("tev://[::1]:77").host, "::1");
  EXPECT_EQ(parse_tev_address("tev://[::1]:77").port, "77");
  EXPECT_EQ(parse_tev_address("tev://[::1]").port, "14158");
  for (const char* text : {"", "tev:", "localhost:1", "tev://", "tev://:5", "tev://h:", "tev://h:65536",
                           "tev://h:1x", "tev://[::1]5", "http://h:1"})
    EXPECT_THROW(parse_tev_address(text), std::invalid_argument) << text;
}

}  // namespace rayfarm
