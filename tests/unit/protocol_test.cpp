#include <random>
#include <set>

#include "protocol/block_codec.h"
#include "protocol/build_identity.h"
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
  const Control hello = decode_control(encode_control(Hello{"machine", 42, "build"}));
  EXPECT_EQ(std::get<Hello>(hello).machine, "machine");
  EXPECT_EQ(std::get<Hello>(hello).pid, 42u);
  const Control failed = decode_control(encode_control(ItemFailed{ItemIndex(1ll << 40), "why"}));
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
  plan.phases = {
      PicturesPhase{{FrameNumber(3), FrameNumber(1), FrameNumber(2)}, make_grid(0, 0, 640, 480, 3)}};
  plan.wire = Wire::pixel;
  plan.processors = 3;
  plan.rotates = false;
  plan.sets = SetPattern::rows;
  plan.ray_time_s = 0.00025;
  plan.time_factors = {1, 0.5, 2};
  plan.settings = payload;
  const JobPlan plan_back = decode_plan(decode_load_code(encode_load_code(encode_plan(plan))));
  EXPECT_EQ(pictures_of(plan_back).frames, pictures_of(plan).frames);
  EXPECT_FALSE(plan_back.rotates);
  EXPECT_EQ(plan_back.sets, SetPattern::rows);
  EXPECT_NEAR(plan_back.ray_time_s, 0.00025, 1e-12);
  EXPECT_EQ(plan_back.time_factors, plan.time_factors);
  EXPECT_EQ(plan_back.wire, Wire::pixel);
  EXPECT_EQ(pictures_of(plan_back).grid.columns, pictures_of(plan).grid.columns);
  EXPECT_EQ(plan_back.settings, payload);
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
  }
}

