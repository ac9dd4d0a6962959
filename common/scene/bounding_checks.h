#pragma once
#include "common/scene/scene.h"

namespace rayfarm {

/// Throws for trees of bounding volumes that a traverser could not walk. Parts, collections and instances are
/// whole.
void check_bounding_trees(const Scene& s);

}  // namespace rayfarm
