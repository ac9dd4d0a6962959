// The model of the net against the thesis's printed figures, and the simulator against what can be worked
// out.
#include <gtest/gtest.h>

#include <cmath>

#include "host/instrument/cost_map.h"
#include "host/instrument/model.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(NetModel, GivesTheThesissFigures) {
  const NetModel model = thesis_model();
  const WireModel& wire = model.wires.front();
  EXPECT_EQ(std::floor(saturating_processors(model, wire)), 4444);
  const NetTimes t = evaluate(model, wire, 4444);
  EXPECT_EQ(fmt::format("{:.3f}", t.code_s), "0.194");  // 194,424 bytes
  EXPECT_EQ(fmt::format("{:.3f}", t.data_s), "0.247");  // 247K
  EXPECT_EQ(fmt::format("{:.2f}", t.first_frame_s), "9.92");
  EXPECT_EQ(fmt::format("{:.1f}", t.next_frame_s), "9.4");
  EXPECT_EQ(std::floor(t.first_speedup), 4228);
  EXPECT_EQ(std::floor(t.next_speedup), 4444);
  EXPECT_NEAR(t.results_s / 4444, 0.000009, 1e-12);
}

// zonal.md, 4: "Model, beside Equation 4.6: T = rounds · (24 n/W + rays · T_R/N + results/W)". By hand, of
// the thesis's 8 Mbit/s: 24 × 5,000 bytes take 0.12 s, 10^5 rays of 1 ms on 50 processors 2 s, 10^6 bytes 1
// s.
TEST(NetModel, ZonesTakeRoundsOfDataRaysAndResults) {
  NetModel model = thesis_model();
  model.zones = {5'000, 6, 1e5, 1e-3, 1e6};
  const ZonesTimes t = evaluate_zones(model, 50);
  EXPECT_NEAR(t.data_s, 6 * 0.12, 1e-12);
  EXPECT_NEAR(t.trace_s, 6 * 2.0, 1e-12);
  EXPECT_NEAR(t.results_s, 6 * 1.0, 1e-12);
  EXPECT_NEAR(t.total_s(), 6 * 3.12, 1e-12);
}

TEST(NetModel, KnowsItsLimits) {
  NetModel model = thesis_model();
  const WireModel& wire = model.wires.front();
  // Beyond the net's limit more processors only have more to send.
  EXPECT_EQ(best_processors(model, wire), 4445);
  EXPECT_NEAR(evaluate(model, wire, 8000).next_frame_s, 1024 * 1024 * 9e-6, 1e-9);
  // A third of the bytes, three times the processors; a tenth of the rate, a tenth.
  EXPECT_NEAR(saturating_processors(model, {"block", 3, 0}), 3 * saturating_processors(model, wire), 1e-6);
  model.rate_bit_per_s /= 10;
  EXPECT_EQ(std::floor(saturating_processors(model, wire)), 444);
  EXPECT_TRUE(std::isinf(frame_buffer_processors(model)));
  model.frame_buffer_s = 0.0001;
  EXPECT_NEAR(frame_buffer_processors(model), 400, 1e-9);
  EXPECT_NEAR(evaluate(model, wire, 2000).next_frame_s, 1024 * 1024 * 0.0001, 1e-9);
  model.copies_per_processor = 1;
  EXPECT_NEAR(evaluate(model, wire, 10).code_s, 10 * 194'424 * 8 / 8e5, 1e-9);
}

/// A small net whose numbers are round.
Simulation small_net(int processors) {
  Simulation s;
  s.processors = processors;
  s.cost.width_px = s.cost.height_px = 64;
  s.cost.pixel_s = {0.01};
  s.cost.pixel_bytes = {0.5};
  s.rate_bit_per_s = 9 * 8 * 1000;  // a pixel takes 1 ms
  return s;
}
constexpr double kPixels = 64 * 64;

TEST(Simulator, OneProcessorTracesAndSendsInTurn) {
  Simulation s = small_net(1);
  s.load_bytes = 900;
  SimulationResult r = simulate(s);
  EXPECT_NEAR(r.total_s, 0.1 + kPixels * 0.011, 1e-6);
  EXPECT_NEAR(r.busy_s, kPixels * 0.01, 1e-6);
  EXPECT_NEAR(r.waited_s, kPixels * 0.001, 1e-6);
  EXPECT_EQ(r.messages, 4096u);
  EXPECT_NEAR(r.bytes, 9 * kPixels, 1e-6);
  // With a message in hand it traces while it sends.
  s.messages_held = 2;
  r = simulate(s);
  EXPECT_NEAR(r.total_s, 0.1 + kPixels * 0.01 + 0.001, 1e-6);
}

TEST(Simulator, TheNetSaturatesWhereTheModelSaysSo) {
  // 10 ms of tracing, 1 ms of sending: 10 processors fill the net.
  for (const int n : {2, 5, 8}) {
    Simulation s = small_net(n);
    s.messages_held = 2;
    EXPECT_NEAR(simulate(s).total_s, kPixels * 0.01 / n, 0.02 * kPixels * 0.01 / n) << n;
  }
  for (const int n : {12, 20, 64}) {
    Simulation s = small_net(n);
    s.messages_held = 2;
    const SimulationResult r = simulate(s);
    EXPECT_NEAR(r.total_s, kPixels * 0.001, 0.05 * kPixels * 0.001) << n;
    EXPECT_GT(r.net_use, 0.95);
    // Two nets carry twice as much, a switch as much as its host's port; compressed blocks 18 times.
    s.nets = 2;
    EXPECT_LT(simulate(s).total_s, 0.6 * r.total_s + kPixels * 0.01 / n) << n;
    s.nets = 1;
    s.net = NetShape::ports;
    EXPECT_NEAR(simulate(s).total_s, r.total_s, 0.05 * r.total_s) << n;
    s.form = ResultForm::compressed;
    s.subpolygons_per_processor = 2;
    EXPECT_LT(simulate(s).bytes, r.bytes / 6) << n;
  }
}

TEST(Simulator, FrameBuffersLimitWhatTheyCanStore) {
  Simulation s = small_net(8);
  s.frame_buffer_s = 0.002;
  EXPECT_NEAR(simulate(s).total_s, kPixels * 0.002, 0.05);
  s.frame_buffers = 4;
  EXPECT_LT(simulate(s).total_s, kPixels * 0.0016);
}

TEST(Simulator, RotationEvensOutAHardCorner) {
  // One subpolygon for each of 16 processors, and a corner that takes 20 times as long.
  Simulation s = small_net(16);
  s.rate_bit_per_s = 1e12;
  s.subpolygons_per_processor = 1;
  s.cost.columns = s.cost.rows = 4;
  s.cost.pixel_s.assign(16, 0.001);
  s.cost.pixel_s[0] = 0.02;
  s.cost.pixel_bytes.assign(16, 1);
  s.frames = 16;
  s.frames_open = 16;
  s.rotates = false;
  const SimulationResult still = simulate(s);
  EXPECT_NEAR(still.total_s, 16 * 256 * 0.02, 0.1);
  s.rotates = true;
  const SimulationResult rotated = simulate(s);
  EXPECT_NEAR(rotated.total_s, 256 * (0.02 + 15 * 0.001), 0.1);
  EXPECT_GT(rotated.efficiency, 0.99);
  EXPECT_LT(still.efficiency, 0.15);
  // 64 subpolygons each do so within one frame.
  s.rotates = false;
  s.subpolygons_per_processor = 64;
  EXPECT_GT(simulate(s).efficiency, 0.95);
}

TEST(Simulator, ALatticeSharesAHardColumnThatRowsGiveToOne) {
  // 8 × 8 subpolygons for 8 processors: one in every 8 makes a column.
  Simulation s = small_net(8);
  s.rate_bit_per_s = 1e12;
  s.subpolygons_per_processor = 8;
  s.cost.columns = 8;
  s.cost.pixel_s.assign(8, 0.001);
  s.cost.pixel_s[4] = 0.02;
  s.cost.pixel_bytes.assign(8, 1);
  s.sets = SetPattern::rows;
  const SimulationResult rows = simulate(s);
  s.sets = SetPattern::lattice;
  const SimulationResult lattice = simulate(s);
  EXPECT_NEAR(rows.busy_s, lattice.busy_s, 1e-9);
  EXPECT_NEAR(rows.total_s, 512 * 0.02, 1e-6);
  EXPECT_NEAR(lattice.total_s, 64 * (0.02 + 7 * 0.001), 1e-6);
}

TEST(Simulator, OnDemandGivesASlowProcessorLess) {
  Simulation s = small_net(8);
  s.rate_bit_per_s = 1e9;
  s.form = ResultForm::blocks;
  s.time_factors = {1, 1, 1, 1, 1, 1, 1, 2};
  s.policy = AssignmentPolicy::on_demand;
  EXPECT_GT(simulate(s).efficiency, 0.95);
  s.policy = AssignmentPolicy::interleaved;
  EXPECT_LT(simulate(s).efficiency, 0.6);  // all wait for the slow one
}

TEST(Simulator, RefusesWhatMakesNoSense) {
  Simulation s = small_net(0);
  EXPECT_THROW(simulate(s), std::invalid_argument);
  s = small_net(2);
  s.cost.columns = 3;
  EXPECT_THROW(simulate(s), std::invalid_argument);
  s = small_net(2);
  s.time_factors = {0};
  EXPECT_THROW(simulate(s), std::invalid_argument);
}

TEST(CostMap, ThereAndBack) {
  JobResult result;
  FrameResult frame;
  frame.is_written = true;
  frame.costs = {{0.5, 100}, {0.25, 300}};
  result.frames = {frame, frame};
  const SubpolygonGrid grid{0, 0, 20, 10, 2, 1};
  const std::string path = test::write_temporary("map.json", "");
  write_cost_map(path, result, grid);
  const CostMap map = read_cost_map(path);
  EXPECT_EQ(map.columns, 2);
  EXPECT_EQ(map.frames, 2);
  EXPECT_EQ(map.pixel_s, (std::vector<double>{0.005, 0.0025, 0.005, 0.0025}));
  EXPECT_EQ(map.pixel_bytes, (std::vector<double>{1, 3, 1, 3}));
  for (const char* text :
       {"", "[]", "{\"width\": 3}", "{\"width\":4,\"height\":4,\"columns\":2,\"rows\":1,\"frames\":[]}",
        "{\"width\":4,\"height\":4,\"columns\":2,\"rows\":1,\"frames\":[{\"pixel_s\":[1],"
        "\"pixel_bytes\":[1,2]}]}"})
    EXPECT_THROW(read_cost_map(test::write_temporary("bad.json", text)), InputError) << text;
  EXPECT_THROW(read_cost_map("/nonexistent/map.json"), IoError);
}

}  // namespace
}  // namespace rayfarm
