#include "common/scene/hierarchy_records.h"

#include <cmath>
#include <limits>

namespace rayfarm {

float round_down(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) > v ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float round_up(double v) {
  return -round_down(-v);
}

VolumeNode make_empty_node() {
  VolumeNode node;
  for (auto& axis : node.planes[0]) axis.fill(std::numeric_limits<float>::infinity());
  for (auto& axis : node.planes[1]) axis.fill(-std::numeric_limits<float>::infinity());
  node.children.fill({});
  return node;
}

void set_child(VolumeNode& node, size_t slot, const Box& box, ChildRef child) {
  const double margin = 1e-14 * box.magnitude();  // none of an empty box: it stays inverted
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    node.planes[0][axis][slot] = round_down(box.lo[i] - margin);
    node.planes[1][axis][slot] = round_up(box.hi[i] + margin);
  }
  node.children[slot] = child;
}

Box child_box(const VolumeNode& node, size_t slot) {
  return {Vec3(node.planes[0][0][slot], node.planes[0][1][slot], node.planes[0][2][slot]),
          Vec3(node.planes[1][0][slot], node.planes[1][1][slot], node.planes[1][2][slot])};
}

Box bounds_of(const VolumeNode& node) {
  Box box;
  for (size_t slot = 0; slot < 8; ++slot)
    if (node.children[slot].kind() != ChildKind::empty) box.grow(child_box(node, slot));
  return box;
}

}  // namespace rayfarm
