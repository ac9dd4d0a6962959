// Stages of zones on a farm of threads: the sums are those of one that works alone, whoever does what.
#include <atomic>
#include <thread>

#include "host/farm/farm_host.h"
#include "node/node.h"
#include "protocol/build_identity.h"
#include "protocol/byte_codec.h"
#include "protocol/local_transport.h"
#include "tests/fake_zones.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using test::FakeZones;

struct ZonesCase {
  FakeZones zones;
  int nodes = 3;
  AssignmentPolicy policy = AssignmentPolicy::on_demand;
  std::vector<FrameGroup> groups;  ///< of two frames; empty: one
  /// Fails in `work` if it throws.
  std::function<void(NodeId node, uint64_t first)> before_item = [](NodeId, uint64_t) {};
  std::function<void(NodeId node, const std::function<void()>& pulse)> hang = [](NodeId, const auto&) {};
  std::function<std::unique_ptr<ZoneSolver>(FrameNumber)> make_solver;
  std::function<std::optional<Bytes>(FrameNumber)> find;
};

/// Remembers what pictures are given, and paints all alike.
class Listener : public PictureWorker {
 public:
  explicit Listener(std::vector<Bytes>& given) : given_(given) {}
  void set_zones(std::span<const std::byte> solution) override {
    given_.emplace_back(solution.begin(), solution.end());
  }
  ItemResult work(FrameNumber, const DisplayPolygon& p, const RenderPass&,
                  const std::function<void()>&) override {
    ItemResult result;
    result.bytes =
        Bytes(static_cast<size_t>(3 * (p.right - p.left + 1) * (p.bottom - p.top + 1)), std::byte{9});
    return result;
  }

 private:
  std::vector<Bytes>& given_;
};

class HurtTracer : public test::FakeTracer {
 public:
  HurtTracer(const ZonesCase& c, NodeId node) : FakeTracer(c.zones), case_(c), node_(node) {}
  ZoneItemResult work(uint64_t first, uint64_t count, const std::function<void()>& pulse) override {
    case_.before_item(node_, first);
    case_.hang(node_, pulse);
    return FakeTracer::work(first, count, pulse);
  }

 private:
  const ZonesCase& case_;
  NodeId node_;
};

struct ZonesRun {
  JobResult result;
  std::vector<std::string> told;
  std::vector<std::vector<Bytes>> given;  ///< by node, from 0
  std::vector<Bytes> kept;                ///< solutions
  Traffic load_data, assignments;
};

ZonesRun run_zones(const ZonesCase& c) {
  ZonesRun run;
  run.given.resize(static_cast<size_t>(c.nodes));
  const auto folder = std::filesystem::path(test::write_temporary("zones-marker", "")).parent_path();
  const auto ends = make_local_transports(c.nodes);
  std::vector<std::thread> threads;
  for (NodeId node(1); node.value() <= c.nodes; ++node)
    threads.emplace_back([&, node] {
      run_node(*ends[node.place()], node, [](const ProcessSign&) { return std::span<const std::byte>(); },
               {[&](const JobPlan&, std::span<const std::byte>) {
                  return std::make_unique<Listener>(run.given[node.place() - 1]);
                },
                [&](const JobPlan&, std::span<const std::byte>, FrameNumber) {
                  return std::make_unique<HurtTracer>(c, node);
                }});
    });
  FarmHostOptions options;
  options.plan.build = build_identity();
  options.plan.pictures = {{FrameNumber(4), FrameNumber(9)}, make_grid(0, 0, 40, 30, c.nodes), {}};
  options.plan.policy = c.policy;
  options.plan.processors = c.nodes;
  options.groups = c.groups;
  options.zones.make_solver = [&](FrameNumber frame) {
    return c.make_solver ? c.make_solver(frame) : std::make_unique<test::FakeSolver>(c.zones);
  };
  options.zones.find = c.find;
  options.zones.keep = [&](FrameNumber, std::span<const std::byte> s) {
    run.kept.emplace_back(s.begin(), s.end());
  };
  options.image = {40, 30, {0, 0, 40, 30}, make_pixel_layout(PixelFormat::rgb8), {}};
  options.progress = ProgressStyle::none;
  for (const int frame : {4, 9}) options.files.push_back((folder / fmt::format("z{}.png", frame)).string());
  for (NodeId node(1); node.value() <= c.nodes; ++node) {
    run.result.nodes.push_back({});
    run.result.nodes.back().id = node;
  }
  ends[0]->broadcast(Channel::command, encode_load_code(encode_plan(options.plan)));
  {
    FarmHost host(*ends[0], options, run.result, [&](const std::string& text) { run.told.push_back(text); });
    host.run();
  }
  ends[0]->broadcast(Channel::control, encode_control(Finish{}));
  for (std::thread& t : threads) t.join();
  run.load_data = ends[0]->meter()->total(Command::load_data);
  run.assignments = ends[0]->meter()->total(Command::load_display_polygon);
  return run;
}

