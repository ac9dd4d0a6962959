#pragma once
// Shapes of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// A shape by its key in a node.
struct YamlShape {
  const char* key;
  /// What the key's value describes: a box is six polygons.
  std::vector<Shape> (*read)(const YamlValue& value);
};

/// All that need no file.
std::span<const YamlShape> yaml_shapes();

/// The key `smooth`, or `fallback`.
Smoothing read_smoothing(YamlMap& map, Smoothing fallback);

}  // namespace rayfarm