TEST(BlockCodec, LosslessForAnyContentAndSize) {
  std::mt19937 random(2);
  for (const auto& [width, height] :
       {std::pair{1, 1}, std::pair{1, 17}, std::pair{64, 64}, std::pair{91, 90}}) {
    Bytes noise(static_cast<size_t>(3 * width * height)), smooth(noise.size());
    for (size_t i = 0; i < noise.size(); ++i) {
      noise[i] = static_cast<std::byte>(random());
      smooth[i] = static_cast<std::byte>((i / 3) % static_cast<size_t>(width) + 40 * (i % 3));
    }
    EXPECT_EQ(decompress_rgb8(compress_rgb8(noise, width, height), width, height), noise);
    const Bytes compressed = compress_rgb8(smooth, width, height);
    EXPECT_EQ(decompress_rgb8(compressed, width, height), smooth);
    if (width == 91) {
      EXPECT_LT(compressed.size(), smooth.size() / 50);
    }
    EXPECT_THROW(decompress_rgb8(compressed, width + 1, height), ProtocolError);
  }
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

TEST(Grid, NoSubpolygonWeighsMoreThanAMessageMay) {
  for (const auto& [width, height, per_processor] :
       {std::tuple{65536, 65536, 64}, std::tuple{16384, 16384, 2}, std::tuple{65536, 1, 1},
        std::tuple{9, 65536, 1}}) {
    for (const size_t pixel_bytes : {3, 12}) {
      const size_t most = kMostSubpolygonBytes / pixel_bytes;
      const SubpolygonGrid grid = make_grid(0, 0, width, height, 1, per_processor, kLeastSide_px, most);
      for (int s = 0; s < grid.count(); s += 7) {
        const DisplayPolygon p = grid.polygon(SubpolygonId(s));
        EXPECT_LE(size_t(p.right - p.left + 1) * size_t(p.bottom - p.top + 1), most);
      }
    }
  }
  EXPECT_EQ(make_grid(0, 0, 640, 480, 2).count(), make_grid(0, 0, 640, 480, 2, 64, 8, 1 << 20).count());
}

TEST(Interleaved, SetsAreEvenlySpread) {
  for (const int processors : {1, 2, 3, 8, 13}) {
    const SubpolygonGrid grid = make_grid(0, 0, 1024, 1024, processors);
    std::vector<int> owners(static_cast<size_t>(grid.count()), -1);
    for (int p = 0; p < processors; ++p)
      for (const SubpolygonId s : interleaved_set(grid, SetPattern::lattice, processors, p))
        owners[s.place()] = p;
    EXPECT_EQ(std::count(owners.begin(), owners.end(), -1), 0);
    for (int p = 0; p < processors; ++p)
      EXPECT_NEAR(static_cast<double>(std::count(owners.begin(), owners.end(), p)),
                  double(grid.count()) / processors, 2);
    if (processors > 2)  // no column belongs to one processor
      for (int column = 0; column < grid.columns; ++column) {
        bool differs = false;
        for (int row = 1; row < grid.rows; ++row)
          differs = differs || owners[static_cast<size_t>(row * grid.columns + column)] !=
                                   owners[static_cast<size_t>(column)];
        EXPECT_TRUE(differs);
      }
  }
}

struct SetCase {
  SubpolygonGrid grid;
  int processors;
};
/// 2 × 2, 3 × 5, and the 64 N of the thesis.
std::vector<SetCase> set_cases() {
  std::vector<SetCase> cases{{{0, 0, 20, 20, 2, 2}, 4},  {{0, 0, 20, 20, 2, 2}, 3},
                             {{0, 0, 30, 50, 3, 5}, 15}, {{0, 0, 30, 50, 3, 5}, 4},
                             {{0, 0, 50, 30, 5, 3}, 5},  {{0, 0, 512, 512, 16, 16}, 4}};
  for (const int processors : {7, 13}) cases.push_back({make_grid(0, 0, 1024, 1024, processors), processors});
  return cases;
}

// Thesis 4.4.4.2: "Rather than tracing the same subpolygon, the processor will do the subvolume directly to
// the right. [...] If the current subpolygon was on the right edge of the main display polygon the processor
// indexes down a row and over to the left. If the current subpolygon is in the bottom right corner of the
// main display polygon the upper left hand corner should be used."
TEST(Interleaved, FromFrameToFrameAProcessorMovesToTheRight_4_4_4_2) {
  for (const auto& [grid, processors] : set_cases())
    for (const SetPattern pattern : {SetPattern::rows, SetPattern::lattice})
      for (const int frame : {0, 1, 2, grid.count() - 1, grid.count(), 1000003})
        for (SubpolygonId s; s.value() < grid.count(); ++s) {
          int column = s.value() % grid.columns, row = s.value() / grid.columns;
          if (column < grid.columns - 1) {
            ++column;  // directly to the right
          } else if (row < grid.rows - 1) {
            ++row;  // down a row and over to the left
            column = 0;
          } else {
            row = column = 0;  // the upper left hand corner
          }
          EXPECT_EQ(interleaved_owner(grid, pattern, processors, FrameIndex(frame + 1),
                                      SubpolygonId(row * grid.columns + column)),
                    interleaved_owner(grid, pattern, processors, FrameIndex(frame), s));
        }
}

// Thesis 4.4.4.2: "each processor will have rendered part of this section an equal number of times".
TEST(Interleaved, EachProcessorHasEachSubpolygonEquallyOften_4_4_4_2) {
  for (const auto& [grid, processors] : set_cases())
    for (const SetPattern pattern : {SetPattern::rows, SetPattern::lattice}) {
      if (grid.count() % processors != 0) continue;
      const SubpolygonId hard(grid.count() / 3);
      std::vector<int> times(static_cast<size_t>(processors));
      for (FrameIndex f; f.value() < grid.count(); ++f)
        ++times[static_cast<size_t>(interleaved_owner(grid, pattern, processors, f, hard))];
      EXPECT_EQ(times, std::vector<int>(times.size(), grid.count() / processors));
    }
}

// Thesis 4.4.4.2: "The distribution of the set of subpolygons rendered by a processor is such that they are
// evenly distributed across the scene": in rows, one in every N; where 64 N make the picture, 64 each.
TEST(Interleaved, RowsGiveAProcessorOneInEveryN_4_4_4_2) {
  for (const auto& [grid, processors] : set_cases())
    for (int p = 0; p < processors; ++p) {
      const auto set = interleaved_set(grid, SetPattern::rows, processors, p);
      for (size_t i = 0; i < set.size(); ++i) EXPECT_EQ(set[i].value(), p + processors * static_cast<int>(i));
      EXPECT_GE(static_cast<int>(set.size()), grid.count() / processors);
    }
  const SubpolygonGrid grid{0, 0, 64, 64, 16, 16};  // 64 for each of 4
  for (int p = 0; p < 4; ++p) EXPECT_EQ(interleaved_set(grid, SetPattern::rows, 4, p).size(), 64u);
  // By hand, of the sets of 2 × 2 subpolygons and 3 processors: 0 1 2 0, then 0 0 1 2, then 2 0 0 1.
  const SubpolygonGrid four{0, 0, 20, 20, 2, 2};
  const int owners[3][4]{{0, 1, 2, 0}, {0, 0, 1, 2}, {2, 0, 0, 1}};
  for (int frame = 0; frame < 3; ++frame)
    for (int s = 0; s < 4; ++s)
      EXPECT_EQ(interleaved_owner(four, SetPattern::rows, 3, FrameIndex(frame), SubpolygonId(s)),
                owners[frame][s]);
}

TEST(Interleaved, ANodeFindsWhatTheHostExpectsOfIt) {
  for (const SetPattern pattern : {SetPattern::rows, SetPattern::lattice})
    for (const bool rotates : {true, false}) {
      JobPlan plan;
      plan.processors = 3;
      plan.sets = pattern;
      plan.rotates = rotates;
      const PicturesPhase phase{std::vector<FrameNumber>(20), make_grid(0, 0, 40, 24, 3)};
      for (int p = 0; p < 3; ++p) {
        const auto set = interleaved_set(phase.grid, pattern, 3, p);
        for (FrameIndex f; f.value() < 20; ++f) {
          std::set<ItemIndex> expected, found;
          for (SubpolygonId s; s.value() < phase.grid.count(); ++s)
            if (owner_of(plan, phase, phase.item_of(f, s)) == NodeId(p + 1))
              expected.insert(phase.item_of(f, s));
          for (const SubpolygonId s : set) found.insert(phase.item_of(f, own_subpolygon(plan, phase, f, s)));
          EXPECT_EQ(found, expected);
        }
      }
    }
}

TEST(LocalTransport, OrderAndMeter) {
  const auto ends = make_local_transports(2);
  ends[0]->send(NodeId(1), SelectStep{StepIndex(5)});
  ends[0]->send(NodeId(1), Channel::command, encode_display_polygon(0, {0, 0, 7, 7}));
  ends[0]->broadcast(Channel::command, encode_load_code(Bytes(4)));
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
