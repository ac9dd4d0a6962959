#pragma once
// What the readers of YAML values share: the scene that a document joins, what its names stand for, and what
// is wrong so far.
#include <fmt/core.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// Problems of several places, told together: what is wrong at one item does not hide what is wrong at the
/// next.
class YamlProblems {
 public:
  /// Calls `step`, and keeps the InputError that it throws. Throws all that there are once they are too many.
  template <typename Step>
  void keep(Step step) {
    try {
      step();
    } catch (const InputError& e) {
      if (is_full()) throw;  // all of them are on their way
      add(e);
    }
  }
  /// Throws them, if there are any, as one InputError with a line for each.
  void throw_if_any() const;

 private:
  static constexpr size_t kMost = 20;
  bool is_full() const { return lines_.size() >= kMost; }
  void add(const InputError& e);
  std::vector<std::string> lines_;
};

/// A kind of things that documents name: textures, materials or objects.
class YamlNames {
 public:
  explicit YamlNames(std::string kind) : kind_(std::move(kind)) {}

  /// Throws InputError if the name is taken.
  void define(const YamlValue& key, uint32_t id);
  /// The id of what the value names. `otherwise`: what else could stand here.
  uint32_t find(const YamlValue& value, const std::string& otherwise = "") const;
  /// The same, or of what a map describes in place of a name: `make(its name)` makes that, once for an anchor
  /// and its aliases.
  template <typename Make>
  uint32_t find_or_make(const YamlValue& value, Make make, const std::string& otherwise = "") {
    if (!value.is_map()) return find(value, otherwise);
    const Place place = value.place();
    const auto [found, is_new] = in_place_.try_emplace(
        {place.file, static_cast<uint32_t>(place.line), static_cast<uint32_t>(place.column)}, 0);
    if (is_new) found->second = make(fmt::format("line {}", place.line));
    return found->second;
  }

 private:
  std::string kind_;
  std::map<std::string, uint32_t, std::less<>> ids_;
  std::vector<std::string> names_;  ///< in the order of their definitions
  std::map<std::array<uint32_t, 3>, uint32_t> in_place_;
};

/// What all documents of a scene have in common.
struct YamlScene {
  SceneDescription description;
  YamlNames textures{"texture"}, materials{"material"}, objects{"object"};
  std::map<std::string, uint32_t> part_files;  ///< objects, by path
  /// Objects by path, material, smoothing, crease, whether the material replaces the file's, and size of
  /// zones.
  std::map<std::tuple<std::string, uint32_t, std::optional<Smoothing>, double, bool, float>, uint32_t>
      mesh_files;
  /// Copies of materials, by material and size of zones.
  std::map<std::pair<uint32_t, float>, uint32_t> zoned_materials;
  YamlProblems problems;
};

/// What to do about a text of which the YAML library says `problem` at `line` (from 0), where that tells less
/// than the lines up to there do; empty, or "; " and the advice.
std::string advice_on_yaml(std::string_view text, int line, std::string_view problem);

/// A document of a scene while it is read.
struct YamlDocument {
  YamlScene& shared;
  std::string folder;  ///< of the document: the files that it names are relative to it
  SceneDescription& scene() const { return shared.description; }
  std::string path_of(const YamlValue& file) const;
};

}  // namespace rayfarm
