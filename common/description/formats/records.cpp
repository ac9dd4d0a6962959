#include "common/description/formats/records.h"

#include <charconv>
#include <cmath>

namespace rayfarm {
namespace {

constexpr std::string_view kSpace = " \t";

}  // namespace

bool Records::next() {
  while (begin_ < text_.size()) {
    if (line_ % 1024 == 0) throw_if_stopped(stop_);
    const size_t end = std::min(text_.find_first_of("\r\n", begin_), text_.size());
    row_ = text_.substr(begin_, end - begin_);
    begin_ = text_.substr(end).starts_with("\r\n") ? end + 2 : end + 1;
    ++line_;
    at_ = 0;
    keyword_ = word();
    if (!keyword_.empty() && keyword_.front() != '#') return true;
  }
  return false;
}

std::string_view Records::peek() {
  at_ = std::min(row_.find_first_not_of(kSpace, at_), row_.size());
  return row_.substr(at_, std::min(row_.find_first_of(kSpace, at_), row_.size()) - at_);
}

bool Records::has_more() {
  return !peek().empty();
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
  const std::string_view taken = row_.substr(at_, row_.find_last_not_of(kSpace) + 1 - at_);
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
