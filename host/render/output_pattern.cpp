#include "host/render/output_pattern.h"

#include <fmt/core.h>

#include <charconv>
#include <set>
#include <stdexcept>

namespace rayfarm {
namespace {

constexpr int kLargestFrame = 9'999'999;
constexpr size_t kMostFrames = 1'000'000;

int parse_number(std::string_view text, const std::string& whole) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0 || value > kLargestFrame)
    throw std::invalid_argument(
        fmt::format("'{}' in '{}' is not a frame number from 0 to {}; write frames as 1-10, 1-10x2 or 1,5,9",
                    text, whole, kLargestFrame));
  return value;
}

}  // namespace

std::vector<FrameNumber> parse_frames(const std::string& text) {
  std::vector<FrameNumber> frames;
  std::set<int> seen;
  size_t begin = 0;
  while (begin <= text.size()) {
    const size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view item(text.data() + begin, comma - begin);
    begin = comma + 1;
    const size_t dash = item.find('-'), times = item.find('x');
    int first = 0, last = 0, step = 1;
    if (dash == std::string_view::npos) {
      first = last = parse_number(item, text);
    } else {
      first = parse_number(item.substr(0, dash), text);
      last = parse_number(item.substr(dash + 1, times == std::string_view::npos ? times : times - dash - 1),
                          text);
      if (times != std::string_view::npos) step = parse_number(item.substr(times + 1), text);
      if (last < first)
        throw std::invalid_argument(fmt::format("'{}': the last frame comes before the first", item));
      if (step < 1) throw std::invalid_argument(fmt::format("'{}': the step must be at least 1", item));
    }
    for (int frame = first; frame <= last; frame += step) {
      if (!seen.insert(frame).second)
        throw std::invalid_argument(fmt::format("frame {} is named twice in '{}'", frame, text));
      frames.emplace_back(frame);
      if (frames.size() > kMostFrames)
        throw std::invalid_argument(fmt::format("'{}' names more than {} frames", text, kMostFrames));
    }
  }
  return frames;
}

bool has_frame_pattern(const std::string& path) {
  return path.find('#') != std::string::npos;
}

std::string file_of_frame(const std::string& path, FrameNumber frame) {
  const size_t last = path.rfind('#');
  if (last == std::string::npos) return path;
  size_t first = last;
  while (first > 0 && path[first - 1] == '#') --first;
  return path.substr(0, first) + fmt::format("{:0{}}", frame.value(), last - first + 1) +
         path.substr(last + 1);
}

}  // namespace rayfarm
