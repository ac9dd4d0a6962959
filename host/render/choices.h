#pragma once
// What the options of a render leave open, the scene and the machine decide.
#include <vector>

#include "common/description/scene_description.h"
#include "common/scene/render_settings.h"
#include "common/scene/scene.h"
#include "host/render/render_options.h"

namespace rayfarm {

std::vector<FrameNumber> choose_frames(const RenderOptions& options, const SceneDescription& scene);

/// Throws JobError if the part to render is not inside of the image.
RenderSettings choose_settings(const RenderOptions& options, const SceneDescription& scene);

/// What a pixel weighs between two passes.
size_t running_bytes_of(const RenderSettings& settings);

/// What pixels of frames in the making may take on the host, beside `other_bytes` that are still to be taken:
/// what was asked for, or less where less is free. Without bound if the frames come in passes.
size_t choose_frame_bytes(const RenderOptions& options, size_t other_bytes);

/// Frames that are begun but not written: so many fit into `frame_bytes`, at most as many as are of use.
/// Throws JobError if what one takes at least is not free.
int choose_window(const RenderSettings& settings, const SubpolygonGrid& grid, size_t frame_bytes,
                  size_t other_bytes, int passes);

/// A picture that is larger than `frame_bytes` is cut into rows of subpolygons of which several fit, and
/// handed out on demand.
JobPlan make_plan(const RenderOptions& options, const RenderSettings& settings,
                  std::vector<FrameNumber> frames, int processors, size_t frame_bytes);

}  // namespace rayfarm
