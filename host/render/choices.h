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

/// Names what the picture leaves of the subpolygons asked for, if anything is missing.
std::vector<std::string> name_limits(const RenderOptions& options, const SubpolygonGrid& grid,
                                     int processors);

/// Names options that do nothing beside others. `is_one_process`: host and nodes share it.
std::vector<std::string> name_idle_options(const RenderOptions& options, bool is_one_process);
/// Names those that could do something, but not in this scene.
std::vector<std::string> name_idle_options(const RenderSettings& settings, const SceneDescription& scene);
/// One note if frames that are asked for lie outside of the scene's. Throws as choose_frames.
std::vector<std::string> name_frames_outside(const RenderOptions& options, const SceneDescription& scene);

/// What becomes of the view in a picture of another aspect, if nobody chose it.
std::vector<std::string> name_fit(const RenderOptions& options, const RenderSettings& settings,
                                  const ViewDescription& view);

/// What in the scene does not hold to what SelfHit::medium asks for: closed bodies. `open_objects`: see
/// find_open_objects.
std::vector<std::string> name_open_objects(const RenderSettings& settings, const SceneDescription& scene,
                                           std::span<const uint32_t> open_objects);

/// Why item buffers that were asked for do nothing, or not for all lights.
std::vector<std::string> name_idle_items(const RenderSettings& settings, const Scene& scene);

/// What the scene asks for in vain from the chosen lighting model.
std::vector<std::string> name_idle_shading(const RenderSettings& settings, const Scene& scene);

/// The same of spectra of the scene that the colour model does without.
std::vector<std::string> name_idle_spectra(const RenderSettings& settings, const Scene& scene);

}  // namespace rayfarm
