#pragma once
// On which side of a line a point lies, without rounding: what decides about polygons must never contradict
// itself.
#include "common/math/vector.h"

namespace rayfarm {

/// 1 if a, b, c run counter-clockwise, -1 if clockwise, 0 if they lie on one line. Exact while products of
/// coordinates neither over- nor underflow. Source: Shewchuk, "Adaptive Precision Floating-Point Arithmetic
/// and Fast Robust Geometric Predicates", 1997.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

}  // namespace rayfarm
