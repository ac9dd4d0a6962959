#include "common/description/formats/yaml_outline.h"

#include <algorithm>
#include <array>

namespace rayfarm {
namespace {

constexpr std::string_view kKeysOfLists[] = {"points", "normals", "triangles", "faces", "values"};

bool is_quote(char c) {
  return c == '"' || c == '\'';
}

/// Behind the last bracket of the sequence that begins at `begin`; 0 if it holds something else than numbers
/// and sequences of them.
size_t end_of_list(std::string_view text, size_t begin) {
  static constexpr auto kBelongs = [] {
    std::array<bool, 256> belongs{};
    for (const char c : std::string_view("0123456789+-.eE, \r\n")) belongs[static_cast<uint8_t>(c)] = true;
    return belongs;
  }();
  int depth = 0;
  for (size_t i = begin; i < text.size(); ++i) {
    const char c = text[i];
    if (kBelongs[static_cast<uint8_t>(c)]) continue;
    if (c == '[' && depth < 2) {
      ++depth;
    } else if (c == ']') {
      if (--depth == 0) return i + 1;
    } else {
      return 0;
    }
  }
  return 0;
}

/// True if the bracket at `at` follows one of the keys, a colon and space.
bool follows_key(std::string_view text, size_t at) {
  size_t end = at;
  while (end > 0 && (text[end - 1] == ' ' || text[end - 1] == '\n' || text[end - 1] == '\r')) --end;
  if (end == at || end == 0 || text[end - 1] != ':') return false;
  std::string_view before = text.substr(0, end - 1);
  if (!before.empty() && is_quote(before.back())) before.remove_suffix(1);
  return std::any_of(std::begin(kKeysOfLists), std::end(kKeysOfLists), [&](std::string_view key) {
    return before.ends_with(key) &&
           (before.size() == key.size() ||
            std::string_view(" \n{[,\"'").find(before[before.size() - key.size() - 1]) !=
                std::string_view::npos);
  });
}

/// True if what ends before `end` can't be a key: the library bounds the length of keys.
bool ends_value(std::string_view text, size_t end) {
  end = text.find_first_not_of(' ', end);
  return end == std::string_view::npos ||
         std::string_view(",]}\r\n#").find(text[end]) != std::string_view::npos;
}

}  // namespace

/// Goes through the text once. Where it takes something for a comment or for quoted that is not, because it
/// stands within a scalar, it errs until the line's end at most. A list there is read by nobody then, and
/// YamlOutline::is_read says so.
class YamlOutliner {
 public:
  YamlOutliner(std::string_view text, size_t least_bytes) : text_(text), least_bytes_(least_bytes) {}

  std::optional<YamlOutline> run() {
    while (at_ < text_.size())
      if (!step()) return std::nullopt;
    outline_.text_ += text_.substr(kept_);
    return std::move(outline_);
  }

 private:
  /// Goes on behind the next letter, comment, quoted scalar or list. False if the text is none to outline.
  bool step() {
    const char c = text_[at_];
    switch (c) {
      case '\n':
        ++at_;
        ++line_;
        line_begin_ = at_;
        outline_line_begin_ = outline_size();
        return true;
      case '\r':
        return ++at_ < text_.size() && text_[at_] == '\n';
      case '#':
        return skip_comment();
      case '"':
      case '\'':
        return skip_quoted();
      case '[':
        if (!leave_out_list()) ++at_;
        return true;
      default:
        ++at_;
        return c >= ' ' && c <= '~' && std::string_view("|>&*!%@`?").find(c) == std::string_view::npos;
    }
  }

  size_t outline_size() const { return outline_.text_.size() + (at_ - kept_); }

  bool skip_comment() {
    if (at_ != line_begin_ && text_[at_ - 1] != ' ') return false;
    return skip_to(std::min(text_.find('\n', at_), text_.size()));
  }

  /// A quoted scalar on one line, without escapes.
  bool skip_quoted() {
    const char quote = text_[at_];
    size_t before = at_;
    while (before > line_begin_ && text_[before - 1] == ' ') --before;
    const char indicator = before == line_begin_ ? ',' : text_[before - 1];
    const bool begins = std::string_view(",[{").find(indicator) != std::string_view::npos ||
                        ((indicator == ':' || indicator == '-') && before < at_);
    const size_t end = text_.find(quote, at_ + 1);
    if (!begins || end == std::string_view::npos) return false;
    if (end + 1 < text_.size() &&
        std::string_view(" :,]}\r\n").find(text_[end + 1]) == std::string_view::npos)
      return false;
    return text_.substr(at_, end - at_).find_first_of("\\\t\r\n") == std::string_view::npos &&
           skip_to(end + 1);
  }

  /// False if the library might not read on there, or not at all.
  bool skip_to(size_t end) {
    for (; at_ < end; ++at_) {
      const char c = text_[at_];
      const bool ends_line = c == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n';
      if ((static_cast<uint8_t>(c) < ' ' && c != '\t' && !ends_line) || c == '\x7f') return false;
    }
    return true;
  }

  bool leave_out_list() {
    if (!follows_key(text_, at_)) return false;
    const size_t end = end_of_list(text_, at_);
    if (end == 0 || end - at_ < least_bytes_ || !ends_value(text_, end)) return false;
    const YamlPlace begin{line_, static_cast<int>(outline_size() - outline_line_begin_)};
    const std::string_view inside = text_.substr(at_ + 1, end - at_ - 2);
    lines_left_out_ += static_cast<int>(std::count(inside.begin(), inside.end(), '\n'));
    if (const size_t feed = inside.rfind('\n'); feed != std::string_view::npos)
      line_begin_ = at_ + 1 + feed + 1;
    outline_.text_ += text_.substr(kept_, at_ + 1 - kept_);
    at_ = end;
    kept_ = end - 1;
    outline_.lists_.push_back({inside, begin, lines_left_out_, static_cast<int>(end - 1 - line_begin_)});
    return true;
  }

  std::string_view text_;
  size_t least_bytes_;
  size_t at_ = 0, kept_ = 0;  ///< what stands before `kept_` is in the outline, or left out
  size_t line_begin_ = 0, outline_line_begin_ = 0;
  int line_ = 0, lines_left_out_ = 0;  ///< of the outline
  YamlOutline outline_;
};

std::optional<std::string_view> YamlOutline::read_list(YamlPlace in_outline) {
  const auto list = std::lower_bound(lists_.begin(), lists_.end(), in_outline,
                                     [](const List& l, const YamlPlace& p) { return l.begin < p; });
  if (list == lists_.end() || list->begin != in_outline) return std::nullopt;
  list->is_read = true;
  return list->inside;
}

bool YamlOutline::is_read() const {
  return std::all_of(lists_.begin(), lists_.end(), [](const List& list) { return list.is_read; });
}

YamlPlace YamlOutline::place_in_text(YamlPlace in_outline) const {
  auto list = std::lower_bound(lists_.begin(), lists_.end(), in_outline,
                               [](const List& l, const YamlPlace& p) { return l.begin < p; });
  if (list == lists_.begin()) return in_outline;
  --list;
  const int behind = in_outline.column - list->begin.column - 1;  // its last bracket, where on its line
  return {in_outline.line + list->lines_left_out,
          in_outline.line == list->begin.line ? list->end_column + behind : in_outline.column};
}

std::optional<YamlOutline> outline_of(std::string_view text, size_t least_bytes) {
  return YamlOutliner(text, least_bytes).run();
}

}  // namespace rayfarm
