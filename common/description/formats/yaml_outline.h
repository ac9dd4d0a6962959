#pragma once
// A YAML text without the insides of its long lists of numbers. The library makes a node of several hundred
// bytes of each number; what has millions of them reads them from the text (number_list.h), and gives the
// library the rest.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rayfarm {

/// As the library counts, from 0.
struct YamlPlace {
  int line = 0, column = 0;
  friend auto operator<=>(const YamlPlace&, const YamlPlace&) = default;
};

class YamlOutline {
 public:
  const std::string& text() const { return text_; }
  bool is_empty() const { return lists_.empty(); }  ///< of lists

  /// What stands between the brackets of a list whose first bracket stands there in the outline, and takes
  /// note that somebody read it; nothing if there is no such list.
  std::optional<std::string_view> read_list(YamlPlace in_outline);
  /// True if every list was read: what nobody reads may not even be a list.
  bool is_read() const;
  /// Where in the whole text stands what stands there in the outline.
  YamlPlace place_in_text(YamlPlace in_outline) const;

 private:
  friend class YamlOutliner;
  struct List {
    std::string_view inside;
    YamlPlace begin;     ///< of its first bracket, in the outline; the last one follows
    int lines_left_out;  ///< by this list and those before it
    int end_column;      ///< of its last bracket, in the whole text
    bool is_read = false;
  };
  std::string text_;
  std::vector<List> lists_;  ///< in the order of the text
};

/// The outline of a text, which must outlive it: without the insides of flow sequences of `least_bytes` and
/// more that stand behind the keys of such lists (`points`, `normals`, `triangles`, `faces`, `values`) and
/// seem to hold numbers alone, or sequences of numbers. Nothing if the text has a letter outside comments
/// and quotes that gives what follows another meaning (block scalars, anchors, tags, tabs) or none of ASCII.
std::optional<YamlOutline> outline_of(std::string_view text, size_t least_bytes);

}  // namespace rayfarm