// zonal.md 4: "bytes: equal for 1, 2, 3, 9 ranks, batches of 7 and 1,000 rays".
TEST(ZonePhases, SumsAreTheSameWhoeverAddsWhat) {
  FakeZones zones;
  const Bytes alone = test::solve_alone(zones);
  for (const int nodes : {1, 2, 3, 9})
    for (const auto policy : {AssignmentPolicy::on_demand, AssignmentPolicy::interleaved})
      for (const uint64_t batch : {1u, 7u, 1000u}) {
        ZonesCase c;
        c.zones = zones;
        c.zones.units_per_item = batch;
        c.nodes = nodes;
        c.policy = policy;
        const ZonesRun run = run_zones(c);
        EXPECT_EQ(run.kept, std::vector<Bytes>{alone}) << nodes << " nodes, batches of " << batch;
        EXPECT_EQ(run.result.problem, "");
        EXPECT_TRUE(run.result.frames[0].is_written && run.result.frames[1].is_written);
        // All stages' data and the solution, once for all nodes.
        EXPECT_EQ(run.result.zones.data_bytes, 5u * 800);
        EXPECT_EQ(run.load_data.bytes, 5u * (kLoadHeaderBytes + 832));
        for (const auto& given : run.given)  // a node that did no picture needs no light
          for (const Bytes& solution : given) EXPECT_EQ(solution, alone);
        EXPECT_EQ(run.result.zones.stages, 4u);
        EXPECT_EQ(run.result.zones.rounds, 4);
        EXPECT_EQ(run.result.rays.total(), 0u) << "rays of zones are not those of pictures";
        EXPECT_GT(run.result.zones.rays.total(), 1000u);
      }
}

TEST(ZonePhases, InterleavedNodesDoTheirOwnItems) {
  std::array<std::atomic<int>, 4> items{};
  ZonesCase c;
  c.policy = AssignmentPolicy::interleaved;
  c.zones.stages = 1;
  c.zones.units = 70;
  c.before_item = [&](NodeId node, uint64_t first) {
    ++items[node.place()];
    EXPECT_EQ(zone_owner(0, 3, ItemIndex(static_cast<int64_t>(first / 7))), node);
  };
  const ZonesRun run = run_zones(c);
  EXPECT_EQ(items[1], 4);  // of ten
  EXPECT_EQ(items[2], 3);
  EXPECT_EQ(items[3], 3);
  // None was handed out: all of this traffic is the pictures'.
  EXPECT_EQ(run.result.zones.assignment_bytes, 0u);
  EXPECT_EQ(run.kept, std::vector<Bytes>{test::solve_alone(c.zones)});
}

TEST(ZonePhases, GroupsOfFramesHaveASolutionEach) {
  ZonesCase c;
  c.groups = {{FrameIndex(0), 1}, {FrameIndex(1), 1}};
  c.make_solver = [&](FrameNumber frame) {
    FakeZones zones = c.zones;
    zones.units += static_cast<uint64_t>(frame.value());
    return std::make_unique<test::FakeSolver>(zones);
  };
  const ZonesRun run = run_zones(c);
  ASSERT_EQ(run.kept.size(), 2u);
  EXPECT_NE(run.kept[0], run.kept[1]);
  EXPECT_TRUE(run.result.frames[0].is_written && run.result.frames[1].is_written);
  EXPECT_EQ(run.result.zones.stages, 8u);
  for (const auto& given : run.given)
    for (const Bytes& solution : given) EXPECT_TRUE(solution == run.kept[0] || solution == run.kept[1]);
}

TEST(ZonePhases, ASolutionThatIsThereLeavesStagesOut) {
  ZonesCase c;
  const Bytes there = test::solve_alone(c.zones);
  c.find = [&](FrameNumber) { return std::optional(there); };
  const ZonesRun run = run_zones(c);
  EXPECT_TRUE(run.kept.empty());
  EXPECT_EQ(run.result.zones.stages, 0u);
  EXPECT_EQ(run.result.zones.read, 1u);
  for (const auto& given : run.given)
    for (const Bytes& solution : given) EXPECT_EQ(solution, there);
}

