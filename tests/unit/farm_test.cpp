// Host and nodes as threads, with workers that misbehave.
#include <atomic>
#include <cmath>
#include <thread>

#include "common/image/image_file.h"
#include "common/scene/settings_codec.h"
#include "host/farm/farm_host.h"
#include "host/farm/preview.h"
#include "host/render/output_pattern.h"
#include "node/node.h"
#include "protocol/build_identity.h"
#include "protocol/local_transport.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

/// Paints every pixel with its coordinates; throws where told to.
class Painter : public PictureWorker {
 public:
  explicit Painter(std::function<bool(int frame, const DisplayPolygon&)> fails) : fails_(std::move(fails)) {}
  void set_zones(std::span<const std::byte>) override { FAIL() << "there are none"; }
  ItemResult work(FrameNumber number, const DisplayPolygon& p, const RenderPass& pass,
                  const std::function<void()>& pulse) override {
    const int frame = number.value();
    if (fails_(frame, p)) throw std::runtime_error("the tracer's own error");
    ItemResult painted;
    for (int y = p.top; y <= p.bottom; ++y)
      for (int x = p.left; x <= p.right; ++x)
        for (const int v : {x, y, frame}) painted.bytes.push_back(static_cast<std::byte>(v));
    painted.rays[RayKind::primary] = painted.bytes.size() / 3;
    if (!pass.is_last()) painted.running = painted.bytes;
    pulse();
    return painted;
  }

 private:
  std::function<bool(int, const DisplayPolygon&)> fails_;
};

struct FarmRun {
  JobResult result;
  std::vector<std::string> told;
  std::filesystem::path folder;
};

using RunNode = std::function<void(Transport& transport, NodeId node)>;

RunNode painting_nodes(std::function<bool(int, const DisplayPolygon&)> fails) {
  return [fails](Transport& transport, NodeId node) {
    run_node(
        transport, node, [](const ProcessSign&) { return std::span<const std::byte>(); },
        {[&fails](const JobPlan&, std::span<const std::byte>) { return std::make_unique<Painter>(fails); },
         {}});
  };
}

bool never(int, const DisplayPolygon&) {
  return false;
}

/// A node that can't load.
void run_failing_node(Transport& transport, NodeId node) {
  run_node(transport, node, [](const ProcessSign&) { return std::span<const std::byte>(); },
           {[](const JobPlan&, std::span<const std::byte>) -> std::unique_ptr<PictureWorker> {
              throw std::runtime_error("no room");
            },
            {}});
}

FarmRun run_farm(int nodes, std::vector<int> frames, AssignmentPolicy policy, Wire wire,
                 const RunNode& run_one_node, const Bytes& settings = {},
                 const std::function<void(FarmHostOptions&)>& change = {}) {
  FarmRun run;
  run.folder = std::filesystem::path(test::write_temporary("farm-marker", "")).parent_path();
  const auto ends = make_local_transports(nodes);
  std::vector<std::thread> threads;
  for (int i = 1; i <= nodes; ++i)
    threads.emplace_back(
        [&ends, &run_one_node, i] { run_one_node(*ends[static_cast<size_t>(i)], NodeId(i)); });
  FarmHostOptions options;
  options.plan.build = build_identity();
  options.plan.pictures.grid = make_grid(0, 0, 40, 30, nodes);
  for (const int frame : frames) options.plan.pictures.frames.emplace_back(frame);
  options.plan.policy = policy;
  options.plan.wire = wire;
  options.plan.processors = nodes;
  options.plan.settings = settings;
  options.image = {40, 30, {0, 0, 40, 30}, make_pixel_layout(PixelFormat::rgb8), {}};
  options.progress = ProgressStyle::none;
  for (const int frame : frames)
    options.files.push_back((run.folder / fmt::format("f{}.png", frame)).string());
  if (change) change(options);
  for (int i = 1; i <= nodes; ++i) {
    run.result.nodes.push_back({});
    run.result.nodes.back().id = NodeId(i);
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
      const FarmRun run = run_farm(3, {4, 9}, policy, wire, painting_nodes(never));
      EXPECT_EQ(run.result.frames_failed(), 0u);
      const std::vector<float> pixels = test::read_pixels(run.result.frames[1].file);
      for (size_t y = 0; y < 30; ++y)
        for (size_t x = 0; x < 40; ++x) {
          EXPECT_NEAR(pixels[3 * (y * 40 + x)] * 255, static_cast<float>(x), 0.01);
          EXPECT_NEAR(pixels[3 * (y * 40 + x) + 1] * 255, static_cast<float>(y), 0.01);
          EXPECT_NEAR(pixels[3 * (y * 40 + x) + 2] * 255, 9.0f, 0.01);
        }
      EXPECT_EQ(run.result.rays[RayKind::primary], 2u * 40 * 30);
    }
}

