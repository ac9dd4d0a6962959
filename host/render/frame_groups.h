#pragma once
// Which frames share what was found for a pose.
#include "common/hierarchy/frame_state.h"
#include "host/farm/farm_options.h"

namespace rayfarm {

/// One group if nothing does, else each frame is one.
std::vector<FrameGroup> group_frames(const Scene& scene, size_t frames);

}  // namespace rayfarm
