#include "common/description/formats/yaml_curves.h"

#include <map>
#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

Vec4 quaternion(const Vec3& axis, double degrees) {
  const double half = degrees * (std::numbers::pi / 360);
  return {normalized(axis) * portable_sin(half), portable_cos(half)};
}

Vec4 read_number(const YamlValue& v) {
  return {v.number(), 0, 0, 0};
}
Vec4 read_scale(const YamlValue& v) {
  const Vec3 s = v.is_sequence() ? v.vector() : Vec3(v.number());
  if (s.x == 0 || s.y == 0 || s.z == 0) v.fail("a scale must not be 0: it would flatten the object");
  return {s, 0};
}
Vec4 read_orientation(const YamlValue& v) {
  YamlMap map(v);
  const Vec3 axis = map.require("axis").direction();
  const double degrees = map.require("degrees").number();
  map.finish();
  return quaternion(axis, degrees);
}

/// `{axis, degrees}`, or degrees about the axes x, y and z, in this order.
void add_rotation(const YamlValue& value, std::vector<TransformStep>& steps) {
  const bool is_about_axis = value.is_map() && (YamlMap(value).has("axis") || YamlMap(value).has("degrees"));
  if (is_about_axis) {
    YamlMap map(value);
    TransformStep step{TransformKind::rotate, {}, map.require("axis").direction(), {}};
    step.curve = read_curve(map.require("degrees"), Interpolation::linear, read_number);
    map.finish();
    steps.push_back(std::move(step));
    return;
  }
  const Curve degrees = read_curve(value, Interpolation::linear, [](const YamlValue& v) {
    if (!v.is_sequence())
      v.fail(
          "a rotation is `[x, y, z]`, degrees about the axes one after the other, or `{axis: [0, 1, 0], "
          "degrees: 90}`");
    return read_point(v);
  });
  for (int axis = 0; axis < 3; ++axis) {
    TransformStep step{TransformKind::rotate, degrees, Vec3(0), {}};
    step.axis[axis] = 1;
    for (Vec4& v : step.curve.values) v = Vec4(v[axis], 0, 0, 0);
    steps.push_back(std::move(step));
  }
}

Affine read_matrix(const YamlValue& v) {
  const std::vector<double> m = v.numbers();
  if (m.size() != 12 && m.size() != 16)
    v.fail("a matrix has 12 numbers (three rows of four) or 16 (four rows)");
  if (m.size() == 16 && (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1))
    v.fail("the last row of a matrix must be 0, 0, 0, 1: objects are moved without perspective");
  Affine a;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      a.linear[column][row] = m[static_cast<size_t>(4 * row + column)];
    a.translation[row] = m[static_cast<size_t>(4 * row + 3)];
  }
  if (glm::determinant(a.linear) == 0) v.fail("the matrix is singular: it would flatten the object");
  return a;
}

}  // namespace

Curve read_curve(const YamlValue& value, Interpolation interpolation,
                 const std::function<Vec4(const YamlValue&)>& read) {
  Curve curve;
  curve.interpolation = interpolation;
  if (!value.is_map()) {
    curve.frames = {0};
    curve.values = {read(value)};
    return curve;
  }
  std::map<double, Vec4> keys;
  for (const auto& [frame, v] : value.entries()) {
    const YamlValue& key = frame;
    double number = 0;
    try {
      number = key.number();
    } catch (const InputError&) {
      key.fail(fmt::format("{} is either one value or a map `frame: value`; '{}' is not a frame number",
                           value.what(), key.text().substr(0, 40)));
    }
    if (!keys.emplace(number, read(v)).second) key.fail(fmt::format("frame {} stands twice", number));
    if (keys.size() > limits::kKeys) key.fail("too many keys");
  }
  if (keys.empty()) value.fail(fmt::format("{} has no keys", value.what()));
  for (const auto& [frame, v] : keys) {
    curve.frames.push_back(frame);
    curve.values.push_back(v);
  }
  return curve;
}

Vec4 read_point(const YamlValue& v) {
  return {v.vector(), 0};
}
Vec4 read_direction(const YamlValue& v) {
  return {v.direction(), 0};
}
Vec4 read_truth(const YamlValue& v) {
  return {v.boolean() ? 1 : 0, 0, 0, 0};
}

std::vector<TransformStep> read_transform(const YamlValue& value) {
  std::vector<TransformStep> steps;
  const std::vector<YamlValue> items = value.is_sequence() ? value.items() : std::vector<YamlValue>{value};
  for (const YamlValue& item : items) {
    YamlMap map(item);
    int kinds = 0;
    for (const char* kind : {"translate", "scale", "rotate", "orient", "matrix"}) kinds += map.has(kind);
    if (auto v = map.find("translate"))
      steps.push_back({TransformKind::translate, read_curve(*v, Interpolation::linear, read_point), {}, {}});
    if (auto v = map.find("scale"))
      steps.push_back({TransformKind::scale, read_curve(*v, Interpolation::linear, read_scale), {}, {}});
    if (auto v = map.find("rotate")) {
      add_rotation(*v, steps);
    }
    if (auto v = map.find("orient")) {
      YamlMap probe(*v);
      const bool is_constant = probe.has("axis");
      steps.push_back({TransformKind::orient,
                       is_constant ? constant_curve(read_orientation(*v))
                                   : read_curve(*v, Interpolation::spherical_rotation, read_orientation),
                       {},
                       {}});
    }
    if (auto v = map.find("matrix"))
      steps.push_back({TransformKind::matrix, constant_curve(Vec4(0)), {}, read_matrix(*v)});
    map.finish();
    if (kinds != 1)
      item.fail(
          "each step of a transform is one of: translate, rotate, scale, orient, matrix; write a list of "
          "steps");
  }
  return steps;
}

}  // namespace rayfarm
