#pragma once
// Which frames share what was found for a pose.
#include "common/scene/scene.h"
#include "host/farm/farm_options.h"

namespace rayfarm {

/// True if something but the camera moves, comes or goes in some frame.
bool has_poses(const Scene& scene);

/// One group if nothing does, else each frame is one.
std::vector<FrameGroup> group_frames(const Scene& scene, size_t frames);

}  // namespace rayfarm
