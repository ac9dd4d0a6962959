#pragma once
// Typed, checked access to a YAML document: every value that is wrong ends in an InputError at its place, and
// every key that nobody asked for is an error with a suggestion.
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "common/description/formats/number_list.h"
#include "common/description/formats/yaml_outline.h"
#include "common/description/scene_description.h"

namespace rayfarm {

/// Bounds how much of a document is visited, so that anchors that multiply can't take for ever, and for how
/// long.
struct YamlBudget {
  uint32_t file = 0;  ///< the document, of SceneDescription::files
  size_t nodes_left = 50'000'000;
  std::stop_token stop;
  ReadProgress* progress = nullptr;
  YamlOutline* outline = nullptr;  ///< what the document was made of, if lists of numbers are read apart
  /// The first long list of numbers that could not be read apart.
  struct SlowList {
    Place place;
    size_t items;
  };
  std::optional<SlowList> slow_list{};
};

/// A YAML node with the name of its file and of what it stands for. Whatever makes one throws Stopped.
class YamlValue {
 public:
  YamlValue(const YAML::Node& node, std::string what, const std::string& file, YamlBudget& budget);

  [[noreturn]] void fail(const std::string& problem) const;
  /// Fails because none of `names` is meant; `otherwise` may say what else can stand here.
  [[noreturn]] void fail_unknown(const std::string& kind, const std::vector<std::string>& names,
                                 const std::string& otherwise = "") const;
  Place place() const;
  const std::string& what() const { return what_; }
  const std::stop_token& stop() const { return budget_->stop; }
  bool is_map() const { return node_.IsMap(); }
  bool is_sequence() const { return node_.IsSequence(); }

  double number() const;  ///< finite and of a sane size
  double number_in(double least, double most) const;
  int whole_number_in(int least, int most) const;
  std::string text() const;
  bool boolean() const;
  Vec3 vector() const;
  Vec3 direction() const;  ///< a vector that isn't zero
  Color color() const;     ///< three numbers >= 0, or one for grey
  std::vector<double> numbers() const;
  /// The index of the text in `choices`.
  size_t choice(const std::vector<std::string>& choices) const;

  std::vector<YamlValue> items() const;
  /// The items of a list of numbers, or of lists of them, that is read apart: for `take_all`. Nothing if it
  /// is as others are.
  std::optional<NumberList> items_apart() const;
  /// Hands all of them to `take`, and counts them.
  void take_all(const NumberList& list, const NumberList::Take& take) const;
  /// The entries of a map in the file's order: key and value.
  std::vector<std::pair<YamlValue, YamlValue>> entries() const;

 private:
  std::optional<NumberList> list_apart() const;
  YamlPlace place_in_document() const { return {node_.Mark().line, node_.Mark().column}; }

  YAML::Node node_;
  YamlPlace place_;  ///< in the file
  std::string what_;
  const std::string* file_;
  YamlBudget* budget_;
};

/// A map whose keys are all known: construct it, ask for keys, then call `finish`.
class YamlMap {
 public:
  explicit YamlMap(const YamlValue& value);
  const YamlValue& value() const { return value_; }
  bool has(const std::string& key);
  YamlValue require(const std::string& key);
  std::optional<YamlValue> find(const std::string& key);
  /// Throws if the key is there, which means something elsewhere; `advice` says what is written here.
  void refuse(const std::string& key, const std::string& advice) const;
  /// These keys may be there, as if they had been asked for.
  void know(std::initializer_list<const char*> keys);
  /// Throws at the first key that is not known.
  void finish() const;

 private:
  YamlValue value_;
  std::vector<std::pair<YamlValue, YamlValue>> entries_;
  std::vector<std::string> names_, known_;
};

}  // namespace rayfarm
