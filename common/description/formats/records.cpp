#include "common/description/formats/records.h"

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

/// True if rounding the double to a float may not be rounding the number that was rounded to it: it stands
/// halfway between floats, or is so small that they have fewer bits.
bool is_undecided(double value) {
  constexpr uint64_t kBitsBelow = (uint64_t{1} << 29) - 1, kHalf = uint64_t{1} << 28;
  return (std::bit_cast<uint64_t>(value) & kBitsBelow) == kHalf ||
         std::abs(value) < std::numeric_limits<float>::min();
}

}  // namespace

bool Records::next() {
  while (begin_ < text_.size()) {
    if (line_ % 1024 == 0) throw_if_stopped(stop_);
    size_t end = begin_;
    while (end < text_.size() && text_[end] != '\n' && text_[end] != '\r') ++end;
    row_ = text_.substr(begin_, end - begin_);
    begin_ = end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n' ? end + 2 : end + 1;
    ++line_;
    at_ = 0;
    keyword_ = word();
    if (!keyword_.empty() && keyword_.front() != '#') return true;
  }
  return false;
}

std::string_view Records::peek() {
  while (at_ < row_.size() && is_space(row_[at_])) ++at_;
  size_t end = at_;
  while (end < row_.size() && !is_space(row_[end])) ++end;
  return row_.substr(at_, end - at_);
}

std::string_view Records::word() {
  const std::string_view taken = peek();
  column_ = static_cast<int>(at_) + 1;
  at_ += taken.size();
  return taken;
}

std::string_view Records::rest() {
  peek();
  column_ = static_cast<int>(at_) + 1;
  std::string_view taken = row_.substr(at_);
  while (!taken.empty() && is_space(taken.back())) taken.remove_suffix(1);
  at_ = row_.size();
  return taken;
}

bool Records::has_number() {
  const std::string_view found = peek();
  const size_t digit = found.find_first_not_of("+-.");
  return digit < 3 && std::isdigit(static_cast<unsigned char>(found[digit]));
}

std::optional<double> parse_number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range && is_tiny(word)) return word.starts_with('-') ? -0.0 : 0.0;
  return error == std::errc{} ? std::optional(value) : std::nullopt;
}

double Records::number() {
  const std::string_view found = word();
  const std::optional<double> value = parse_number(found);
  if (!value || !std::isfinite(*value))
    fail(fmt::format("expected a finite number, found '{}'", found.substr(0, 40)));
  return *value;
}

float Records::float_number() {
  const double value = number();
  auto rounded = static_cast<float>(value);
  if (!is_undecided(value)) return rounded;
  // Where it has no float either, the double's is right: 0 or infinite.
  const std::string_view text =
      without_plus(row_.substr(static_cast<size_t>(column_) - 1, at_ - static_cast<size_t>(column_) + 1));
  float exact = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), exact).ec == std::errc{}) rounded = exact;
  return rounded;
}

}  // namespace rayfarm
