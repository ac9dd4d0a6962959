#include "common/hierarchy/builder.h"

#include "common/parallel/parallel_for.h"

namespace rayfarm {
PrimitiveReference make_reference(uint32_t primitive, const Box& box) {
  return {{round_down(box.lo.x), round_down(box.lo.y), round_down(box.lo.z)},
          primitive,
          {round_up(box.hi.x), round_up(box.hi.y), round_up(box.hi.z)},
          0};
}

void PrimitiveSource::chop(uint32_t primitive, const Slabs& slabs, size_t first, size_t last,
                           Bounds* pieces) const {
  const PrimitiveReference whole = make_reference(primitive, bounds(primitive));
  for (size_t i = first; i <= last; ++i) {
    PrimitiveReference piece = whole;
    piece.lo[slabs.axis] = std::max(piece.lo[slabs.axis], slabs.plane(i));
    piece.hi[slabs.axis] = std::min(piece.hi[slabs.axis], slabs.plane(i + 1));
    pieces[i].grow(piece.lo.data(), piece.hi.data());
  }
}

LargeVector<PrimitiveReference> make_references(const PrimitiveSource& source, const BuildOptions& options) {
  LargeVector<PrimitiveReference> references(source.size());
  constexpr size_t kPiece = 1 << 14;
  parallel_for((references.size() + kPiece - 1) / kPiece, [&](size_t piece) {
    throw_if_stopped(options.stop);
    const size_t end = std::min(references.size(), (piece + 1) * kPiece);
    for (size_t i = piece * kPiece; i < end; ++i)
      references[i] = make_reference(static_cast<uint32_t>(i), source.bounds(static_cast<uint32_t>(i)));
  });
  return references;
}

ChildRef build_hierarchy(const PrimitiveSource& source, const BuildOptions& options,
                         const LeafMaker& make_leaf, LargeVector<VolumeNode>& nodes) {
  if (source.size() == 0) return {};
  LargeVector<PrimitiveReference> references = make_references(source, options);
  if (options.progress) options.progress->total += references.size();
  const auto build = options.hierarchy == Hierarchy::thesis ? build_thesis : build_sah;
  return build(std::move(references), source, options, make_leaf, nodes);
}

}  // namespace rayfarm