TEST(ZonePhases, LargeDataComeInChunks) {
  ZonesCase c;
  c.zones.slots = 200'003;  // 1.6 MB: six chunks and a part
  c.zones.units = 12;
  c.zones.stages = 2;
  const ZonesRun run = run_zones(c);
  EXPECT_EQ(run.kept, std::vector<Bytes>{test::solve_alone(c.zones)});
  EXPECT_EQ(run.load_data.messages, 3u * 7);
}

TEST(ZonePhases, AnErrorThatGoesAwayIsRetried) {
  for (const auto policy : {AssignmentPolicy::on_demand, AssignmentPolicy::interleaved}) {
    std::atomic<int> failures{2};
    ZonesCase c;
    c.policy = policy;
    c.before_item = [&](NodeId, uint64_t first) {
      if (first == 0 && failures-- > 0) throw std::runtime_error("the tracer's own error");
    };
    const ZonesRun run = run_zones(c);
    EXPECT_EQ(run.result.problem, "");
    EXPECT_EQ(run.result.zones.retried, 2u);
    ASSERT_EQ(run.told.size(), 2u);
    EXPECT_NE(run.told[0].find("units 0 to 6 of zones, round 1: the tracer's own error"), std::string::npos)
        << run.told[0];
    EXPECT_EQ(run.kept, std::vector<Bytes>{test::solve_alone(c.zones)});
  }
}

TEST(ZonePhases, ThreeErrorsEndTheJobWithTheMessage) {
  ZonesCase c;
  c.before_item = [&](NodeId, uint64_t first) {
    if (first == 7) throw std::runtime_error("the tracer's own error");
  };
  const ZonesRun run = run_zones(c);
  EXPECT_EQ(run.result.problem,
            "zones of frame 4, round 1: a part failed three times: the tracer's own error");
  EXPECT_TRUE(run.kept.empty());
  EXPECT_FALSE(run.result.frames[0].is_written);
}

TEST(ZonePhases, WhatTheSolverThrowsEndsTheJob) {
  ZonesCase c;
  c.make_solver = [](FrameNumber) -> std::unique_ptr<ZoneSolver> {
    throw std::runtime_error("too many zones");
  };
  EXPECT_EQ(run_zones(c).result.problem, "zones of frame 4: too many zones");
  c.make_solver = nullptr;
  c.zones.units = uint64_t{1} << 33;
  EXPECT_NE(run_zones(c).result.problem.find("ask for fewer rays"), std::string::npos);
}

TEST(ZonePhases, ANodeWhoseAnswersTheSolverRefusesIsExpelled) {
  class Refusing : public test::FakeSolver {
   public:
    using FakeSolver::FakeSolver;
    void add(uint64_t item, std::span<const std::byte> result) override {
      if (std::exchange(is_first_, false)) throw std::runtime_error("not such a result");
      FakeSolver::add(item, result);
    }
    bool is_first_ = true;
  };
  ZonesCase c;
  c.make_solver = [&](FrameNumber) { return std::make_unique<Refusing>(c.zones); };
  const ZonesRun run = run_zones(c);
  EXPECT_EQ(run.result.problem, "");
  EXPECT_EQ(run.result.lost_nodes().size(), 1u);
  EXPECT_EQ(run.kept, std::vector<Bytes>{test::solve_alone(c.zones)});
}

TEST(ZonePhases, ANodeThatIsStuckLeavesItsItemWhenThePhaseIsOver) {
  std::atomic<bool> is_stuck{true}, is_free{false};
  std::atomic<int> done_later{0};
  ZonesCase c;
  c.zones.stages = 2;
  c.zones.units = 300;
  c.zones.before_unit = [&](uint64_t) {
    if (is_free) std::this_thread::sleep_for(std::chrono::microseconds(200));  // that there is something left
  };
  c.hang = [&](NodeId node, const std::function<void()>& pulse) {
    if (node != NodeId(1)) return;
    struct Freed {
      std::atomic<bool>& is_free;
      ~Freed() { is_free = true; }
    } const freed{is_free};
    if (is_free) ++done_later;
    for (const bool hangs = is_stuck.exchange(false); hangs;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      pulse();
    }
  };
  const ZonesRun run = run_zones(c);
  EXPECT_EQ(run.kept, std::vector<Bytes>{test::solve_alone(c.zones)});
  EXPECT_GT(done_later, 0);
  EXPECT_TRUE(run.result.lost_nodes().empty());
}

