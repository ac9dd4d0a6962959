#pragma once
// The numbers in a chunk of a table, row by row: the same interface for text and for bytes.
#include <bit>
#include <cmath>
#include <cstring>

#include "common/description/formats/row_words.h"
#include "common/description/formats/table_chunks.h"

namespace rayfarm {

class TextValues {
 public:
  /// Both must outlive it.
  TextValues(const MeshTable&, const TableChunk& chunk, const std::string& path)
      : words_(chunk.bytes, path, chunk.lines_before) {}

  void next_row() { words_.next_row(); }
  bool has_more() { return words_.has_more(); }
  float real(NumberType) { return words_.real(); }
  int64_t whole(NumberType) { return words_.whole(); }
  void skip(NumberType, uint64_t count) {
    for (; count > 0; --count)
      if (words_.word().empty()) fail("the line ends before all numbers are there that the head tells of");
  }
  /// Takes a -1, if the next number is one.
  bool try_restart(NumberType) {
    if (words_.peek() != "-1") return false;
    words_.word();
    return true;
  }
  [[noreturn]] void fail(std::string_view problem) const { words_.fail(problem); }

 private:
  RowWords words_;
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
