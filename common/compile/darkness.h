#pragma once
// Why pictures of a scene without fault may be black.
#include <optional>

#include "common/description/scene_description.h"
#include "common/scene/render_settings.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Where sources come from that the object tree holds, in the order of the scene's lights.
struct LightPlaces {
  std::vector<Place> in_objects;  ///< those of lights that stand after the listed ones
  std::vector<Place> luminaires;
};

/// Notes lamps and spots that shine at nothing, and a scene that nothing lights.
void add_notes_of_darkness(const SceneDescription& description, const Scene& scene, const LightPlaces& places,
                           Notes& notes);

/// True if nothing that the lighting model takes light from shines: pictures are black, whatever they show.
bool is_dark(const Scene& scene, const RenderSettings& settings);

/// What to say if the camera of `frame` sees no object; nothing if it sees any, or may. `frame` is the
/// scene's first. Throws std::domain_error if there is no such view.
std::optional<std::string> nothing_in_view(const Scene& scene, double frame, int width_px, int height_px);

}  // namespace rayfarm
