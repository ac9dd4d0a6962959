#include "common/hierarchy/builder.h"

#include <algorithm>
#include <cmath>

namespace rayfarm {
namespace {

float round_down(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) > v ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float round_up(double v) {
  return -round_down(-v);
}

}  // namespace

PrimitiveReference make_reference(uint32_t primitive, const Box& box) {
  return {{round_down(box.lo.x), round_down(box.lo.y), round_down(box.lo.z)},
          primitive,
          {round_up(box.hi.x), round_up(box.hi.y), round_up(box.hi.z)},
          0};
}

ChildRef build_hierarchy(const PrimitiveSource& source, const BuildOptions& options,
                         const LeafMaker& make_leaf, std::vector<VolumeNode>& nodes) {
  if (source.size() == 0) return {};
  std::vector<PrimitiveReference> references(source.size());
  for (uint32_t i = 0; i < references.size(); ++i) {
    if (i % (1 << 16) == 0) throw_if_stopped(options.stop);
    references[i] = make_reference(i, source.bounds(i));
  }
  if (options.progress) options.progress->total += references.size();
  const auto build = options.rule == SplitRule::sah ? build_sah : build_thesis;
  return build(std::move(references), source, options, make_leaf, nodes);
}

VolumeNode make_empty_node() {
  VolumeNode node;
  for (auto& axis : node.planes[0]) axis.fill(std::numeric_limits<float>::infinity());
  for (auto& axis : node.planes[1]) axis.fill(-std::numeric_limits<float>::infinity());
  node.children.fill({});
  return node;
}

void set_child(VolumeNode& node, size_t slot, const Box& box, ChildRef child) {
  const double margin = 1e-14 * box.magnitude();
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
