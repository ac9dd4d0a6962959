#include "tests/fuzz/messages.h"

#include "protocol/block_codec.h"
#include "protocol/byte_codec.h"
#include "protocol/job_plan.h"
#include "protocol/phase_data.h"

namespace rayfarm::fuzz {
namespace {

/// A megabyte of zeros and more in a few hundred bytes.
Bytes zstd_bomb() {
  return *compress_bytes(Bytes(8 << 20));
}

std::string words_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::vector<std::string> message_seeds() {
  SubpolygonReport report{FrameNumber(3), SubpolygonId(7), {1, 2, 3, 4, 5}, 1000, true, 2, {6, 7, 8, 9, 10}};
  std::vector<std::string> seeds;
  for (const Control& c :
       {Control(Hello{"machine", 7, "build"}), Control(Alive{}), Control(SelectStep{StepIndex(3)}),
        Control(OpenSteps{StepIndex(4)}), Control(SubpolygonDone{report}),
        Control(ItemFailed{1, ItemIndex(2), "no"}), Control(NodeFailed{"no"}), Control(EndProcess{9}),
        Control(Finish{true}), Control(BeginPhase{3, PhaseKind::zones, 2, 1000, 7, 4096}),
        Control(GoOnFrom{Bytes(24)})})
    seeds.push_back(words_of(encode_control(c)));
  seeds.push_back(words_of(encode_display_polygon(3, {0, 0, 7, 7})));
  const Bytes pixels = compress_rgb8(Bytes(3 * 8 * 8), 8, 8);
  seeds.push_back(words_of(encode_block(3, {report, true, pixels})));
  seeds.push_back(words_of(encode_block(3, {report, true, pixels, 2, Bytes(24 * 8 * 8)})));
  seeds.push_back(words_of(encode_unit_range(3, {70'000, 140'000})));
  const Bytes sums = *compress_bytes(Bytes(640));
  seeds.push_back(words_of(
      encode_zone_result(3, {5, ItemIndex(7), {1, 2, 3, 4, 5}, 1000, {6, 7, 8, 9, 10}, true, sums})));
  const Bytes bomb = zstd_bomb();
  seeds.push_back(words_of(encode_zone_result(3, {5, ItemIndex(7), {1}, 1000, {}, true, bomb})));
  Bytes load;
  const Bytes payload(128, std::byte{9});
  encode_load_data({64, payload}, load);
  seeds.push_back(words_of(load));
  seeds.push_back(words_of(encode_load_code(Bytes(16))));
  ByteWriter pixel;
  append_pixel(1, {2, 3, {4, 5, 6}}, pixel);
  seeds.push_back(words_of(pixel.take()));
  return seeds;
}

void decode_messages(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  const auto try_all = [&](auto... decoders) {
    const auto one = [&](auto decode) {
      try {
        decode();
      } catch (const ProtocolError&) {
      }
    };
    (one(decoders), ...);
  };
  try_all([&] { decode_control(bytes); }, [&] { decode_display_polygon(bytes); },
          [&] { decode_load_data(bytes); }, [&] { decode_load_code(bytes); }, [&] { command_of(bytes); },
          [&] {
            ByteReader reader(bytes);
            while (!reader.at_end()) read_pixel(reader);
          },
          [&] { decode_unit_range(bytes); },
          [&] {
            const ZoneResult result = decode_zone_result(bytes);
            if (result.is_compressed) decompress_bytes(result.bytes, 1 << 20);
          },
          [&] {
            DataIntake intake;
            intake.expect(64, 100);
            intake.take(decode_load_data(bytes));
          },
          [&] {
            const BlockResult block = decode_block(bytes);
            if (block.is_compressed) decompress_rgb8(block.pixels, 8, 8);
          });
}

}  // namespace rayfarm::fuzz
