#pragma once
#include "common/hierarchy/builder.h"

namespace rayfarm {

/// Clips large primitives that fill their boxes badly, a long wall askew to the axes, before the tree is
/// built (Karras, Aila 2013, section 4): each at the most important of the planes that halve the scene's box
/// again and again.
/// Each piece is a reference of its own. Throws Stopped.
void clip_large(LargeVector<PrimitiveReference>& references, const PrimitiveSource& source,
                const std::stop_token& stop);

}  // namespace rayfarm
