#pragma once
// The messages of the net (thesis 4.4.4.2). A command is a 16-bit word: two bits of code, fourteen of
// processor id. Beside the four commands there are control messages, which the thesis's machine needed none
// of: who is there, who is alive, which frame is meant, what failed. They are counted apart.
#include <array>
#include <optional>
#include <variant>

#include "protocol/byte_stream.h"
#include "protocol/index.h"

namespace rayfarm {

enum class Command : uint8_t { load_code, load_data, load_display_polygon, return_result };
inline constexpr std::array kAllCommands{Command::load_code, Command::load_data,
                                         Command::load_display_polygon, Command::return_result};
inline constexpr size_t kCommands = kAllCommands.size();
const char* name_of(Command command);

/// Processors are numbered from 0; the largest id means all of them.
inline constexpr int kMostProcessors = 16'383;
inline constexpr uint16_t kAllProcessors = 16'383;
/// The processor that a node is.
constexpr uint16_t processor_of(NodeId node) {
  return static_cast<uint16_t>(node.value() - 1);
}

struct CommandWord {
  Command command = Command::load_code;
  uint16_t processor = kAllProcessors;
};
uint16_t encode_word(const CommandWord& word);
CommandWord decode_word(uint16_t bits);
/// The command of a message on the command channel.
Command command_of(std::span<const std::byte> message);

// Load code, load data: word, count, address, payload.

/// Count and address are 32 bits each and count words of this many bytes.
inline constexpr size_t kCodeWordBytes = 4;
inline constexpr size_t kDataWordBytes = 64;
inline constexpr size_t kLoadHeaderBytes = 10;

/// Data travel in chunks of so much. A chunk takes well under the time limits even on the thesis's 8 Mbit/s
/// net (0.26 s per copy).
inline constexpr size_t kChunkBytes = 256 << 10;
static_assert(kChunkBytes % kDataWordBytes == 0);

Bytes encode_load_code(std::span<const std::byte> payload);
Bytes decode_load_code(std::span<const std::byte> message);

/// Where data lie: the scene block from 0 on, above it what a stage of zones needs, and above that the light
/// that pictures take from zones. A chunk lies in one of the three.
inline constexpr uint64_t kStageAddress = uint64_t{192} << 30;
inline constexpr uint64_t kSolutionAddress = uint64_t{224} << 30;
inline constexpr uint64_t kEndOfAddresses = uint64_t{256} << 30;
/// What a phase's data weigh at most.
inline constexpr uint64_t kMostPhaseDataBytes = kSolutionAddress - kStageAddress;

/// A chunk of data: `address` and the payload's size are multiples of kDataWordBytes.
struct LoadData {
  uint64_t address = 0;
  std::span<const std::byte> payload;
};
void encode_load_data(const LoadData& data, Bytes& out);
LoadData decode_load_data(std::span<const std::byte> message);

// Load display polygon: word, two corners.

/// The upper left and lower right pixel of a subpolygon, both inside it: 0 to 65,535 each.
struct DisplayPolygon {
  uint16_t left = 0, top = 0, right = 0, bottom = 0;
  bool operator==(const DisplayPolygon&) const = default;
};
/// In pixels.
constexpr size_t area_of(const DisplayPolygon& p) {
  return static_cast<size_t>(p.right - p.left + 1) * static_cast<size_t>(p.bottom - p.top + 1);
}
inline constexpr size_t kDisplayPolygonBytes = 10;
Bytes encode_display_polygon(uint16_t processor, const DisplayPolygon& polygon);
DisplayPolygon decode_display_polygon(std::span<const std::byte> message);

// In a phase of zones: word, first and last unit, in the places of the corners.

/// Units of a stage, both ends inside it.
struct UnitRange {
  uint32_t first = 0, last = 0;
  bool operator==(const UnitRange&) const = default;
};
Bytes encode_unit_range(uint16_t processor, const UnitRange& range);
UnitRange decode_unit_range(std::span<const std::byte> message);

// Return result.

/// Rays are counted in so many kinds, whose meaning host and nodes know.
inline constexpr size_t kRayCounters = 5;
/// What else is counted of them.
inline constexpr size_t kRayTallyCounters = 6;

/// What it took to trace a subpolygon. It travels in a block's header; beside the pixel wire it is a control
/// message.
struct SubpolygonReport {
  FrameNumber frame;
  SubpolygonId subpolygon;
  std::array<uint64_t, kRayCounters> rays{};
  uint64_t busy_us = 0;
  bool sees_anything = false;  ///< an eye ray met something
  uint64_t not_finite = 0;     ///< pixels that are infinite or not a number
  std::array<uint64_t, kRayTallyCounters> ray_tallies{};
};

/// The thesis's form: 2 bytes of word, 2 × 2 of position, 3 of value; several may follow each other in one
/// message.
inline constexpr size_t kPixelBytes = 9;
/// The most that one transfer holds: 4,095 bytes, within MPI's eager limit.
inline constexpr size_t kPixelsPerTransfer = 455;
struct PixelResult {
  uint16_t x = 0, y = 0;
  std::array<uint8_t, 3> rgb{};
};
void append_pixel(uint16_t processor, const PixelResult& pixel, ByteWriter& out);
PixelResult read_pixel(ByteReader& in);

/// A whole subpolygon: report, then the pixels' bytes. In a picture of several passes also which it is, and
/// what the next goes on from: bytes whose meaning the renderer knows.
struct BlockResult {
  SubpolygonReport report;
  bool is_compressed = false;  ///< the pixels
  std::span<const std::byte> pixels;
  uint16_t pass = 0;
  std::span<const std::byte> running{};  ///< none after the last pass
};
Bytes encode_block(uint16_t processor, const BlockResult& block);
BlockResult decode_block(std::span<const std::byte> message);

/// The zone form: what came of an item of a stage, as bytes whose meaning zones know.
struct ZoneResult {
  uint32_t phase = 0;
  ItemIndex item;
  std::array<uint64_t, kRayCounters> rays{};
  uint64_t busy_us = 0;
  std::array<uint64_t, kRayTallyCounters> ray_tallies{};
  bool is_compressed = false;
  std::span<const std::byte> bytes;
};
Bytes encode_zone_result(uint16_t processor, const ZoneResult& result);
ZoneResult decode_zone_result(std::span<const std::byte> message);
/// True if a return result is of the zone form, whatever else it holds.
bool is_zone_result(std::span<const std::byte> message);

// Control.

enum class PhaseKind : uint8_t { pictures, zones };

/// Both ways, first of all.
struct Hello {
  std::string machine;
  uint32_t pid = 0;
  std::string build;
};
/// Both ways, by the heart.
struct Alive {};
/// Host → node: a phase begins, and what was handed out before is over. Before its items are done a node
/// holds `data_bytes` of data, which come by load data at its address.
struct BeginPhase {
  uint32_t number = 0;  ///< phases are numbered from 0 in the order of their beginning
  PhaseKind kind = PhaseKind::pictures;
  /// Of pictures: the place of the first frame among the job's; of zones: the number of the frame whose pose
  /// they have.
  int frame = 0;
  uint64_t units = 0;           ///< of pictures: frames
  uint64_t units_per_item = 1;  ///< of pictures: no more than 1
  uint64_t data_bytes = 0;
  bool operator==(const BeginPhase&) const = default;
};
/// Host → node: what the pass before gave for the display polygon that comes next.
struct GoOnFrom {
  Bytes running;
};
/// Host → node: the step (of pictures: the frame, and its pass) of the display polygons that follow.
struct SelectStep {
  StepIndex step;
};
/// Host → node, interleaved: the node may do its own items of the steps before this one.
struct OpenSteps {
  StepIndex end;
};
/// Node → host, pixel wire: all pixels of a subpolygon have been sent.
struct SubpolygonDone {
  SubpolygonReport report;
};
/// Node → host.
struct ItemFailed {
  uint32_t phase = 0;
  ItemIndex item;
  std::string problem;
};
/// Node → host: it could not load.
struct NodeFailed {
  std::string problem;
};
/// Host → node: end a hung process of this job on your machine.
struct EndProcess {
  uint32_t pid = 0;
};
/// Host → node: the job is over.
struct Finish {
  bool has_losses = false;  ///< some node is lost: ending MPI would wait for it
};
/// Host → node, at the end: answer with Present.
struct AskPresent {};
/// Node → host.
struct Present {};
using Control = std::variant<Hello, Alive, SelectStep, OpenSteps, SubpolygonDone, ItemFailed, NodeFailed,
                             EndProcess, Finish, AskPresent, Present, BeginPhase, GoOnFrom>;
Bytes encode_control(const Control& control);
Control decode_control(std::span<const std::byte> message);

}  // namespace rayfarm