TEST(Farm, APictureLargerThanItsMemoryIsTheSame) {
  for (const auto wire : {Wire::block, Wire::pixel}) {
    const FarmRun whole = run_farm(3, {4, 9, 11}, AssignmentPolicy::on_demand, wire, painting_nodes(never));
    const FarmRun streamed = run_farm(3, {4, 9, 11}, AssignmentPolicy::on_demand, wire, painting_nodes(never),
                                      {}, [](FarmHostOptions& options) {
                                        options.frame_bytes = 3 * 40 * 8;
                                        options.window_frames = 1;
                                      });
    EXPECT_TRUE(streamed.told.empty());
    for (size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(streamed.result.frames[i].is_written);
      EXPECT_EQ(streamed.result.frames[i].sha256, whole.result.frames[i].sha256);
    }
  }
}

TEST(Farm, APictureThatCannotBeWrittenEndsSoonAndTheNextIsMade) {
  std::atomic<int> traced{0};
  const auto count = [&traced](int frame, const DisplayPolygon&) {
    if (frame == 4) {
      ++traced;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  };
  const FarmRun run = run_farm(2, {4, 9}, AssignmentPolicy::on_demand, Wire::block, painting_nodes(count), {},
                               [](FarmHostOptions& options) {
                                 options.plan.pictures.grid = {0, 0, 40, 30, 40, 30};
                                 options.files[0] = "/nowhere/at/all.png";
                                 options.frame_bytes = 3 * 40 * 8;
                                 options.window_frames = 1;
                               });
  EXPECT_NE(run.result.frames[0].problem.find("/nowhere/at/all.png"), std::string::npos);
  EXPECT_TRUE(run.result.frames[1].is_written);
  EXPECT_LT(traced, 600);  // of 1,200
  ASSERT_EQ(run.told.size(), 1u);
  EXPECT_NE(run.told[0].find("frame 4 failed"), std::string::npos);
}

TEST(Farm, PassesOfAPictureThatCannotBeWrittenEnd) {
  // Items of the last pass are about to be handed out, with what the pass before gave, when the first band
  // fails.
  for (int round = 0; round < 5; ++round) {
    const FarmRun run = run_farm(2, {4, 9}, AssignmentPolicy::on_demand, Wire::block, painting_nodes(never),
                                 {}, [](FarmHostOptions& options) {
                                   options.plan.pictures.grid = {0, 0, 40, 30, 40, 30};
                                   options.plan.pictures.passes = 3;
                                   options.passes = {3, 3};
                                   options.files[0] = "/nowhere/at/all.png";
                                 });
    EXPECT_NE(run.result.frames[0].problem.find("/nowhere/at/all.png"), std::string::npos);
    EXPECT_TRUE(run.result.frames[1].is_written);
  }
}

TEST(FrameWriter, WhatIsDroppedIsNotWrittenFirst) {
  const auto folder = std::filesystem::path(test::write_temporary("writer-marker", "")).parent_path();
  const Image image{1024, 12800, {0, 0, 1024, 12800}, make_pixel_layout(PixelFormat::half_float), {}};
  const auto band = std::make_shared<std::vector<std::byte>>(size_t{1024} * 64 * image.layout.bytes);
  for (size_t i = 0; i < band->size(); ++i) (*band)[i] = static_cast<std::byte>(i * i >> 3);
  const std::filesystem::path file = folder / "dropped.exr";
  std::filesystem::remove(file);
  FrameWriter writer;
  const PictureInWriting picture = writer.begin({FrameIndex(0), file.string(), image, {}});
  for (int i = 0; i < 200; ++i) writer.write(picture, band);
  writer.drop(picture);
  writer.finish();
  int written = 0;
  while (writer.try_take_band()) ++written;
  EXPECT_LT(written, 100);
  EXPECT_FALSE(writer.try_take());
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(band.use_count(), 1);
}

TEST(Farm, NodesOfOneProcessRenderAScene) {
  // As a render without mpirun has it: threads that share the scene's block.
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/animation.yaml"));
  const auto frame_hash = [&](int nodes) {
    RenderSettings settings;
    settings.width_px = 40;
    settings.height_px = 30;
    settings.crop = {0, 0, 40, 30};
    settings.pixel_format = PixelFormat::rgb8;
    const FarmRun run = run_farm(
        nodes, {1, 2, 3}, AssignmentPolicy::on_demand, Wire::block,
        [&](Transport& transport, NodeId node) {
          run_node(transport, node, [&](const ProcessSign&) { return compiled.block.bytes(); },
                   {make_scene_worker, {}});
        },
        encode_settings(settings));
    EXPECT_EQ(run.result.frames_failed(), 0u);
    EXPECT_TRUE(run.result.frames[2].sees_anything);
    EXPECT_EQ(run.result.frames[2].not_finite, 0u);
    return run.result.frames[2].sha256;
  };
  EXPECT_EQ(frame_hash(1), frame_hash(5));
}

TEST(Farm, AnErrorThatGoesAwayIsRetried) {
  std::atomic<int> failures{2};
  const FarmRun run = run_farm(2, {1}, AssignmentPolicy::on_demand, Wire::block,
                               painting_nodes([&](int, const DisplayPolygon& p) {
                                 return p.left == 0 && p.top == 0 && failures-- > 0;
                               }));
  EXPECT_EQ(run.result.frames_failed(), 0u);
  EXPECT_EQ(run.told.size(), 2u);
  EXPECT_TRUE(run.result.frames[0].is_written);
}

TEST(Farm, ThreeErrorsFailTheFrameWithTheMessageAndNotTheNext) {
  for (const auto policy : {AssignmentPolicy::on_demand, AssignmentPolicy::interleaved}) {
    std::filesystem::remove(std::filesystem::path(test::write_temporary("farm-marker", "")).parent_path() /
                            "f1.png");
    const FarmRun run =
        run_farm(2, {1, 2}, policy, Wire::block, painting_nodes([](int frame, const DisplayPolygon& p) {
                   return frame == 1 && p.left == 0 && p.top == 0;
                 }));
    EXPECT_EQ(run.result.frames_failed(), 1u);
    EXPECT_NE(run.result.frames[0].problem.find("the tracer's own error"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(run.result.frames[0].file));
    EXPECT_TRUE(run.result.frames[1].is_written);
  }
}

TEST(Farm, ANodeThatCanNotLoadIsExpelledAndTheOthersDoTheWork) {
  for (const auto policy : {AssignmentPolicy::on_demand, AssignmentPolicy::interleaved}) {
    const FarmRun run = run_farm(3, {1, 2}, policy, Wire::block, [](Transport& transport, NodeId node) {
      node == NodeId(2) ? run_failing_node(transport, node) : painting_nodes(never)(transport, node);
    });
    EXPECT_EQ(run.result.frames_failed(), 0u);
    EXPECT_TRUE(run.result.frames[1].is_written);
    EXPECT_EQ(run.result.lost_nodes(), std::vector<NodeId>{NodeId(2)});
    EXPECT_NE(run.result.nodes[1].problem.find("no room"), std::string::npos);
    ASSERT_EQ(run.told.size(), 1u);
    EXPECT_NE(run.told[0].find("could not load the scene: no room"), std::string::npos) << run.told[0];
  }
}

TEST(Farm, WhenNoNodeCanLoadTheJobEndsAndSaysWhy) {
  const FarmRun run = run_farm(3, {1}, AssignmentPolicy::on_demand, Wire::block, run_failing_node);
  EXPECT_TRUE(run.result.lost_all_nodes);
  EXPECT_NE(run.result.first_problem().find("no room"), std::string::npos);
  EXPECT_FALSE(run.result.frames[0].is_written);
}

TEST(Farm, ALivingNodeThatSendsNonsenseIsExpelled) {
  // Node 1 answers its work with bytes that mean nothing, and then with good ones, which nobody trusts any
  // more.
  for (const Channel channel : {Channel::command, Channel::pixels, Channel::control}) {
    const FarmRun run =
        run_farm(3, {1, 2}, AssignmentPolicy::on_demand, Wire::block, [&](Transport& transport, NodeId node) {
          if (node != NodeId(1)) {
            painting_nodes(never)(transport, node);
            return;
          }
          transport.send(kHost, channel, Bytes(7, std::byte{0xfe}));
          Backoff backoff;
          for (bool is_over = false; !is_over; backoff.wait())
            while (const auto message = transport.try_receive()) {
              is_over |= message->channel == Channel::control &&
                         std::holds_alternative<Finish>(decode_control(message->bytes));
              transport.send(kHost, Alive{});
            }
        });
    EXPECT_EQ(run.result.frames_failed(), 0u);
    EXPECT_TRUE(run.result.frames[0].is_written && run.result.frames[1].is_written);
    EXPECT_EQ(run.result.lost_nodes(), std::vector<NodeId>{NodeId(1)});
    EXPECT_EQ(run.result.nodes[0].subpolygons, 0u);
    ASSERT_FALSE(run.told.empty());
    EXPECT_NE(run.told[0].find("can't be understood"), std::string::npos) << run.told[0];
  }
}

TEST(Preview, ShowsEveryOtherPixelOfWhatIsThere) {
  const int width = 4200, height = 31;  // more than is shown as it is
  const PixelRect window{10, 20, 10 + width, 20 + height};
  Image image{5000, 60, window, make_pixel_layout(PixelFormat::rgb8), {}};
  std::vector<std::byte> pixels(3 * static_cast<size_t>(window.area()));
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::byte>(i * 7919 % 251);
  const SubpolygonGrid grid{window.x0, window.y0, width, height, 7, 5};
  FrameBuffer buffer(window, 3, grid, pixels.size());
  for (SubpolygonId i; i.value() < grid.count(); ++i) {
    if (i.value() % 3 == 1) continue;
    const DisplayPolygon p = grid.polygon(i);
    std::vector<std::byte> own;
    for (int y = p.top; y <= p.bottom; ++y) {
      const auto* row = pixels.data() + 3 * ((y - window.y0) * width + (p.left - window.x0));
      own.insert(own.end(), row, row + 3 * (p.right - p.left + 1));
    }
    buffer.store(i, own, true);
  }
  const std::string path = test::write_temporary("some.partial.png", "");
  std::filesystem::remove(path);
  write_preview(path, image, buffer);
  EXPECT_TRUE(is_preview(path));
  ASSERT_EQ(read_image_info(path).window, (PixelRect{0, 0, 2100, 16}));
  const std::vector<float> shown = test::read_pixels(path);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 2100; ++x) {
      SubpolygonId i;
      const auto holds = [&](const DisplayPolygon& p) {
        return p.left <= 10 + 2 * x && 10 + 2 * x <= p.right && p.top <= 20 + 2 * y && 20 + 2 * y <= p.bottom;
      };
      while (!holds(grid.polygon(i))) ++i;
      const size_t from = 3 * static_cast<size_t>(2 * y * width + 2 * x);
      const int expected = buffer.is_there(i)           ? static_cast<int>(pixels[from])
                           : (x / 16 + y / 16) % 2 == 1 ? 160
                                                        : 96;
      ASSERT_EQ(std::lround(255 * shown[3 * static_cast<size_t>(2100 * y + x)]), expected) << x << " " << y;
    }
}

TEST(Frames, AreParsedAndNamed) {
  const auto numbers = [](const std::string& text) {
    std::vector<int> frames;
    for (const FrameNumber frame : parse_frames(text)) frames.push_back(frame.value());
    return frames;
  };
  EXPECT_EQ(numbers("1-10x3"), (std::vector<int>{1, 4, 7, 10}));
  EXPECT_EQ(numbers("5,1-3"), (std::vector<int>{5, 1, 2, 3}));
  for (const char* wrong : {"", "a", "1-", "3-1", "1-3x0", "1,,2", "1,1", "99999999", "1-9999999"})
    EXPECT_THROW(parse_frames(wrong), std::invalid_argument) << wrong;
  EXPECT_EQ(file_of_frame("a/shot.####.exr", FrameNumber(7)), "a/shot.0007.exr");
  EXPECT_EQ(file_of_frame("shot.##.exr", FrameNumber(123)), "shot.123.exr");
  EXPECT_EQ(file_of_frame("shot.exr", FrameNumber(7)), "shot.exr");
}

}  // namespace
}  // namespace rayfarm
