#include <random>
#include <thread>

#include "protocol/block_codec.h"
#include "protocol/build_identity.h"
#include "protocol/byte_codec.h"
#include "protocol/job_plan.h"
#include "protocol/local_transport.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(CommandWord, TwoBitsOfCodeFourteenOfProcessor) {
  EXPECT_EQ(encode_word({Command::load_code, 0}), 0x0000);
  EXPECT_EQ(encode_word({Command::load_data, 1}), 0x4001);
  EXPECT_EQ(encode_word({Command::load_display_polygon, 0x1234}), 0x9234);
  EXPECT_EQ(encode_word({Command::return_result, kAllProcessors}), 0xffff);
  for (unsigned bits = 0; bits < 65536; bits += 37)
    EXPECT_EQ(encode_word(decode_word(static_cast<uint16_t>(bits))), bits);
  EXPECT_THROW(encode_word({Command::load_code, 16384}), ProtocolError);
}

TEST(LocalTransport, AMessageEndsTheWaitForIt) {
  const auto ends = make_local_transports(1);
  std::jthread host([&] { ends[0]->send(NodeId(1), AskPresent{}); });
  while (!ends[1]->try_receive()) ends[1]->wait_for_message(600);  // the test's limit is 120 s
  ends[1]->wait_for_message(0.001);                                // nothing comes: the time passes
  EXPECT_FALSE(ends[1]->try_receive());
}

TEST(Messages, SizesAreTheThesiss) {
  EXPECT_EQ(encode_display_polygon(3, {0, 0, 65535, 65535}).size(), 10u);
  ByteWriter writer;
  append_pixel(5, {65535, 1, {1, 2, 3}}, writer);
  EXPECT_EQ(writer.size(), 9u);
  EXPECT_EQ(encode_load_code(Bytes(8)).size(), 2u + 4 + 4 + 8);
}

TEST(Messages, ThereAndBack) {
  const DisplayPolygon polygon{1, 2, 300, 65535};
  EXPECT_EQ(decode_display_polygon(encode_display_polygon(7, polygon)), polygon);
  const SubpolygonReport report{
      FrameNumber(12), SubpolygonId(34), {1, 200, 30000, 4000000, 1ull << 60}, 123456};
  const Bytes pixels{std::byte{1}, std::byte{2}, std::byte{3}};
  const Bytes bytes = encode_block(9, {report, true, pixels});
  const BlockResult back = decode_block(bytes);
  EXPECT_EQ(back.report.frame, report.frame);
  EXPECT_EQ(back.report.subpolygon, report.subpolygon);
  EXPECT_EQ(back.report.rays, report.rays);
  EXPECT_EQ(back.report.busy_us, 123456u);
  EXPECT_TRUE(back.is_compressed);
  EXPECT_EQ(Bytes(back.pixels.begin(), back.pixels.end()), pixels);
  EXPECT_TRUE(back.running.empty());
  const Bytes running(48, std::byte{5});
  const Bytes of_pass = encode_block(9, {report, false, pixels, 2, running});
  const BlockResult pass_back = decode_block(of_pass);
  EXPECT_EQ(pass_back.pass, 2);
  EXPECT_EQ(Bytes(pass_back.pixels.begin(), pass_back.pixels.end()), pixels);
  EXPECT_EQ(Bytes(pass_back.running.begin(), pass_back.running.end()), running);
  EXPECT_THROW(decode_block(std::span(of_pass).first(of_pass.size() - running.size() - 1)), ProtocolError);
  EXPECT_EQ(std::get<GoOnFrom>(decode_control(encode_control(GoOnFrom{running}))).running, running);
  const Control hello = decode_control(encode_control(Hello{"machine", 42, "build"}));
  EXPECT_EQ(std::get<Hello>(hello).machine, "machine");
  EXPECT_EQ(std::get<Hello>(hello).pid, 42u);
  const Control failed = decode_control(encode_control(ItemFailed{2, ItemIndex(1ll << 40), "why"}));
  EXPECT_EQ(std::get<ItemFailed>(failed).item, ItemIndex(1ll << 40));
  EXPECT_EQ(std::get<ItemFailed>(failed).problem, "why");
  Bytes data;
  const Bytes payload(128, std::byte{7});
  encode_load_data({640, payload}, data);
  EXPECT_EQ(decode_load_data(data).address, 640u);
  EXPECT_EQ(decode_load_data(data).payload.size(), 128u);
  EXPECT_THROW(encode_load_data({1, payload}, data), ProtocolError);
  JobPlan plan;
  plan.build = "b";
  plan.pictures = {{FrameNumber(3), FrameNumber(1), FrameNumber(2)}, make_grid(0, 0, 640, 480, 3), {}};
  plan.wire = Wire::pixel;
  plan.processors = 3;
  plan.rotates = false;
  plan.sets = SetPattern::rows;
  plan.ray_time_s = 0.00025;
  plan.time_factors = {1, 0.5, 2};
  plan.beat_s = 2.5;
  plan.settings = payload;
  const JobPlan plan_back = decode_plan(decode_load_code(encode_load_code(encode_plan(plan))));
  EXPECT_EQ(plan_back.pictures.frames, plan.pictures.frames);
  EXPECT_FALSE(plan_back.rotates);
  EXPECT_EQ(plan_back.sets, SetPattern::rows);
  EXPECT_NEAR(plan_back.ray_time_s, 0.00025, 1e-12);
  EXPECT_EQ(plan_back.beat_s, 2.5);
  JobPlan without_beats = plan;
  without_beats.beat_s = 0;
  EXPECT_THROW(decode_plan(encode_plan(without_beats)), ProtocolError);
  EXPECT_EQ(plan_back.time_factors, plan.time_factors);
  EXPECT_EQ(plan_back.wire, Wire::pixel);
  EXPECT_EQ(plan_back.pictures.passes, 1);
  plan.pictures.passes = 4;
  EXPECT_THROW(decode_plan(encode_plan(plan)), ProtocolError) << "pixels alone tell nothing to go on from";
  plan.wire = Wire::block;
  EXPECT_EQ(decode_plan(encode_plan(plan)).pictures.passes, 4);
  EXPECT_EQ(beginning_of(plan.pictures, 0, 0).units, 3u) << "of frames, not of their passes";
  EXPECT_EQ(plan_back.pictures.grid.columns, plan.pictures.grid.columns);
  EXPECT_EQ(plan_back.settings, payload);
}

