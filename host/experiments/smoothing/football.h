#pragma once
// A ball of twelve pentagons and twenty hexagons (a truncated icosahedron): a mesh of polygons of more than
// four edges, where the thesis expects the effects of smooth shading to be most apparent (2.3.5).
#include "common/description/scene_description.h"

namespace rayfarm {

/// Of radius 1 about the origin, with the average of the polygons' normals at each node.
MeshShape make_football(Smoothing smoothing);

}  // namespace rayfarm
