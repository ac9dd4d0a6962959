#pragma once
// Objects smaller than a pixel, which rays could meet in one frame and miss in the next (thesis 2.3.2).
#include <vector>

#include "common/hierarchy/frame_state.h"
#include "common/scene/camera.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

/// A small object in one of the pixels that it touches.
struct SmallObject {
  int x = 0, y = 0;  ///< the pixel
  Vec2 center{0};    ///< in raster coordinates: where a ray meets the object, if nothing is before it
};

/// Spheres, quadrics and polygons whose bounding sphere is narrower than a pixel, by (y, x, center). A mesh's
/// triangles are parts of a larger object.
std::vector<SmallObject> find_small_objects(const Scene& scene, const Pose& pose, const Camera& camera,
                                            const PixelRect& crop);

}  // namespace rayfarm
