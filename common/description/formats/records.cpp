#include "common/description/formats/records.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

namespace rayfarm {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

std::string_view without_plus(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  return word;
}

/// Where an exponent stands whose sign is before its letter (3.1+e2); else the word's beginning, 0.
size_t stray_exponent(std::string_view word) {
  const size_t sign = word.find_last_of("+-");
  if (sign == std::string_view::npos || sign + 2 >= word.size()) return 0;
  const bool is_exponent = (word[sign + 1] == 'e' || word[sign + 1] == 'E') &&
                           word.find_first_not_of("0123456789", sign + 2) == std::string_view::npos;
  return is_exponent ? sign : 0;
}

/// True if a number that no double holds is too small for one, not too large.
bool is_tiny(std::string_view word) {
  const size_t e = std::min(word.find_first_of("eE"), word.size());
  const std::string_view digits = word.substr(0, e);
  const size_t first = std::min(digits.find_first_of("123456789"), e), point = std::min(digits.find('.'), e);
  std::string_view text = word.substr(std::min(e + 1, word.size()));
  if (text.starts_with('+')) text.remove_prefix(1);
  int64_t exponent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  if (error == std::errc::result_out_of_range) return text.starts_with('-');
  return exponent < static_cast<int64_t>(first) - static_cast<int64_t>(point);
}

/// The value of a decimal fraction without an exponent whose digits are a whole number that a double holds,
/// as are most in files: dividing it by a power of ten that is exact too rounds once (Clinger 1990).
std::optional<double> plain_decimal(std::string_view word) {
  constexpr std::array<double, 23> kPowers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                           1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                           1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr size_t kMostBytes = 18;  // so many digits do not overflow
  const bool is_negative = word.starts_with('-');
  if (is_negative) word.remove_prefix(1);
  if (word.size() > kMostBytes) return std::nullopt;
  uint64_t digits = 0;
  size_t point = word.size();
  for (size_t i = 0; i < word.size(); ++i) {
    const auto digit = static_cast<unsigned char>(word[i] - '0');
    if (digit < 10)
      digits = 10 * digits + digit;
    else if (word[i] == '.' && point == word.size())
      point = i;
    else
      return std::nullopt;
  }
  const bool has_point = point < word.size();
  if (word.size() == (has_point ? 1 : 0) || digits > uint64_t{1} << 53) return std::nullopt;
  const double value = static_cast<double>(digits) / kPowers[has_point ? word.size() - point - 1 : 0];
  return is_negative ? -value : value;
}

/// True if rounding the double to a float may not be rounding the number that was rounded to it: it stands
/// halfway between floats, or is so small that they have fewer bits.
bool is_undecided(double value) {
  constexpr uint64_t kBitsBelow = (uint64_t{1} << 29) - 1, kHalf = uint64_t{1} << 28;
  return (std::bit_cast<uint64_t>(value) & kBitsBelow) == kHalf ||
         std::abs(value) < std::numeric_limits<float>::min();
}

}  // namespace

bool may_begin_record(std::string_view text, size_t at) {
  if (at == 0) return true;
  size_t end = at - 1;  // of the line before
  if (text[end] == '\r' ? text[at] == '\n' : text[end] != '\n') return false;
  if (text[end] == '\n' && end > 0 && text[end - 1] == '\r') --end;
  return end == 0 || text[end - 1] != '\\';
}

size_t Records::end_of_line(size_t at) {
  // A file without line feeds is searched for them once.
  if (feed_ < at || at == 0) feed_ = std::min(text_.find('\n', at), text_.size());
  return std::min(text_.substr(at, feed_ - at).find('\r'), feed_ - at) + at;
}

size_t Records::next_line(size_t end) const {
  return end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n' ? end + 2 : end + 1;
}

bool Records::next() {
  while (begin_ < text_.size()) {
    if (looks_++ % 1024 == 0) throw_if_stopped(stop_);
    size_t end = end_of_line(begin_);
    line_ = ++end_line_;
    row_ = text_.substr(begin_, end - begin_);
    is_long_ = false;
    at_ = 0;
    if (!row_.empty() && row_.back() == '\\' && !peek().starts_with('#')) {
      is_long_ = true;
      while (end < text_.size() && text_[end - 1] == '\\' && next_line(end) < text_.size()) {
        if (looks_++ % 1024 == 0) throw_if_stopped(stop_);
        end = end_of_line(next_line(end));
        ++end_line_;
      }
      row_ = text_.substr(begin_, end - begin_);
    }
    begin_ = next_line(end);
    keyword_ = word();
    if (!keyword_.empty() && keyword_.front() != '#') return true;
  }
  return false;
}

bool Records::is_space_at(size_t at) const {
  const char c = row_[at];
  if (is_space(c) || !is_long_) return is_space(c);
  if (c == '\n' || c == '\r') return true;
  return c == '\\' && (at + 1 == row_.size() || row_[at + 1] == '\n' || row_[at + 1] == '\r');
}

std::string_view Records::peek() {
  while (at_ < row_.size() && is_space_at(at_)) ++at_;
  size_t end = at_;
  while (end < row_.size() && !is_space_at(end)) ++end;
  return row_.substr(at_, end - at_);
}

std::string_view Records::word() {
  const std::string_view taken = peek();
  taken_ = at_;
  at_ += taken.size();
  return taken;
}

std::string Records::rest() {
  peek();
  taken_ = at_;
  std::string text;
  for (size_t at = at_; at < row_.size(); ++at) text += is_long_ && is_space_at(at) ? ' ' : row_[at];
  while (!text.empty() && is_space(text.back())) text.pop_back();
  at_ = row_.size();
  return text;
}

SourcePlace Records::place() const {
  SourcePlace place{path_, line_, static_cast<int>(taken_) + 1};
  for (size_t at = 0; is_long_ && at < taken_; ++at) {
    const bool is_end =
        row_[at] == '\n' || (row_[at] == '\r' && (at + 1 == row_.size() || row_[at + 1] != '\n'));
    if (!is_end) continue;
    ++place.line;
    place.column = static_cast<int>(taken_ - at);
  }
  return place;
}

bool Records::has_number() {
  const std::string_view found = peek();
  const size_t digit = found.find_first_not_of("+-.");
  return digit < 3 && std::isdigit(static_cast<unsigned char>(found[digit]));
}

std::optional<double> parse_number(std::string_view word) {
  word = without_plus(word);
  if (const std::optional<double> plain = plain_decimal(word)) return plain;
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range && is_tiny(word)) return word.starts_with('-') ? -0.0 : 0.0;
  return error == std::errc{} ? std::optional(value) : std::nullopt;
}

double Records::number() {
  const std::string_view found = word();
  std::optional<double> value = parse_number(found);
  if (!value) {
    value = parse_number(found.substr(0, stray_exponent(found)));
    has_stray_exponent_ = value.has_value();
  }
  if (!value || !std::isfinite(*value))
    fail(fmt::format("expected a finite number, found '{}'", found.substr(0, 40)));
  return *value;
}

float Records::float_number() {
  const double value = number();
  auto rounded = static_cast<float>(value);
  if (!is_undecided(value)) return rounded;
  // Where it has no float either, the double's is right: 0 or infinite.
  const std::string_view text = without_plus(row_.substr(taken_, at_ - taken_));
  float exact = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), exact).ec == std::errc{}) rounded = exact;
  return rounded;
}

}  // namespace rayfarm
