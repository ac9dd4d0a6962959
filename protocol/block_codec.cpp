#include "protocol/block_codec.h"

#include <bit>
#include <cstring>

#include "protocol/block_symbols.h"
#include "protocol/block_tables.h"

namespace rayfarm {
namespace {

using namespace block_model;
using namespace block_tables;

// The first byte.
constexpr size_t kSlopes = kRedSlopes.size() * kBlueSlopes.size();
constexpr size_t kOneColour = kSets * kSlopes;
static_assert(kOneColour < 256);

constexpr size_t kColourBytes = 3;
/// What a pixel takes at most: three times a state's and the plain bits.
constexpr size_t kMostBitsOfPixel = 3 * (kStateBits + 5);

size_t pixels_of(int width, int height) {
  if (width < 1 || height < 1) throw ProtocolError("a block has no pixels");
  return static_cast<size_t>(width) * static_cast<size_t>(height);
}

/// Writes bits from the end of its memory to the beginning, what was put last lowest: a reader meets it
/// first.
class BackwardBits {
 public:
  explicit BackwardBits(size_t most_bits) {
    memory().resize(most_bits / 8 + 16);
    end_ = at_ = memory().data() + memory().size();
  }
  void put(uint64_t value, unsigned count) {
    bits_ = bits_ << count | value;
    count_ += count;
  }
  /// To be called before more than 32 further bits.
  void make_room() {
    if (count_ < 32) return;
    count_ -= 32;
    const auto whole = static_cast<uint32_t>(bits_ >> count_);
    for (unsigned i = 4; i-- > 0;) *--at_ = static_cast<std::byte>(whole >> 8 * i & 0xff);
    bits_ &= (uint64_t{1} << count_) - 1;
  }
  /// All that was put, from zeros and a one on.
  std::span<const std::byte> finish() {
    make_room();
    put(1, 1);
    const unsigned bytes = (count_ + 7) / 8;
    bits_ <<= 8 * bytes - count_;
    for (unsigned i = bytes; i-- > 0;) *--at_ = static_cast<std::byte>(bits_ >> 8 * i & 0xff);
    return {at_, end_};
  }

 private:
  static std::vector<std::byte>& memory() {
    thread_local std::vector<std::byte> bytes;
    return bytes;
  }
  std::byte *at_, *end_;
  uint64_t bits_ = 0;
  unsigned count_ = 0;
};

struct PlainBits {
  uint8_t token, count, value;
};
constexpr std::array<PlainBits, 256> kPlainBits = [] {
  std::array<PlainBits, 256> table{};
  for (int folded = 0; folded < 256; ++folded) {
    const Token t = token_of(folded);
    table[static_cast<size_t>(folded)] = {t.token, t.bits, static_cast<uint8_t>(folded - t.base)};
  }
  return table;
}();

size_t cheapest_set(const std::vector<Symbol>& symbols, const EncodingTables& tables) {
  std::array<uint64_t, kSets> sums{};
  for (size_t begin = 0; begin < symbols.size();) {
    std::array<uint32_t, 4> part{};
    for (const size_t end = std::min(symbols.size(), begin + (1 << 20)); begin < end; ++begin) {
      const Symbol s = symbols[begin];
      const auto& cost = tables.costs[size_t{s.context} * kTokens + kPlainBits[s.folded].token];
      for (size_t i = 0; i < part.size(); ++i) part[i] += cost[i];
    }
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += part[i];
  }
  return static_cast<size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
}

[[noreturn]] void refuse() {
  throw ProtocolError("a compressed block is damaged");
}

/// Reads bits, lowest first, of bytes behind which others may be read: it is found out later that there were
/// none.
class ForwardBits {
 public:
  explicit ForwardBits(const std::byte* bytes, size_t position) : bytes_(bytes), position_(position) {}
  /// To be called before more than 56 further bits.
  void refill() {
    position_ += taken_;
    taken_ = 0;
    bits_ = 0;
    if constexpr (std::endian::native == std::endian::little)
      std::memcpy(&bits_, bytes_ + (position_ >> 3), sizeof bits_);
    else
      for (unsigned i = 0; i < 8; ++i)
        bits_ |= std::to_integer<uint64_t>(bytes_[(position_ >> 3) + i]) << 8 * i;
    bits_ >>= position_ & 7;
  }
  uint32_t peek() const { return static_cast<uint32_t>(bits_); }
  void skip(uint32_t count) {
    bits_ >>= count;
    taken_ += count;
  }
  size_t position() const { return position_ + taken_; }

 private:
  const std::byte* bytes_;
  size_t position_;
  uint64_t bits_ = 0;
  uint32_t taken_ = 0;
};

/// The coder's state, and what it is read from.
struct Decoder {
  ForwardBits bits;
  uint32_t state = 0;
  uint32_t size = 0;  ///< of the token that was taken last, × kStates