TEST(ZonesHost, TakesEachResultOfThePhaseAtWorkOnce) {
  const auto ends = make_local_transports(2);
  JobPlan plan;
  plan.processors = 2;
  JobResult result;
  result.nodes.resize(2);
  AssignmentOptions options;
  options.nodes = 2;
  options.steps = 0;
  Assignment assignment(options, 0);
  ZonesHost host(*ends[0], plan, result, assignment);
  const FakeZones zones;
  test::FakeSolver solver(zones);
  const ZoneStage stage = *solver.next_stage();
  test::FakeTracer tracer(zones);
  tracer.begin(stage.data);
  const auto answer = [&](uint32_t phase, int64_t item, std::span<const std::byte> bytes,
                          bool is_compressed = false) {
    host.receive(NodeId(1), encode_zone_result(0, {phase, ItemIndex(item), {1}, 5, {}, is_compressed, bytes}),
                 0.1);
  };
  const Bytes sums = tracer.work(0, 7, [] {}).bytes;
  answer(3, 0, sums);
  EXPECT_EQ(result.duplicates, 1u) << "no phase is at work";
  host.begin(stage, FrameNumber(1), 3, solver);
  assignment.begin(host.work(), 0);
  answer(2, 0, sums);
  EXPECT_EQ(result.duplicates, 2u) << "of the phase before";
  EXPECT_EQ(result.zones.results, 0u);
  EXPECT_THROW(answer(3, 72, sums), ProtocolError);
  EXPECT_THROW(answer(3, -1, sums), ProtocolError);
  EXPECT_THROW(answer(3, 0, Bytes(7)), ProtocolError);
  EXPECT_THROW(answer(3, 0, sums, true), ProtocolError) << "it is not compressed";
  EXPECT_TRUE(assignment.needs(NodeId(1), ItemIndex(0)));
  answer(3, 0, *compress_bytes(sums), true);
  answer(3, 0, sums);
  EXPECT_EQ(result.zones.results, 1u);
  EXPECT_EQ(result.duplicates, 3u);
  EXPECT_EQ(result.zones.rays.total(), 1u);
}

TEST(DataFeed, ANodeThatTakesNothingGetsLittle) {
  const auto ends = make_local_transports(2);
  Bytes data(20 * kChunkBytes + 100);
  for (size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::byte>(i * 7 + i / 1000);
  DataFeed feed(*ends[0], kStageAddress, data);
  DataIntake intake;
  intake.expect(kStageAddress, data.size());
  EXPECT_FALSE(intake.is_whole());
  while (!intake.is_whole()) {  // node 1 takes what comes, node 2 nothing
    ASSERT_TRUE(feed.turn());
    while (const auto message = ends[1]->try_receive()) intake.take(decode_load_data(message->bytes));
    EXPECT_LE(ends[0]->unsent_bytes(NodeId(2)), DataFeed::kMostUnsentBytes);
  }
  EXPECT_FALSE(feed.turn());
  EXPECT_TRUE(std::equal(data.begin(), data.end(), intake.bytes().begin(), intake.bytes().end()));
  EXPECT_EQ(ends[0]->meter()->total(Command::load_data).messages, 21u) << "a broadcast counts once";
  // It wakes up.
  intake.expect(kStageAddress, data.size());
  do
    while (const auto message = ends[2]->try_receive()) intake.take(decode_load_data(message->bytes));
  while (feed.turn());
  EXPECT_TRUE(intake.is_whole());
  EXPECT_EQ(ends[0]->meter()->total(Command::load_data).messages, 21u);
}

TEST(DataFeed, WhatWasNotExpectedIsRefused) {
  DataIntake intake;
  EXPECT_TRUE(intake.is_whole());
  const Bytes words(128);
  EXPECT_THROW(intake.take({kStageAddress, words}), ProtocolError);
  intake.expect(kStageAddress, 100);
  EXPECT_THROW(intake.take({kStageAddress + 64, words}), ProtocolError);
  EXPECT_THROW(intake.take({kSolutionAddress, words}), ProtocolError);
  EXPECT_THROW(intake.take({kStageAddress, Bytes(192)}), ProtocolError);
  intake.take({kStageAddress, words});
  EXPECT_TRUE(intake.is_whole());
  EXPECT_THROW(intake.take({kStageAddress + 128, words}), ProtocolError);
}

}  // namespace
}  // namespace rayfarm
