#include "common/hierarchy/builder.h"

namespace rayfarm {
PrimitiveReference make_reference(uint32_t primitive, const Box& box) {
  return {{round_down(box.lo.x), round_down(box.lo.y), round_down(box.lo.z)},
          primitive,
          {round_up(box.hi.x), round_up(box.hi.y), round_up(box.hi.z)},
          0};
}

ChildRef build_hierarchy(const PrimitiveSource& source, const BuildOptions& options,
                         const LeafMaker& make_leaf, LargeVector<VolumeNode>& nodes) {
  if (source.size() == 0) return {};
  LargeVector<PrimitiveReference> references(source.size());
  for (uint32_t i = 0; i < references.size(); ++i) {
    if (i % (1 << 16) == 0) throw_if_stopped(options.stop);
    references[i] = make_reference(i, source.bounds(i));
  }
  if (options.progress) options.progress->total += references.size();
  if (options.structure == Structure::list) return make_leaf(references);
  const auto build = options.rule == SplitRule::sah ? build_sah : build_thesis;
  return build(std::move(references), source, options, make_leaf, nodes);
}

}  // namespace rayfarm