  /// The next difference.
  int take(const uint32_t* table) {
    const uint32_t entry = table[state], low = bits.peek(), both = entry >> kBothAt & 31;
    state = (entry >> kNextAt & (kStates - 1)) + (low & ((1u << (entry & 31)) - 1));
    size = entry >> kSizeAt << kStateBits;
    const uint32_t folded = (entry >> kFoldedAt & 255) + ((low & ((1u << both) - 1)) >> (entry & 31));
    bits.skip(both);
    return unfold(static_cast<int>(folded));
  }
};

/// Contexts as places in a set of tables.
constexpr ContextTables kTableOf = make_context_tables(kStates);

/// Red or blue without green, where `other_off` is by what the channel before it was mispredicted.
int decode_colour(Decoder& decoder, const uint32_t* table, int prediction, int green, int slope,
                  int other_off) {
  const int off = decoder.take(table), sign = other_off >> 31;
  return ((clamped(prediction + green + share(slope, other_off)) + ((off ^ sign) - sign)) & 255) - green;
}

/// Values of a channel in two rows, each with one before it and one behind.
struct Rows {
  int *above = nullptr, *row = nullptr;

  void end_row(size_t width) {
    row[width] = row[width - 1];
    std::swap(above, row);
    row[-1] = above[0];
  }
};

/// Green, red - green, blue - green.
struct Channels {
  std::array<Rows, 3> rows;

