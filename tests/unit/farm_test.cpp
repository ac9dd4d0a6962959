// Host and nodes as threads, with tracers that misbehave.
#include <thread>

#include "host/farm_host.h"
#include "host/output_pattern.h"
#include "node/node.h"
#include "protocol/build_identity.h"
#include "protocol/local_transport.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

/// Paints every pixel with its coordinates; throws where told to.
class PaintingTracer : public SubpolygonTracer {
 public:
  explicit PaintingTracer(std::function<bool(int frame, const DisplayPolygon&)> fails)
      : fails_(std::move(fails)) {}
  Traced trace(int frame, const DisplayPolygon& p, const std::function<void()>& pulse) override {
    if (fails_(frame, p)) throw std::runtime_error("the tracer's own error");
    Traced traced;
    for (int y = p.top; y <= p.bottom; ++y)
      for (int x = p.left; x <= p.right; ++x)
        for (const int v : {x, y, frame}) traced.pixels.push_back(static_cast<std::byte>(v));
    traced.rays[0] = traced.pixels.size() / 3;
    pulse();
    return traced;
  }

 private:
  std::function<bool(int, const DisplayPolygon&)> fails_;
};

struct FarmRun {
  JobResult result;
  std::vector<std::string> told;
  std::filesystem::path folder;
};

FarmRun run_farm(int nodes, std::vector<int> frames, AssignmentPolicy policy, Wire wire,
                 std::function<bool(int, const DisplayPolygon&)> fails) {
  FarmRun run;
  run.folder = std::filesystem::path(test::write_temporary("farm-marker", "")).parent_path();
  const auto ends = make_local_transports(nodes);
  std::vector<std::thread> threads;
  for (int i = 1; i <= nodes; ++i)
    threads.emplace_back([&ends, &fails, i] {
      run_node(
          *ends[static_cast<size_t>(i)], i, [] { return std::span<const std::byte>(); },
          [&fails](const JobPlan&, std::span<const std::byte>) {
            return std::make_unique<PaintingTracer>(fails);
          });
    });
  FarmHostOptions options;
  options.plan.build = build_identity();
  options.plan.frames = frames;
  options.plan.policy = policy;
  options.plan.wire = wire;
  options.plan.processors = nodes;
  options.plan.grid = make_grid(0, 0, 40, 30, nodes);
  options.image = {40, 30, {0, 0, 40, 30}, PixelFormat::rgb8, {}};
  options.progress = ProgressStyle::none;
  for (const int frame : frames)
    options.files.push_back((run.folder / fmt::format("f{}.png", frame)).string());
  for (int i = 1; i <= nodes; ++i) {
    run.result.nodes.push_back({});
    run.result.nodes.back().id = i;
  }
  ends[0]->broadcast(Channel::command, encode_load_code(encode_plan(options.plan)));
  {
    FarmHost host(*ends[0], options, run.result, [&](const std::string& text) { run.told.push_back(text); });
    host.run();
  }
  ends[0]->broadcast(Channel::control, encode_control(Finish{}));
  for (std::thread& t : threads) t.join();
  return run;
}

TEST(Farm, EveryPolicyAndWireAssemblesThePicture) {
  for (const auto policy : {AssignmentPolicy::on_demand, AssignmentPolicy::interleaved})
    for (const auto wire : {Wire::block, Wire::pixel}) {
      const FarmRun run = run_farm(3, {4, 9}, policy, wire, [](int, const DisplayPolygon&) { return false; });
      EXPECT_EQ(run.result.frames_failed(), 0u);
      const std::vector<float> pixels = test::read_pixels(run.result.frames[1].file);
      for (size_t y = 0; y < 30; ++y)
        for (size_t x = 0; x < 40; ++x) {
          EXPECT_NEAR(pixels[3 * (y * 40 + x)] * 255, static_cast<float>(x), 0.01);
          EXPECT_NEAR(pixels[3 * (y * 40 + x) + 1] * 255, static_cast<float>(y), 0.01);
          EXPECT_NEAR(pixels[3 * (y * 40 + x) + 2] * 255, 9.0f, 0.01);
        }
      EXPECT_EQ(run.result.rays[0], 2u * 40 * 30);
    }
}

TEST(Farm, AnErrorThatGoesAwayIsRetried) {
  std::atomic<int> failures{2};
  const FarmRun run =
      run_farm(2, {1}, AssignmentPolicy::on_demand, Wire::block,
               [&](int, const DisplayPolygon& p) { return p.left == 0 && p.top == 0 && failures-- > 0; });
  EXPECT_EQ(run.result.frames_failed(), 0u);
  EXPECT_EQ(run.told.size(), 2u);
  EXPECT_TRUE(run.result.frames[0].is_written);
}

TEST(Farm, ThreeErrorsFailTheFrameWithTheMessageAndNotTheNext) {
  for (const auto policy : {AssignmentPolicy::on_demand, AssignmentPolicy::interleaved}) {
    std::filesystem::remove(std::filesystem::path(test::write_temporary("farm-marker", "")).parent_path() /
                            "f1.png");
    const FarmRun run = run_farm(2, {1, 2}, policy, Wire::block, [&](int frame, const DisplayPolygon& p) {
      return frame == 1 && p.left == 0 && p.top == 0;
    });
    EXPECT_EQ(run.result.frames_failed(), 1u);
    EXPECT_NE(run.result.frames[0].problem.find("the tracer's own error"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(run.result.frames[0].file));
    EXPECT_TRUE(run.result.frames[1].is_written);
  }
}

TEST(Frames, AreParsedAndNamed) {
  EXPECT_EQ(parse_frames("1-10x3"), (std::vector<int>{1, 4, 7, 10}));
  EXPECT_EQ(parse_frames("5,1-3"), (std::vector<int>{5, 1, 2, 3}));
  for (const char* wrong : {"", "a", "1-", "3-1", "1-3x0", "1,,2", "1,1", "99999999", "1-9999999"})
    EXPECT_THROW(parse_frames(wrong), std::invalid_argument) << wrong;
  EXPECT_EQ(file_of_frame("a/shot.####.exr", 7), "a/shot.0007.exr");
  EXPECT_EQ(file_of_frame("shot.##.exr", 123), "shot.123.exr");
  EXPECT_EQ(file_of_frame("shot.exr", 7), "shot.exr");
}

}  // namespace
}  // namespace rayfarm
