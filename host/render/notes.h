#pragma once
// What is said before a render begins: options and parts of the scene that do nothing, and what becomes of
// the view.
#include "host/farm/farm_options.h"
#include "host/render/choices.h"

namespace rayfarm {

/// Names what the picture leaves of the subpolygons asked for, if anything is missing.
std::vector<std::string> name_limits(const RenderOptions& options, const SubpolygonGrid& grid,
                                     int processors);

/// What becomes of a picture that is larger than the memory that it may take on the host.
std::vector<std::string> name_streaming(const RenderOptions& options, const FarmHostOptions& job);

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