  explicit Channels(size_t width) {
    thread_local std::vector<int> memory;
    memory.resize(6 * (width + 2));
    int* at = memory.data() + 1;
    for (Rows& r : rows)
      for (int** row : {&r.above, &r.row}) {
        *row = at;
        at += width + 2;
      }
  }
};

void put_pixel(std::byte* out, int green, int red_off, int blue_off) {
  out[0] = static_cast<std::byte>(green + red_off);
  out[1] = static_cast<std::byte>(green);
  out[2] = static_cast<std::byte>(green + blue_off);
}

void decode_top_row(Decoder& decoder, const uint32_t* tables, Channels& channels, size_t width,
                    std::byte* out) {
  int *greens = channels.rows[0].row, *reds = channels.rows[1].row, *blues = channels.rows[2].row;
  greens[0] = greens[-1] = static_cast<int>(decoder.bits.peek() & 255);
  decoder.bits.skip(8);
  for (int* colours : {reds, blues})
    colours[0] = colours[-1] =
        ((greens[0] + decoder.take(tables + kFirstColour * kStates)) & 255) - greens[0];
  put_pixel(out, greens[0], reds[0], blues[0]);
  for (size_t x = 1; x < width; ++x) {
    decoder.bits.refill();
    const auto expected = [&](const int* row) {
      return expect_in_top_row(row[x - 1], row[x - (x > 1 ? 2 : 1)]);
    };
    const auto [of_green, unrest] = expected(greens);
    greens[x] = (of_green + decoder.take(tables + kTableOf.green_top[unrest])) & 255;
    int other_off = greens[x] - of_green;
    for (int* colours : {reds, blues}) {
      const Expected of = expected(colours);
      colours[x] = decode_colour(decoder, tables + kTableOf.colour_top[of.unrest] + decoder.size,
                                 of.prediction, greens[x], 0, other_off);
      other_off = colours[x] - of.prediction;
    }
    put_pixel(out + 3 * x, greens[x], reds[x], blues[x]);
  }
}

void decode_row(Decoder& state, const uint32_t* tables, int red_slope, int blue_slope,
                const Channels& channels, size_t width, std::byte* out) {
  Decoder decoder = state;  // in registers
  const auto& [greens, reds, blues] = channels.rows;
  struct Left {
    int left, corner;
    explicit Left(const Rows& rows) : left(rows.row[-1]), corner(rows.above[-1]) {}
    Expected expected(const Rows& rows, size_t x) const {
      return expect(left, rows.above[x], corner, rows.above[x + 1]);
    }
    void go_on(const Rows& rows, size_t x, int value) {
      rows.row[x] = left = value;
      corner = rows.above[x];
    }
  };
  Left green_left(greens), red_left(reds), blue_left(blues);
  for (size_t x = 0; x < width; ++x, out += 3) {
    decoder.bits.refill();
    const Expected of_green = green_left.expected(greens, x), of_red = red_left.expected(reds, x),
                   of_blue = blue_left.expected(blues, x);
    const int green = (of_green.prediction + decoder.take(tables + kTableOf.green[of_green.unrest])) & 255;
    const int green_off = green - of_green.prediction;
    const int red = decode_colour(decoder, tables + kTableOf.colour[of_red.unrest] + decoder.size,
                                  of_red.prediction, green, red_slope, green_off);
    const int red_off = red - of_red.prediction;
    const int blue = decode_colour(decoder, tables + kTableOf.colour[of_blue.unrest] + decoder.size,
                                   of_blue.prediction, green, blue_slope, red_off);
    green_left.go_on(greens, x, green);
    red_left.go_on(reds, x, red);
    blue_left.go_on(blues, x, blue);
    put_pixel(out, green, red, blue);
  }
  state = decoder;
}

}  // namespace

Bytes compress_rgb8(std::span<const std::byte> pixels, int width, int height) {
  const size_t n = pixels_of(width, height);
  if (pixels.size() != kColourBytes * n) throw ProtocolError("a block has another size than its corners say");
  if (std::memcmp(pixels.data(), pixels.data() + kColourBytes, pixels.size() - kColourBytes) == 0) {
    Bytes one_colour{static_cast<std::byte>(kOneColour)};
    one_colour.insert(one_colour.end(), pixels.begin(), pixels.begin() + kColourBytes);
    return one_colour;
  }
  thread_local Symbols symbols;
  make_symbols(pixels, width, height, symbols);
  const EncodingTables& tables = encoding_tables();
  const size_t set = cheapest_set(symbols.symbols, tables);
  const EncodingTable* contexts = tables.contexts.data() + set * kContexts;

  BackwardBits bits(n * kMostBitsOfPixel);
  uint32_t state = 0;
  for (size_t i = symbols.symbols.size(); i-- > 0;) {
    const auto [context, folded] = symbols.symbols[i];
    const EncodingTable& table = contexts[context];
    const PlainBits plain = kPlainBits[folded];
    const uint32_t at = state + kStates, count = (at + table.add[plain.token]) >> 16;
    bits.put(plain.value, plain.count);
    bits.put(at & ((1u << count) - 1), count);
    bits.make_room();
    state = table.next[static_cast<size_t>(static_cast<int>(at >> count) + table.first[plain.token])];
  }
  bits.put(std::to_integer<uint64_t>(pixels[1]), 8);
  bits.put(state, kStateBits);
  const auto coded = bits.finish();
  Bytes out(1 + coded.size());
  out[0] = static_cast<std::byte>((set * kRedSlopes.size() + symbols.red_slope) * kBlueSlopes.size() +
                                  symbols.blue_slope);
  std::copy(coded.begin(), coded.end(), out.begin() + 1);
  return out;
}

void decompress_rgb8(std::span<const std::byte> compressed, int width, int height,
                     std::span<std::byte> pixels) {
  const size_t n = pixels_of(width, height), w = static_cast<size_t>(width);
  if (pixels.size() != kColourBytes * n) throw ProtocolError("a block has another size than its corners say");
  if (compressed.size() < 2) refuse();
  const size_t kind = std::to_integer<size_t>(compressed[0]);
  if (kind == kOneColour) {
    if (compressed.size() != 1 + kColourBytes) refuse();
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = compressed[1 + i % kColourBytes];
    return;
  }
  const auto first = std::to_integer<unsigned>(compressed[1]);
  if (kind > kOneColour || first == 0) refuse();
  const size_t set = kind / kSlopes;
  const int red_slope = kRedSlopes[kind / kBlueSlopes.size() % kRedSlopes.size()],
            blue_slope = kBlueSlopes[kind % kBlueSlopes.size()];

  // A row is read before it is known whether its bits are there.
  thread_local std::vector<std::byte> bytes;
  bytes.assign(compressed.begin() + 1, compressed.end());
  const size_t end = 8 * bytes.size();
  bytes.resize(bytes.size() + w * kMostBitsOfPixel / 8 + 16);
  Decoder decoder{ForwardBits(bytes.data(), static_cast<size_t>(std::countr_zero(first)) + 1)};
  decoder.bits.refill();
  decoder.state = decoder.bits.peek() & (kStates - 1);
  decoder.bits.skip(kStateBits);
  const uint32_t* tables = decoding_tables().states[set * kContexts].data();
  Channels channels(w);
  for (size_t y = 0; y < static_cast<size_t>(height); ++y) {
    std::byte* out = pixels.data() + y * w * kColourBytes;
    if (y == 0)
      decode_top_row(decoder, tables, channels, w, out);
    else
      decode_row(decoder, tables, red_slope, blue_slope, channels, w, out);
    if (decoder.bits.position() > end) refuse();
    for (Rows& rows : channels.rows) rows.end_row(w);
  }
  if (decoder.bits.position() != end || decoder.state != 0) refuse();
}

Bytes decompress_rgb8(std::span<const std::byte> compressed, int width, int height) {
  Bytes pixels(kColourBytes * pixels_of(width, height));
  decompress_rgb8(compressed, width, height, pixels);
  return pixels;
}

}  // namespace rayfarm
