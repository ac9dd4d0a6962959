#include "common/scene/animation.h"

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

Vec4 slerp(const Vec4& a, const Vec4& b, double t) {
  const double cosine = glm::dot(a, b);
  if (cosine > 1 - 1e-10) return a + t * (b - a);
  const double angle = portable_acos(cosine);
  const double sine = portable_sin(angle);
  if (sine < 1e-10) return t < 0.5 ? a : b;  // opposite directions: every great circle is as good
  return (portable_sin((1 - t) * angle) / sine) * a + (portable_sin(t * angle) / sine) * b;
}

Vec4 unit(const Vec4& v) {
  const double length = std::sqrt(glm::dot(v, v));
  return length > 0 ? v / length : v;
}

}  // namespace

Vec4 eval_curve(Interpolation interpolation, std::span<const double> frames, std::span<const Vec4> values,
                double frame) {
  const size_t per_key = values_per_key(interpolation), in_key = per_key / 2;
  if (frame <= frames.front()) return values[in_key];
  if (frame >= frames.back()) return values[values.size() - 1 - in_key];
  const auto next =
      static_cast<size_t>(std::upper_bound(frames.begin(), frames.end(), frame) - frames.begin());
  const double t = (frame - frames[next - 1]) / (frames[next] - frames[next - 1]);
  const Vec4 a = values[(next - 1) * per_key + in_key], b = values[next * per_key + in_key];
  switch (interpolation) {
    case Interpolation::step:
      return a;
    case Interpolation::linear:
      return a + t * (b - a);
    case Interpolation::spherical:
      return unit(slerp(unit(a), unit(b), t));
    case Interpolation::spherical_rotation:
      return unit(slerp(a, glm::dot(a, b) < 0 ? -b : b, t));
    case Interpolation::cubic:
    case Interpolation::cubic_rotation: {
      const double length = frames[next] - frames[next - 1];
      const Vec4 leaving = length * values[next * per_key - 1], arriving = length * values[next * per_key];
      const double square = t * t, rise = square * (3 - 2 * t);
      const Vec4 value = (1 - rise) * a + rise * b + t * (1 - t) * ((1 - t) * leaving - t * arriving);
      return interpolation == Interpolation::cubic ? value : unit(value);
    }
  }
  return a;
}

Affine eval_transform(TransformKind kind, const Vec4& value, const Vec3& axis, const Affine& matrix) {
  switch (kind) {
    case TransformKind::translate:
      return make_translation(Vec3(value));
    case TransformKind::scale:
      return make_scale(Vec3(value));
    case TransformKind::rotate:
      return make_rotation(axis, value.x);
    case TransformKind::orient:
      return make_rotation(value);
    case TransformKind::matrix:
      return matrix;
  }
  return matrix;
}

Affine eval_steps(std::span<const TransformStep> steps, double frame) {
  Affine all;
  for (const TransformStep& step : steps)
    all = eval_transform(step.kind,
                         eval_curve(step.curve.interpolation, step.curve.frames, step.curve.values, frame),
                         step.axis, step.matrix) *
          all;
  return all;
}

}  // namespace rayfarm