TEST(Messages, OfZonesThereAndBack) {
  const UnitRange range{70'000, 4'294'967'295};
  const Bytes assignment = encode_unit_range(7, range);
  EXPECT_EQ(assignment.size(), kDisplayPolygonBytes) << "the corners' places";
  EXPECT_EQ(command_of(assignment), Command::load_display_polygon);
  EXPECT_EQ(decode_unit_range(assignment), range);
  EXPECT_THROW(decode_unit_range(encode_unit_range(7, {2, 1})), ProtocolError);
  const BeginPhase begin{3, PhaseKind::zones, 12, 1ull << 32, 4096, 1ull << 34};
  EXPECT_EQ(std::get<BeginPhase>(decode_control(encode_control(begin))), begin);
  for (BeginPhase bad : {BeginPhase{0, PhaseKind::zones, 0, 0, 1, 0},
                         BeginPhase{0, PhaseKind::zones, 0, 1, 0, 0}, BeginPhase{0, PhaseKind{2}, 0, 1, 1, 0},
                         BeginPhase{0, PhaseKind::zones, 0, 1, 1, kMostPhaseDataBytes + 1}})
    EXPECT_THROW(decode_control(encode_control(bad)), ProtocolError);
  const Bytes sums(40, std::byte{5});
  const Bytes message =
      encode_zone_result(2, {9, ItemIndex(1ll << 33), {1, 2, 3, 4, 1ull << 50}, 77, {6}, true, sums});
  EXPECT_TRUE(is_zone_result(message));
  const ZoneResult back = decode_zone_result(message);
  EXPECT_EQ(back.phase, 9u);
  EXPECT_EQ(back.item, ItemIndex(1ll << 33));
  EXPECT_EQ(back.rays[4], 1ull << 50);
  EXPECT_EQ(back.busy_us, 77u);
  EXPECT_EQ(back.ray_tallies[0], 6u);
  EXPECT_TRUE(back.is_compressed);
  EXPECT_EQ(Bytes(back.bytes.begin(), back.bytes.end()), sums);
  EXPECT_THROW(decode_block(message), ProtocolError);
  const Bytes block = encode_block(2, {});
  EXPECT_FALSE(is_zone_result(block));
  EXPECT_THROW(decode_zone_result(block), ProtocolError);
  Bytes out;
  const Bytes words(128);
  for (const uint64_t border : {kStageAddress, kSolutionAddress, kEndOfAddresses}) {
    encode_load_data({border - 128, words}, out);
    EXPECT_EQ(decode_load_data(out).address, border - 128);
    EXPECT_THROW(encode_load_data({border - 64, words}, out), ProtocolError) << "on both sides";
  }
}

