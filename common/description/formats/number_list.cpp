#include "common/description/formats/number_list.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>

#include "common/description/formats/text_pieces.h"
#include "common/description/scene_description.h"

namespace rayfarm {
namespace {

bool ends_list(std::string_view text) {
  const size_t last = text.find_last_not_of(" \r\n");
  return last != std::string_view::npos && text[last] == ']';
}

/// A walk through the numbers, commas and brackets of a piece.
class Walk {
 public:
  explicit Walk(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) { skip_space(); }

  bool at_end() const { return at_ == end_; }
  bool take(char c) {
    if (at_end() || *at_ != c) return false;
    ++at_;
    skip_space();
    return true;
  }
  void require(char c) {
    if (!take(c)) fail();
  }
  double number() {
    const bool has_plus = !at_end() && *at_ == '+';
    const char* begin = at_ + (has_plus ? 1 : 0);
    if (has_plus && begin != end_ && *begin == '-') fail();
    double value = 0;
    const auto [behind, error] = std::from_chars(begin, end_, value);
    if (error != std::errc{} || !std::isfinite(value) || std::abs(value) > limits::kCoordinate) fail();
    at_ = behind;
    skip_space();
    return value;
  }
  [[noreturn]] static void fail() { throw InputError({}, "expected a list of numbers"); }

 private:
  void skip_space() {
    while (at_ != end_ &&
           (*at_ == ' ' || *at_ == '\n' || (*at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n')))
      ++at_;
  }
  const char *at_, *end_;
};

}  // namespace

NumberList::NumberList(std::string_view inside, std::stop_token stop, ReadProgress* progress)
    : stop_(std::move(stop)), progress_(progress) {
  const size_t begin = inside.find_first_not_of(" \r\n");
  if (begin == std::string_view::npos) return;
  is_nested_ = inside[begin] == '[';
  const auto begins_item = [this](std::string_view text, size_t at) {
    return text[at - 1] == ',' && (!is_nested_ || ends_list(text.substr(0, at - 1)));
  };
  for (const std::string_view text : cut_text(inside, borders_of_pieces(inside.size()), begins_item)) {
    pieces_.push_back({text, size_});
    size_ += static_cast<size_t>(std::count(text.begin(), text.end(), is_nested_ ? '[' : ','));
    // A comma may stand behind the last number, or not.
    if (!is_nested_ && text.find_last_not_of(" \r\n") != text.rfind(',')) ++size_;
  }
}

size_t NumberList::for_each(const Take& take) const {
  std::atomic<size_t> values = 0;
  parallel_for(pieces_.size(), [&](size_t piece) {
    throw_if_stopped(stop_);
    std::vector<double> numbers;
    size_t i = pieces_[piece].first_item, of_piece = 0;
    for (Walk walk(pieces_[piece].text); !walk.at_end();) {
      numbers.clear();
      if (is_nested_) {
        walk.require('[');
        while (!walk.take(']')) {
          numbers.push_back(walk.number());
          if (walk.take(']')) break;
          walk.require(',');
        }
        ++of_piece;
      } else {
        numbers.push_back(walk.number());
      }
      of_piece += numbers.size();
      take(piece, i++, numbers);
      if (!walk.at_end()) walk.require(',');
    }
    values += of_piece;
    count_read(progress_, pieces_[piece].text.size());
  });
  return values;
}

}  // namespace rayfarm
