#pragma once
// Text whose lines are rows of words, as PLY, OFF and STL have it: empty lines are no rows, # begins a
// comment, and lines end in a line feed, a carriage return or both.
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "common/description/formats/records.h"

namespace rayfarm {

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
inline bool begins_line(std::string_view text, size_t at) {
  return at == 0 || ends_line(text, at - 1);
}

class RowWords {
 public:
  /// `text` and `path` must outlive it; `lines_before` it stand in the file.
  RowWords(std::string_view text, const std::string& path, int lines_before)
      : path_(path), at_(text.data()), end_(at_ + text.size()), line_(lines_before + 1) {}

  /// Goes to the next row; false at the end.
  bool next_row() {
    if (is_in_row_) end_line();
    while (at_ != end_ && !has_more()) end_line();
    return is_in_row_ = at_ != end_;
  }
  bool has_more() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    return at_ != end_ && !is_line_end(*at_) && *at_ != '#';
  }
  /// The next one of the row; empty at its end.
  std::string_view word() {
    if (!has_more()) return {};
    const char* const begin = at_;
    while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_)) ++at_;
    return {begin, static_cast<size_t>(at_ - begin)};
  }
  /// The same, without taking it.
  std::string_view peek() {
    const char* const before = at_;
    const std::string_view found = word();
    at_ = before;
    return found;
  }
  /// The next word, rounded correctly. Infinite if it is beyond all floats; not finite if the word says so.
  float real() {
    const std::string_view found = word();
    float value = 0;
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error == std::errc{} && end == found.data() + found.size()) return value;
    const std::optional<double> other = parse_number(found);  // with a plus, or too small
    if (other) return static_cast<float>(*other);
    if (error != std::errc::result_out_of_range || end != found.data() + found.size())
      fail_at("a number", found);
    return HUGE_VALF;
  }
  int64_t whole() {
    const std::string_view found = word();
    int64_t value = 0;
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error != std::errc{} || end != found.data() + found.size()) fail_at("a whole number", found);
    return value;
  }
  /// The text behind the row, which it leaves.
  std::string_view behind_row() {
    end_line();
    is_in_row_ = false;
    return {at_, static_cast<size_t>(end_ - at_)};
  }
  int line() const { return line_; }  ///< of the row; at the end: how many there are, and one more
  [[noreturn]] void fail(std::string_view problem) const { throw InputError({path_, line_}, problem); }

 private:
  void end_line() {
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    if (at_ == end_) return;
    at_ += *at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n' ? 2 : 1;
    ++line_;
  }
  [[noreturn]] void fail_at(const char* wanted, std::string_view found) const {
    if (found.empty()) fail(fmt::format("expected {}, found the line's end", wanted));
    fail(fmt::format("expected {}, found '{}'", wanted, found.substr(0, 40)));
  }

  const std::string& path_;
  const char *at_, *end_;
  int line_;
  bool is_in_row_ = false;
};

}  // namespace rayfarm