TEST(Phases, AreToldInFullAndChecked) {
  JobPlan plan;
  plan.pictures = {{FrameNumber(3), FrameNumber(1), FrameNumber(2)}, make_grid(0, 0, 64, 48, 3), {}};
  const auto pictures = std::get<PicturesPhase>(phase_of(plan, {0, PhaseKind::pictures, 1, 2, 1, 0}));
  EXPECT_EQ(pictures.frames, (std::vector{FrameNumber(1), FrameNumber(2)}));
  EXPECT_EQ(pictures.first, FrameIndex(1));
  EXPECT_EQ(beginning_of(pictures, 7, 64), (BeginPhase{7, PhaseKind::pictures, 1, 2, 1, 64}));
  for (const BeginPhase& bad :
       {BeginPhase{0, PhaseKind::pictures, 1, 3, 1, 0}, BeginPhase{0, PhaseKind::pictures, -1, 1, 1, 0},
        BeginPhase{0, PhaseKind::zones, 1, (1ull << 32) + 1, 1, 0}})
    EXPECT_THROW(phase_of(plan, bad), ProtocolError);
  // Sets go on moving from one group of frames to the next.
  plan.processors = 3;
  for (SubpolygonId s; s.value() < pictures.grid.count(); ++s)
    EXPECT_EQ(owner_of(plan, pictures, pictures.item_of(FrameIndex(0), s)),
              owner_of(plan, plan.pictures, plan.pictures.item_of(FrameIndex(1), s)));
  const auto zones = std::get<ZonePhase>(phase_of(plan, {1, PhaseKind::zones, 3, 1ull << 32, 1000, 0}));
  EXPECT_EQ(zones.items(), 4'294'968);
  EXPECT_EQ(zones.units_of(ItemIndex(0)), (UnitRange{0, 999}));
  EXPECT_EQ(zones.units_of(ItemIndex(4'294'967)), (UnitRange{4'294'967'000, 4'294'967'295}));
  for (const ItemIndex item : {ItemIndex(0), ItemIndex(5), ItemIndex(4'294'967)})
    EXPECT_EQ(zones.find(zones.units_of(item)), item);
  EXPECT_EQ(zones.find({0, 998}), std::nullopt);
  EXPECT_EQ(zones.find({1, 1000}), std::nullopt);
  EXPECT_EQ(std::get<ZonePhase>(phase_of(plan, {1, PhaseKind::zones, 3, 5, ~0ull, 0})).items(), 1);
}

TEST(ByteCodec, LosslessAndBounded) {
  const Bytes zeros(100'000);
  const Bytes small = compress_bytes(zeros).value();
  EXPECT_LT(small.size(), 100u);
  EXPECT_EQ(decompress_bytes(small, zeros.size()), zeros);
  EXPECT_THROW(decompress_bytes(small, zeros.size() - 1), ProtocolError);
  EXPECT_THROW(decompress_bytes(std::span(small).first(small.size() - 1), zeros.size()), ProtocolError);
  Bytes noise(1000);
  std::mt19937 random(3);
  for (std::byte& b : noise) b = static_cast<std::byte>(random());
  EXPECT_FALSE(compress_bytes(noise));
  EXPECT_FALSE(compress_bytes({}));
}

TEST(Messages, RandomBytesAreRefusedNeverReadBeyond) {
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes(random() % 40);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    const auto attempt = [](auto decode) {
      try {
        decode();
      } catch (const ProtocolError&) {
      }
    };
    attempt([&] { decode_control(bytes); });
    attempt([&] { decode_block(bytes); });
    attempt([&] { decode_display_polygon(bytes); });
    attempt([&] { decode_load_code(bytes); });
    attempt([&] { decode_load_data(bytes); });
    attempt([&] { decode_plan(bytes); });
    attempt([&] { decompress_rgb8(bytes, 4, 3); });
    attempt([&] { decode_unit_range(bytes); });
    attempt([&] { decode_zone_result(bytes); });
    attempt([&] { decompress_bytes(bytes, 1 << 20); });
  }
}

