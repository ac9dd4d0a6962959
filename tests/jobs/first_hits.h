#pragma once
// What a picture of a model is made of, pixel by pixel, for other programs to compare with what they find.
#include <optional>
#include <string>

#include "common/description/scene_description.h"

namespace rayfarm {

/// A perspective view that takes the place of the file's.
struct SimpleView {
  Vec3 location{0}, look_at{0};
  double field_of_view = 45;  ///< degrees, across
};

/// Prints a line for each pixel, from the top left on: what the ray through its centre first meets of the
/// model's triangles and faces, holes passed, by the very functions that pictures are made with. Fourteen
/// numbers: depth (along the direction of view, from the viewpoint), 1 if it is the front, the geometric
/// normal and the shading normal before maps tilt it (both on the viewer's side), the base colour (linear
/// Rec. 709) as the picture has it, filtered by what the pixel sees of textures, and the base colour without
/// that filter. `-` where there is nothing; ground and lamp of a model that has none are nothing.
void print_first_hits(SceneDescription& scene, int frame, int width_px, int height_px,
                      const std::optional<SimpleView>& view);

}  // namespace rayfarm
