#pragma once
// Octrees that are built "dynamically during ray tracing" (Shirley, Sung and Brown 1991, 2.3.2): a node is
// divided when a ray first comes into it, by the rules of one that is built before, and so into the same
// cells; but where the limit on pointers ends the division, which cells it ends depends on the order of rays.
#include "common/scene/tracing_state.h"

namespace rayfarm {

/// To be called by a ray that has come into a node that was open; threads may do so at the same time. Returns
/// what it is now: divided, or a cell.
GrownNode::State enter_open_node(const Scene& scene, const Octree& octree, GrownOctree& grown,
                                 GrownNode& node);

}  // namespace rayfarm