TEST(Grid, TapersWhereSubpolygonsAreSmall) {
  for (const auto& [width, height, processors] : {std::tuple{512, 512, 32}, std::tuple{512, 512, 64},
                                                  std::tuple{640, 200, 20}, std::tuple{1920, 1080, 200}}) {
    const SubpolygonGrid even = make_grid(10, 20, width, height, processors);
    const SubpolygonGrid grid =
        make_tapering_grid(10, 20, width, height, processors, kLeastBlockSide_px, kMostSubpolygonBytes);
    EXPECT_LT(grid.count(), even.count() * 72 / 100);
    EXPECT_GT(grid.count(), even.count() * 55 / 100);
    std::vector<int> covered(static_cast<size_t>(width * height));
    int last_top = 0, last_left = 0, large = 0;
    for (SubpolygonId s; s.value() < grid.count(); ++s) {
      const DisplayPolygon p = grid.polygon(s);
      ASSERT_EQ(grid.find(p), s);
      // Row by row from the top, and a row has one top and bottom.
      ASSERT_TRUE(p.top > last_top || (p.top == last_top && p.left > last_left));
      if (p.top == last_top) {
        ASSERT_EQ(p.bottom, grid.polygon(SubpolygonId(s.value() - 1)).bottom);
      }
      last_top = p.top;
      last_left = p.left;
      EXPECT_GE(p.right - p.left + 1, kLeastBlockSide_px);
      EXPECT_GE(p.bottom - p.top + 1, kLeastBlockSide_px);
      large += (p.right - p.left + 1) * (p.bottom - p.top + 1) > 3 * width * height / even.count();
      for (int y = p.top; y <= p.bottom; ++y)
        for (int x = p.left; x <= p.right; ++x) ++covered.at(static_cast<size_t>((y - 20) * width + x - 10));
    }
    EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), width * height);
    EXPECT_GT(large, grid.large_count() * 9 / 10);
  }
  // Large enough, or too few of all, or for each.
  for (const auto& [side, processors] : {std::pair{4096, 32}, std::pair{48, 1}, std::pair{512, 1000}})
    EXPECT_EQ(make_tapering_grid(0, 0, side, side, processors, kLeastBlockSide_px, kMostSubpolygonBytes),
              make_grid(0, 0, side, side, processors));
}

TEST(JobPlan, OfATaperingGridComesBackAndIsNotOfSets) {
  JobPlan plan;
  plan.pictures = {
      {FrameNumber(1)}, make_tapering_grid(0, 0, 512, 512, 32, kLeastBlockSide_px, kMostSubpolygonBytes), {}};
  ASSERT_GT(plan.pictures.grid.small_height, 0);
  EXPECT_EQ(decode_plan(encode_plan(plan)).pictures.grid, plan.pictures.grid);
  plan.policy = AssignmentPolicy::interleaved;
  EXPECT_THROW(decode_plan(encode_plan(plan)), ProtocolError);
  plan.policy = AssignmentPolicy::on_demand;
  plan.pictures.grid.small_rows = 0;
  EXPECT_THROW(decode_plan(encode_plan(plan)), ProtocolError);
}

TEST(Grid, CoversEveryPixelOnce) {
  for (const auto& [width, height, processors] :
       {std::tuple{640, 480, 3}, std::tuple{7, 5, 8}, std::tuple{513, 9, 2}, std::tuple{1024, 1024, 32},
        std::tuple{8, 8, 1}}) {
    const SubpolygonGrid grid = make_grid(10, 20, width, height, processors);
    std::vector<int> covered(static_cast<size_t>(width * height));
    for (SubpolygonId s; s.value() < grid.count(); ++s) {
      const DisplayPolygon p = grid.polygon(s);
      EXPECT_EQ(grid.find(p), s);
      for (int y = p.top; y <= p.bottom; ++y)
        for (int x = p.left; x <= p.right; ++x) ++covered[static_cast<size_t>((y - 20) * width + x - 10)];
      if (width >= 8 && height >= 8) {
        EXPECT_GE(std::min(p.right - p.left, p.bottom - p.top), 7);
      }
    }
    EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), width * height);
    EXPECT_EQ(grid.find({11, 20, 12, 21}), std::nullopt);
  }
  const SubpolygonGrid large = make_grid(0, 0, 4096, 4096, 16);
  EXPECT_NEAR(large.count(), 64 * 16, 64 * 2);
  const SubpolygonGrid largest = make_grid(0, 0, 65536, 65536, 1);
  EXPECT_EQ(largest.polygon(SubpolygonId(largest.count() - 1)).right, 65535);
}

