#include "common/math/affine.h"

#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {

Affine make_rotation(const Vec4& q) {
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  Affine a;
  a.linear[0] = Vec3(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w));
  a.linear[1] = Vec3(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w));
  a.linear[2] = Vec3(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y));
  return a;
}

Affine make_rotation(const Vec3& axis, double degrees) {
  const double half = degrees * (std::numbers::pi / 360);
  return make_rotation(Vec4(normalized(axis) * portable_sin(half), portable_cos(half)));
}

Box transform(const Affine& a, const Box& box) {
  Box result;
  if (box.is_empty()) return result;
  for (int corner = 0; corner < 8; ++corner)
    result.grow(a.point(Vec3(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                             corner & 4 ? box.hi.z : box.lo.z)));
  return result;
}

}  // namespace rayfarm
