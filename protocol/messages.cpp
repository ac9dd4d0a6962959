#include "protocol/messages.h"

#include <limits>

#include "protocol/number_groups.h"

namespace rayfarm {
namespace {

/// Which counters are not 0, and those.
template <typename Counters>
void write_counters(GroupWriter& w, const Counters& counters) {
  uint64_t which = 0;
  for (size_t i = 0; i < counters.size(); ++i) which |= uint64_t{counters[i] != 0} << i;
  w.number(which);
  for (const uint64_t count : counters)
    if (count != 0) w.number(count);
}
template <typename Counters>
void read_counters(GroupReader& r, Counters& counters) {
  const uint64_t which = r.number();
  if (which >> counters.size() != 0) throw ProtocolError("a message counts what nobody knows");
  for (size_t i = 0; i < counters.size(); ++i) counters[i] = which >> i & 1 ? r.number() : 0;
}

void write_report(ByteWriter& bytes, const SubpolygonReport& r) {
  GroupWriter w(bytes);
  w.number(static_cast<uint64_t>(r.frame.value()));
  w.number(static_cast<uint64_t>(r.subpolygon.value()));
  write_counters(w, r.rays);
  w.number(r.busy_us);
  w.number(r.not_finite << 1 | (r.sees_anything ? 1u : 0u));
  write_counters(w, r.ray_tallies);
  w.finish();
}

template <typename Value>
Value checked(uint64_t number) {
  if (number > static_cast<uint64_t>(std::numeric_limits<Value>::max()))
    throw ProtocolError("a number in a message is out of range");
  return static_cast<Value>(number);
}

/// Of return result, beside the thesis's pixels.
enum class Form : uint8_t {
  block,
  compressed_block,
  zone,
  compressed_zone,
  pass_block,
  compressed_pass_block
};

SubpolygonReport read_report(ByteReader& bytes) {
  GroupReader r(bytes);
  SubpolygonReport report;
  report.frame = FrameNumber(checked<int>(r.number()));
  report.subpolygon = SubpolygonId(checked<int>(r.number()));
  read_counters(r, report.rays);
  report.busy_us = r.number();
  const uint64_t last = r.number();
  report.sees_anything = last & 1;
  report.not_finite = last >> 1;
  read_counters(r, report.ray_tallies);
  return report;
}

void expect(ByteReader& r, Command command) {
  if (decode_word(r.u16()).command != command) throw ProtocolError("a message carries an unexpected command");
}

}  // namespace

const char* name_of(Command command) {
  static constexpr std::array<const char*, kCommands> kNames{"load_code", "load_data", "load_display_polygon",
                                                             "return_result"};
  return kNames[static_cast<size_t>(command)];
}

uint16_t encode_word(const CommandWord& word) {
  if (word.processor > kAllProcessors) throw ProtocolError("a processor id has 14 bits");
  return static_cast<uint16_t>(static_cast<unsigned>(word.command) << 14 | word.processor);
}

CommandWord decode_word(uint16_t bits) {
  return {static_cast<Command>(bits >> 14), static_cast<uint16_t>(bits & 0x3fff)};
}

Command command_of(std::span<const std::byte> message) {
  return decode_word(ByteReader(message).u16()).command;
}

Bytes encode_load_code(std::span<const std::byte> payload) {
  const size_t words = (payload.size() + kCodeWordBytes - 1) / kCodeWordBytes;
  ByteWriter w;
  w.u16(encode_word({Command::load_code, kAllProcessors}));
  w.u32(static_cast<uint32_t>(words));
  w.u32(0);
  w.bytes(payload);
  for (size_t i = payload.size(); i < words * kCodeWordBytes; ++i) w.u8(0);
  return w.take();
}

Bytes decode_load_code(std::span<const std::byte> message) {
  ByteReader r(message);
  expect(r, Command::load_code);
  const uint64_t words = r.u32();
  if (r.u32() != 0) throw ProtocolError("code is loaded at address 0");
  const auto payload = r.rest();
  if (payload.size() != words * kCodeWordBytes)
    throw ProtocolError("load code has another length than it says");
  return {payload.begin(), payload.end()};
}

void encode_load_data(const LoadData& data, Bytes& out) {
  if (data.address % kDataWordBytes != 0 || data.payload.size() % kDataWordBytes != 0)
    throw ProtocolError("data are loaded in words of 64 bytes");
  const uint64_t count = data.payload.size() / kDataWordBytes, address = data.address / kDataWordBytes;
  const uint64_t end = data.address < kStageAddress      ? kStageAddress
                       : data.address < kSolutionAddress ? kSolutionAddress
                                                         : kEndOfAddresses;
  if (data.address >= end || data.payload.size() > end - data.address)
    throw ProtocolError(end == kStageAddress ? "the scene is larger than load data can address (192 GiB)"
                                             : "zones are larger than load data can address (32 GiB)");
  ByteWriter w;
  w.u16(encode_word({Command::load_data, kAllProcessors}));
  w.u32(static_cast<uint32_t>(count));
  w.u32(static_cast<uint32_t>(address));
  w.bytes(data.payload);
  out = w.take();
}

LoadData decode_load_data(std::span<const std::byte> message) {
  ByteReader r(message);
  expect(r, Command::load_data);
  const uint64_t count = r.u32();
  LoadData data;
  data.address = uint64_t{r.u32()} * kDataWordBytes;
  data.payload = r.rest();
  if (data.payload.size() != count * kDataWordBytes)
    throw ProtocolError("load data has another length than it says");
  return data;
}

Bytes encode_unit_range(uint16_t processor, const UnitRange& range) {
  ByteWriter w;
  w.u16(encode_word({Command::load_display_polygon, processor}));
  w.u32(range.first);
  w.u32(range.last);
  return w.take();
}

UnitRange decode_unit_range(std::span<const std::byte> message) {
  ByteReader r(message);
  expect(r, Command::load_display_polygon);
  UnitRange range;
  range.first = r.u32();
  range.last = r.u32();
  r.expect_end();
  if (range.first > range.last) throw ProtocolError("the ends of a range are in the wrong order");
  return range;
}

Bytes encode_display_polygon(uint16_t processor, const DisplayPolygon& p) {
  ByteWriter w;
  w.u16(encode_word({Command::load_display_polygon, processor}));
  for (const uint16_t v : {p.left, p.top, p.right, p.bottom}) w.u16(v);
  return w.take();
}

DisplayPolygon decode_display_polygon(std::span<const std::byte> message) {
  ByteReader r(message);
  expect(r, Command::load_display_polygon);
  DisplayPolygon p;
  p.left = r.u16();
  p.top = r.u16();
  p.right = r.u16();
  p.bottom = r.u16();
  r.expect_end();
  if (p.left > p.right || p.top > p.bottom)
    throw ProtocolError("a display polygon's corners are in the wrong order");
  return p;
}

void append_pixel(uint16_t processor, const PixelResult& pixel, ByteWriter& w) {
  w.u16(encode_word({Command::return_result, processor}));
  w.u16(pixel.x);
  w.u16(pixel.y);
  for (const uint8_t c : pixel.rgb) w.u8(c);
}

PixelResult read_pixel(ByteReader& r) {
  expect(r, Command::return_result);
  PixelResult pixel;
  pixel.x = r.u16();
  pixel.y = r.u16();
  for (uint8_t& c : pixel.rgb) c = r.u8();
  return pixel;
}

Bytes encode_block(uint16_t processor, const BlockResult& block) {
  ByteWriter w;
  w.u16(encode_word({Command::return_result, processor}));
  const bool is_of_pass = block.pass > 0 || !block.running.empty();
  w.u8(static_cast<uint8_t>(is_of_pass
                                ? (block.is_compressed ? Form::compressed_pass_block : Form::pass_block)
                                : (block.is_compressed ? Form::compressed_block : Form::block)));
  write_report(w, block.report);
  if (is_of_pass) {
    w.varint(block.pass);
    w.varint(block.pixels.size());
  }
  w.bytes(block.pixels);
  w.bytes(block.running);
  return w.take();
}

BlockResult decode_block(std::span<const std::byte> message) {
  ByteReader r(message);
  expect(r, Command::return_result);
  BlockResult block;
  const Form form{r.u8()};
  const bool is_of_pass = form == Form::pass_block || form == Form::compressed_pass_block;
  if (!is_of_pass && form > Form::compressed_block) throw ProtocolError("a block of unknown form");
  block.is_compressed = form == Form::compressed_block || form == Form::compressed_pass_block;
  block.report = read_report(r);
  if (is_of_pass) {
    block.pass = checked<uint16_t>(r.varint());
    block.pixels = r.bytes(r.varint());
    block.running = r.rest();
  } else {
    block.pixels = r.rest();
  }
  return block;
}

Bytes encode_zone_result(uint16_t processor, const ZoneResult& result) {
  ByteWriter w;
  w.u16(encode_word({Command::return_result, processor}));
  w.u8(static_cast<uint8_t>(result.is_compressed ? Form::compressed_zone : Form::zone));
  GroupWriter numbers(w);
  numbers.number(result.phase);
  numbers.number(static_cast<uint64_t>(result.item.value()));
  write_counters(numbers, result.rays);
  numbers.number(result.busy_us);
  write_counters(numbers, result.ray_tallies);
  numbers.finish();
  w.bytes(result.bytes);
  return w.take();
}

bool is_zone_result(std::span<const std::byte> message) {
  ByteReader r(message);
  expect(r, Command::return_result);
  const Form form{r.u8()};
  return form == Form::zone || form == Form::compressed_zone;
}

ZoneResult decode_zone_result(std::span<const std::byte> message) {
  if (!is_zone_result(message)) throw ProtocolError("a result that is not of zones");
  ByteReader r(message);
  ZoneResult result;
  r.u16();
  result.is_compressed = Form{r.u8()} == Form::compressed_zone;
  GroupReader numbers(r);
  result.phase = checked<uint32_t>(numbers.number());
  result.item = ItemIndex(checked<int64_t>(numbers.number()));
  read_counters(numbers, result.rays);
  result.busy_us = numbers.number();
  read_counters(numbers, result.ray_tallies);
  result.bytes = r.rest();
  return result;
}

Bytes encode_control(const Control& control) {
  ByteWriter w;
  w.u8(static_cast<uint8_t>(control.index()));
  struct Write {
    ByteWriter& w;
    void operator()(const Hello& m) const {
      w.text(m.machine);
      w.u32(m.pid);
      w.text(m.build);
    }
    void operator()(const Alive&) const {}
    void operator()(const SelectStep& m) const { w.u32(static_cast<uint32_t>(m.step.value())); }
    void operator()(const OpenSteps& m) const { w.u32(static_cast<uint32_t>(m.end.value())); }
    void operator()(const SubpolygonDone& m) const { write_report(w, m.report); }
    void operator()(const ItemFailed& m) const {
      w.u32(m.phase);
      w.u64(static_cast<uint64_t>(m.item.value()));
      w.text(m.problem);
    }
    void operator()(const NodeFailed& m) const { w.text(m.problem); }
    void operator()(const EndProcess& m) const { w.u32(m.pid); }
    void operator()(const Finish& m) const { w.u8(m.has_losses ? 1 : 0); }
    void operator()(const AskPresent&) const {}
    void operator()(const Present&) const {}
    void operator()(const BeginPhase& m) const {
      w.u32(m.number);
      w.u8(static_cast<uint8_t>(m.kind));
      w.u32(static_cast<uint32_t>(m.frame));
      for (const uint64_t v : {m.units, m.units_per_item, m.data_bytes}) w.varint(v);
    }
    void operator()(const GoOnFrom& m) const { w.bytes(m.running); }
  };
  std::visit(Write{w}, control);
  return w.take();
}

Control decode_control(std::span<const std::byte> message) {
  ByteReader r(message);
  const uint8_t kind = r.u8();
  Control control;
  switch (kind) {
    case 0: {
      Hello m;
      m.machine = r.text();
      m.pid = r.u32();
      m.build = r.text();
      control = m;
      break;
    }
    case 1:
      control = Alive{};
      break;
    case 2:
      control = SelectStep{StepIndex(checked<int>(r.u32()))};
      break;
    case 3:
      control = OpenSteps{StepIndex(checked<int>(r.u32()))};
      break;
    case 4:
      control = SubpolygonDone{read_report(r)};
      break;
    case 5: {
      ItemFailed m;
      m.phase = r.u32();
      m.item = ItemIndex(checked<int64_t>(r.u64()));
      m.problem = r.text();
      control = m;
      break;
    }
    case 6:
      control = NodeFailed{r.text()};
      break;
    case 7:
      control = EndProcess{r.u32()};
      break;
    case 8:
      control = Finish{r.u8() != 0};
      break;
    case 9:
      control = AskPresent{};
      break;
    case 10:
      control = Present{};
      break;
    case 11: {
      BeginPhase m;
      m.number = r.u32();
      m.kind = PhaseKind{r.u8()};
      m.frame = static_cast<int>(r.u32());
      for (uint64_t* v : {&m.units, &m.units_per_item, &m.data_bytes}) *v = r.varint();
      if (m.kind > PhaseKind::zones) throw ProtocolError("a phase of unknown kind");
      if (m.units == 0 || m.units_per_item == 0) throw ProtocolError("a phase without work");
      if (m.data_bytes > kMostPhaseDataBytes) throw ProtocolError("a phase with too many data");
      control = m;
      break;
    }
    case 12: {
      const std::span<const std::byte> running = r.rest();
      control = GoOnFrom{Bytes(running.begin(), running.end())};
      break;
    }
    default:
      throw ProtocolError("a control message of unknown kind");
  }
  r.expect_end();
  return control;
}

}  // namespace rayfarm
