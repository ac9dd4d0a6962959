#pragma once
// How the primitives of an object are arranged, in the YAML format.
#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// The name of a hierarchy, or `{name: {its options}}`.
StructureDescription read_structure(const YamlValue& value);

/// The bounding volumes of an object: a kind, several in the order of their tests, or `none`.
std::vector<BoundChoice> read_bound(const YamlValue& value);

}  // namespace rayfarm
