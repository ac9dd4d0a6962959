#pragma once
// The numbers in a chunk of a table, row by row: the same interface for text and for bytes.
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "common/description/formats/records.h"
#include "common/description/formats/table_chunks.h"

namespace rayfarm {

/// Lines' ends: a line feed, a carriage return or both.
inline bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
inline bool is_blank(char c) {
  return c == ' ' || c == '\t';
}
/// True if the line ends at `at`, and no other character of its end follows.
inline bool ends_line(std::string_view text, size_t at) {
  return text[at] == '\n' || (text[at] == '\r' && (at + 1 == text.size() || text[at + 1] != '\n'));
}

class TextValues {
 public:
  /// Both must outlive it.
  TextValues(const MeshTable& table, const TableChunk& chunk, const std::string& path)
      : table_(table),
        path_(path),
        at_(chunk.bytes.data()),
        end_(at_ + chunk.bytes.size()),
        line_(chunk.lines_before + 1) {}

  /// Goes to the next line that is neither empty nor a comment; the chunk must have it.
  void next_row() {
    if (is_in_row_) end_line();
    while (!has_more() && at_ != end_) end_line();
    is_in_row_ = true;
  }
  bool has_more() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    return at_ != end_ && !is_line_end(*at_) && *at_ != '#';
  }
  /// Infinite if it is beyond all floats, and not finite if the word says so.
  float real(NumberType) {
    const std::string_view word = next_word();
    float value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc{} && end == word.data() + word.size()) return value;
    const std::optional<double> other = parse_number(word);
    if (!other && error != std::errc::result_out_of_range)
      fail(fmt::format("expected a number, found '{}'", word.substr(0, 40)));
    return other ? static_cast<float>(*other) : HUGE_VALF;
  }
  int64_t whole(NumberType) {
    const std::string_view word = next_word();
    int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size())
      fail(fmt::format("expected a whole number, found '{}'", word.substr(0, 40)));
    return value;
  }
  /// Takes a -1, if the next number is one.
  bool try_restart(NumberType) {
    if (!has_more() || end_ - at_ < 2 || at_[0] != '-' || at_[1] != '1') return false;
    if (end_ - at_ > 2 && !is_blank(at_[2]) && !is_line_end(at_[2])) return false;
    at_ += 2;
    return true;
  }
  void skip(NumberType, uint64_t count) {
    for (; count > 0; --count) next_word();
  }
  [[noreturn]] void fail(std::string_view problem) const { throw InputError({path_, line_}, problem); }

 private:
  std::string_view next_word() {
    if (!has_more())
      fail(fmt::format(
          "the line ends before all numbers of the {} are there; each stands on a line of its own",
          table_.name));
    const char* const begin = at_;
    while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_)) ++at_;
    return {begin, static_cast<size_t>(at_ - begin)};
  }

  void end_line() {
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    if (at_ == end_) return;
    at_ += *at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n' ? 2 : 1;
    ++line_;
  }

  const MeshTable& table_;
  const std::string& path_;
  const char *at_, *end_;
  int line_;
  bool is_in_row_ = false;
};

inline size_t bytes_of(NumberType type) {
  constexpr size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<size_t>(type)];
}

template <std::endian endian>
class BinaryValues {
 public:
  /// Both must outlive it.
  BinaryValues(const MeshTable& table, const TableChunk& chunk, const std::string& path)
      : table_(table), chunk_(chunk), path_(path), row_(chunk.first_row) {}

  void next_row() { ++row_; }
  static bool has_more() { return false; }
  float real(NumberType type) {
    switch (type) {
      case NumberType::float32:
        return take<float>();
      case NumberType::float64:
        return static_cast<float>(take<double>());
      default:
        return static_cast<float>(whole(type));
    }
  }
  int64_t whole(NumberType type) {
    switch (type) {
      case NumberType::int8:
        return take<int8_t>();
      case NumberType::uint8:
        return take<uint8_t>();
      case NumberType::int16:
        return take<int16_t>();
      case NumberType::uint16:
        return take<uint16_t>();
      case NumberType::int32:
        return take<int32_t>();
      case NumberType::uint32:
        return take<uint32_t>();
      case NumberType::float32:
        return whole_of(take<float>());
      case NumberType::float64:
        return whole_of(take<double>());
    }
    return 0;
  }
  bool try_restart(NumberType type) {
    const size_t before = at_;
    if (whole(type) == -1) return true;
    at_ = before;
    return false;
  }
  void skip(NumberType type, uint64_t count) {
    if (count > (chunk_.bytes.size() - at_) / bytes_of(type)) fail_at_end();
    at_ += count * bytes_of(type);
  }
  size_t bytes_read() const { return at_; }
  [[noreturn]] void fail(std::string_view problem) const {
    throw InputError({path_}, fmt::format("{} {} of {}, before byte {}: {}", table_.name, row_, table_.rows,
                                          chunk_.bytes_before + at_, problem));
  }

 private:
  template <typename T>
  T take() {
    if (sizeof(T) > chunk_.bytes.size() - at_) fail_at_end();
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), chunk_.bytes.data() + at_, sizeof(T));
    if constexpr (endian != std::endian::native) std::reverse(bytes.begin(), bytes.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(bytes);
  }
  int64_t whole_of(double value) const {
    if (!(std::abs(value) < 0x1p53) || value != std::trunc(value))
      fail(fmt::format("expected a whole number, found {:g}", value));
    return static_cast<int64_t>(value);
  }
  [[noreturn]] void fail_at_end() const { fail("the file ends here; it was cut off"); }

  const MeshTable& table_;
  const TableChunk& chunk_;
  const std::string& path_;
  size_t at_ = 0;
  uint64_t row_;  ///< from 1
};

}  // namespace rayfarm
