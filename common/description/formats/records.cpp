#include "common/description/formats/records.h"

#include <charconv>
#include <cmath>

namespace rayfarm {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t';
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
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

double Records::number() {
  const std::string_view found = word();
  const std::optional<double> value = parse_number(found);
  if (!value || !std::isfinite(*value))
    fail(fmt::format("expected a finite number, found '{}'", found.substr(0, 40)));
  return *value;
}

}  // namespace rayfarm
