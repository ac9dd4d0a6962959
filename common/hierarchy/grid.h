#pragma once
// Grids of equal cells (thesis 2.6.2; Ullner 1983; Cleary, Wyvill, Birtwistle and Vatti 1983): "an array of
// pointers"; a full cell has the list of the primitives with a part in it.
#include "common/hierarchy/builder.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Appends a grid over the primitives of `source`, of which `pointers` has the names, to `arrays`; returns
/// its index. options.cells are at most kMostCells. Throws Stopped.
uint32_t build_grid(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
                    const BuildOptions& options, SceneArrays<GrowingArray>& arrays);

}  // namespace rayfarm