// Thesis 4.4.4.1: "as few as one ray could be assigned to each processor".
TEST(Grid, SubpolygonsAreAsSmallAsAPixel_4_4_4_1) {
  const SubpolygonGrid pixels = make_grid(3, 4, 40, 30, 100, 64, 1);
  EXPECT_EQ(pixels.count(), 1200);
  for (SubpolygonId s; s.value() < pixels.count(); ++s) {
    const DisplayPolygon p = pixels.polygon(s);
    EXPECT_EQ(p, (DisplayPolygon{static_cast<uint16_t>(3 + s.value() % 40),
                                 static_cast<uint16_t>(4 + s.value() / 40), p.left, p.top}));
    EXPECT_EQ(pixels.find(p), s);
  }
  // The thesis's picture: about 64 for each of 4,444 processors, of which blocks of 8 × 8 leave few.
  EXPECT_NEAR(make_grid(0, 0, 1024, 1024, 4444, 64, 1).count(), 284416, 28441);
  EXPECT_EQ(make_grid(0, 0, 1024, 1024, 4444).count(), 16384);
  EXPECT_EQ(room_for(1024, 1024, 8), 16384);
  EXPECT_EQ(room_for(7, 1024, 8), 128);
  EXPECT_EQ(least_side_of(Wire::pixel), 1);
  EXPECT_EQ(least_side_of(Wire::block), 8);
  JobPlan plan;  // the grid travels in the plan
  plan.pictures = {{FrameNumber(1)}, pixels, {}};
  EXPECT_EQ(decode_plan(encode_plan(plan)).pictures.grid.count(), 1200);
}

TEST(Grid, NoSubpolygonWeighsMoreThanAMessageMay) {
  for (const auto& [width, height, per_processor] :
       {std::tuple{65536, 65536, 64}, std::tuple{16384, 16384, 2}, std::tuple{65536, 1, 1},
        std::tuple{9, 65536, 1}}) {
    for (const size_t pixel_bytes : {3, 12}) {
      const size_t most = kMostSubpolygonBytes / pixel_bytes;
      const SubpolygonGrid grid = make_grid(0, 0, width, height, 1, per_processor, kLeastBlockSide_px, most);
      for (int s = 0; s < grid.count(); s += 7) {
        const DisplayPolygon p = grid.polygon(SubpolygonId(s));
        EXPECT_LE(size_t(p.right - p.left + 1) * size_t(p.bottom - p.top + 1), most);
      }
    }
  }
  EXPECT_EQ(make_grid(0, 0, 640, 480, 2).count(), make_grid(0, 0, 640, 480, 2, 64, 8, 1 << 20).count());
}

TEST(LocalTransport, OrderAndMeter) {
  const auto ends = make_local_transports(2);
  ends[0]->send(NodeId(1), SelectStep{StepIndex(5)});
  ends[0]->send(NodeId(1), Channel::command, encode_display_polygon(0, {0, 0, 7, 7}));
  ends[0]->load_code(encode_load_code(Bytes(4)), {});
  EXPECT_EQ(std::get<SelectStep>(decode_control(ends[1]->try_receive()->bytes)).step, StepIndex(5));
  EXPECT_EQ(command_of(ends[1]->try_receive()->bytes), Command::load_display_polygon);
  EXPECT_EQ(command_of(ends[2]->try_receive()->bytes), Command::load_code);
  EXPECT_FALSE(ends[2]->try_receive());
  ByteWriter pixels;
  for (uint16_t x = 0; x < 10; ++x) append_pixel(1, {x, 0, {}}, pixels);
  ends[2]->send(kHost, Channel::pixels, pixels.take());
  EXPECT_EQ(ends[0]->try_receive()->source, NodeId(2));
  const TrafficMeter& meter = *ends[0]->meter();
  EXPECT_EQ(meter.total(Command::load_code).messages, 1u) << "a broadcast is one message on the net";
  EXPECT_EQ(meter.total(Command::load_display_polygon).bytes, 10u);
  EXPECT_EQ(meter.total(Command::return_result).messages, 10u);
  EXPECT_EQ(meter.total(Command::return_result).bytes, 90u);
  EXPECT_EQ(meter.of_node(NodeId(2), Direction::to_host).bytes, 90u);
}

TEST(BuildIdentity, IsThere) {
  EXPECT_EQ(build_identity().size(), 40u);
}

}  // namespace
}  // namespace rayfarm
