#pragma once
// The view in one frame: the display polygon at distance one from the viewpoint (thesis 2.3.2, Equation 2.8).
#include <optional>

#include "common/math/ray.h"
#include "common/scene/scene.h"

namespace rayfarm {

struct Camera {
  Vec3 location{0};
  Vec3 top_left{0};         ///< direction to the image's top left corner
  Vec3 per_x{0}, per_y{0};  ///< direction change per pixel to the right and down

  // The lens: what is `focus` away in the direction of view is sharp.
  Vec3 right{0}, up{0};  ///< unit
  double lens_radius = 0, focus = 1;

  /// Where a point is seen through the lens's middle, if it lies before it.
  struct Projection {
    Vec2 raster{0};            ///< as ray() takes it
    double px_per_length = 0;  ///< of lengths across the view at the point's depth
  };
  std::optional<Projection> project(const Vec3& p) const {
    const Vec3 v = p - location, forward = glm::cross(up, right);
    const double depth = glm::dot(v, forward);
    if (!(depth > 0)) return std::nullopt;
    const Vec3 offset = v / depth - top_left;
    return Projection{
        {glm::dot(offset, per_x) / glm::dot(per_x, per_x), glm::dot(offset, per_y) / glm::dot(per_y, per_y)},
        1 / (depth * glm::length(per_x))};
  }

  /// How much wider a pixel is with each unit of distance, in the image's middle.
  double spread() const { return glm::length(per_x); }
  bool has_lens() const { return lens_radius > 0; }
  /// The eye ray through a point of the unit disk that stands for the lens.
  Ray ray(double x, double y, const Vec2& lens) const {
    const Vec3 offset = lens_radius * (lens.x * right + lens.y * up);
    return {location + offset, normalized(focus * (top_left + x * per_x + y * per_y) - offset)};
  }
  /// The eye ray through raster position (x, y) in pixels, of unit direction.
  Ray ray(double x, double y) const { return {location, normalized(top_left + x * per_x + y * per_y)}; }
};

/// The camera of `frame` for an image of width × height square pixels. The field of view spans the width.
/// Throws std::domain_error if the view has no direction, or looks along its own up direction.
Camera make_camera(const Scene& scene, double frame, int width_px, int height_px);

}  // namespace rayfarm
