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

/// Frames that are begun but not written: so many fit into memory beside `other_bytes` that are still to be
/// taken, at most as many as are of use. Throws JobError if not even one does.
int choose_window(const RenderSettings& settings, size_t frames, int subpolygons, size_t other_bytes,
                  int passes = 1);

JobPlan make_plan(const RenderOptions& options, const RenderSettings& settings,
                  std::vector<FrameNumber> frames, int processors);

}  // namespace rayfarm
