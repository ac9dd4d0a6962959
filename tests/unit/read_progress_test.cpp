// People who wait for a scene see how much of its files is read.
#include "common/description/read_progress.h"

#include <thread>

#include "host/farm/progress.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

std::string long_points() {
  std::string points = "[[0, 0, 0], [1, 0, 0], [0, 1, 0]";
  for (int i = 0; i < 100'000; ++i) points += fmt::format(", [{}, 1, 0.5]", i);
  return points + "]";
}

/// What is counted of a scene, while a thread looks whether it ever counts down or beyond all.
std::array<uint64_t, 2> read_of(const std::string& scene) {
  ReadProgress progress;
  {
    uint64_t before = 0;
    std::jthread watcher([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const uint64_t done = progress.done, total = progress.total;
        EXPECT_TRUE(before <= done && done <= total) << before << " " << done << " " << total;
        before = done;
        std::this_thread::yield();
      }
    });
    load_scene(scene, {.progress = &progress});
  }
  return {progress.done, progress.total};
}

TEST(ReadProgress, CountsEveryByteOfTextFiles) {
  std::string obj, nff = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 9 9\n";
  for (int i = 0; i < 60'000; ++i) {
    obj += fmt::format("v {} 0 0\nv {} 1 0\nv {} 0 1\nf -1 -2 -3\n", i, i, i);
    nff += fmt::format("s {} 0 0 0.5\n", i);
  }
  test::write_temporary("counted.obj", obj);
  const std::string short_yaml = test::view_text() + "scene: [{mesh: {file: counted.obj}}]\n";
  const std::string yaml = test::view_text() +
                           "scene:\n- mesh: {file: counted.obj}\n- triangles: {points: " + long_points() +
                           ", triangles: [[0, 1, 2]]}\n";
  const auto both = [](uint64_t bytes) { return std::array{bytes, bytes}; };
  EXPECT_EQ(read_of(test::write_temporary("counted.nff", nff)), both(nff.size()));
  EXPECT_EQ(read_of(test::write_temporary("counted.yaml", short_yaml)), both(short_yaml.size() + obj.size()));
  EXPECT_EQ(read_of(test::write_temporary("counted.yaml", yaml)), both(yaml.size() + obj.size()));
}

/// Where a long list is not what it seems, the files are read twice and count twice.
TEST(ReadProgress, CountsWhatIsReadAgain) {
  const std::string yaml = test::view_text() +
                           "scene: [{polygon: {points: [[0, 0, 0], [1, 0, 0], [0, 1, +-0]" +
                           std::string(300, ' ') + "]}}]\n";
  EXPECT_EQ(read_of(test::write_temporary("again.yaml", yaml)),
            (std::array<uint64_t, 2>{2 * yaml.size(), 2 * yaml.size()}));
}

TEST(ReadProgress, IsShownInMegabytes) {
  testing::internal::CaptureStderr();
  Progress terminal(ProgressStyle::tty);
  terminal.show_bytes("reading", 1.5, 0, 0);  // nothing is open yet
  terminal.show_bytes("reading", 1.5, 1'000'000, 4'000'000);
  terminal.show_bytes("reading", 1.6, 2'000'000, 4'000'000);  // too soon
  Progress(ProgressStyle::plain).show_bytes("reading", 1.5, 1'000'000, 4'000'000);
  Progress(ProgressStyle::plain).show_bytes("reading", 5, 3'000'000, 4'000'000);
  Progress(ProgressStyle::none).show_bytes("reading", 9, 1'000'000, 4'000'000);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "\r\033[K[######..................]  25.0 %  0:02  reading 1.0 of 4.0 MB"
            " 75.0 %  0:05  reading 3.0 of 4.0 MB\n");
}

TEST(ReadProgress, IsJsonForPrograms) {
  testing::internal::CaptureStderr();
  Progress progress(ProgressStyle::json, 4000);
  progress.show_bytes("sending", 1.5, 1'000'000, 4'000'000);
  progress.show(2.0, 1, 0, 1, 1, 2);  // too soon
  progress.show(3.0, 2500, 1000, 9000, 750, 2);
  progress.show(3.5, 4000, 1000, 9000, 1500, 2, true);
  EXPECT_EQ(
      testing::internal::GetCapturedStderr(),
      "{\"bytes\":1000000,\"bytes_total\":4000000,\"elapsed_s\":1.5,\"phase\":\"sending\",\"share\":0.25}\n"
      "{\"bytes_per_pixel\":0.5,\"elapsed_s\":3.0,\"eta_s\":3.0,\"nodes\":2,\"phase\":\"tracing\","
      "\"pixels\":"
      "2500,"
      "\"pixels_total\":4000,\"rays\":9000,\"share\":0.625}\n"
      "{\"bytes_per_pixel\":0.5,\"elapsed_s\":3.5,\"eta_s\":0.0,\"nodes\":2,\"phase\":\"tracing\",\"pixels\":"
      "4000,"
      "\"pixels_total\":4000,\"rays\":9000,\"share\":1.0}\n");
}

}  // namespace
}  // namespace rayfarm
