#pragma once
// Keyframed curves. A curve travels inside the scene block once; every node evaluates it for each frame by
// itself, so nothing is sent between frames (thesis 4.4.4.2: "the updates between frames were sent with the
// initial data").
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine.h"

namespace rayfarm {

enum class Interpolation : uint32_t {
  linear,              ///< component by component
  spherical,           ///< directions: along the great circle, lengths are not kept
  spherical_rotation,  ///< unit quaternions (x, y, z, w): along the shorter arc
  step,                ///< the last key's value, until the next
  cubic,               ///< Hermite's polynomials, component by component: keys have tangents
  cubic_rotation       ///< the same of unit quaternions, and the result's direction
};

/// A key has one value, or with tangents three: the slope that the curve arrives with, in units a frame, the
/// value, and the slope that it leaves with.
inline size_t values_per_key(Interpolation interpolation) {
  return interpolation == Interpolation::cubic || interpolation == Interpolation::cubic_rotation ? 3 : 1;
}

/// A value that depends on the frame: constant before the first key and after the last.
struct Curve {
  Interpolation interpolation = Interpolation::linear;
  std::vector<double> frames;  ///< strictly increasing, at least one
  std::vector<Vec4> values;    ///< values_per_key for each frame; unused components are 0

  bool is_animated() const { return frames.size() > 1; }
};

inline Curve constant_curve(const Vec4& value) {
  return {Interpolation::linear, {0.0}, {value}};
}

/// The value at `frame` of the curve given by its keys. Shoemake, "Animating rotation with quaternion curves"
/// (1985).
Vec4 eval_curve(Interpolation interpolation, std::span<const double> frames, std::span<const Vec4> values,
                double frame);

enum class TransformKind : uint32_t { translate, scale, rotate, orient, matrix };

/// One step of an object's transform. `axis` is for rotate; `matrix` for matrix; the curve for all others:
/// translate xyz, scale xyz, rotate degrees in x, orient a quaternion.
struct TransformStep {
  TransformKind kind = TransformKind::translate;
  Curve curve;
  Vec3 axis{0, 1, 0};
  Affine matrix;
};

/// The transform of one step at a value of its curve.
Affine eval_transform(TransformKind kind, const Vec4& value, const Vec3& axis, const Affine& matrix);
/// What all steps come to at `frame`.
Affine eval_steps(std::span<const TransformStep> steps, double frame);

}  // namespace rayfarm
