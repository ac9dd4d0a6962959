#pragma once
// What may move in the YAML format: curves and transforms. scenes/README.md is the manual.
#include <functional>

#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// A constant, or a map `frame: value`.
Curve read_curve(const YamlValue& value, Interpolation interpolation,
                 const std::function<Vec4(const YamlValue&)>& read);

Vec4 read_point(const YamlValue& value);
Vec4 read_direction(const YamlValue& value);
Vec4 read_truth(const YamlValue& value);  ///< true: x = 1

/// A step or a list of steps.
std::vector<TransformStep> read_transform(const YamlValue& value);

}  // namespace rayfarm
