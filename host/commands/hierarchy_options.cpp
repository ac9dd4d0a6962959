#include "host/commands/hierarchy_options.h"

namespace rayfarm {

void add_hierarchy_options(Options& options, BuildOptions& build) {
  options.choice<Hierarchy>(
      "--hierarchy", build.hierarchy,
      {{"sah", Hierarchy::sah},
       {"thesis", Hierarchy::thesis},
       {"regular", Hierarchy::regular},
       {"brute", Hierarchy::brute}},
      "how primitives are arranged: volumes that are split by the surface area heuristic "
      "(sah), or about the centre of the data (thesis); equal cells (regular); not at all "
      "(brute); pictures are the same (default: sah)");
  options.number("--max-primitives", build.max_primitives, 1, 1000,
                 "in a leaf of sah or thesis (default: 8)");
  options.choice<BuildQuality>(
      "--build", build.quality,
      {{"fast", BuildQuality::fast}, {"balanced", BuildQuality::balanced}, {"high", BuildQuality::high}},
      "of sah: fast leaves primitives whole; balanced divides large ones among volumes where that pays, up "
      "to 1.3 "
      "references a primitive on average, high up to 2 (default: balanced)");
  options.number("--cells", build.cells, 0, kMostCells,
                 "of regular: along each axis; 0: four cells for each primitive (default: 0)");
}

}  // namespace rayfarm
