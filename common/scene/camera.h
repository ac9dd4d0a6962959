#pragma once
// The view in one frame: the display polygon at distance one from the viewpoint (thesis 2.3.2, Equation 2.8),
// and other ways to see.
#include <optional>

#include "common/math/ray.h"
#include "common/scene/scene.h"

namespace rayfarm {

struct Camera {
  Vec3 location{0};
  /// Of a perspective view the direction to the image's top left corner; of an orthographic one where that
  /// corner is from the location.
  Vec3 top_left{0};
  Vec3 per_x{0}, per_y{0};  ///< its change per pixel to the right and down

  // The lens: what is `focus` away in the direction of view is sharp.
  Vec3 right{0}, up{0}, forward{0};  ///< unit
  double lens_radius = 0, focus = 1;

  Projection projection = Projection::perspective;
  double near = 0, far = std::numeric_limits<double>::infinity();
  // Of a panoramic view or a fisheye's: radians per pixel, the raster position of the direction of view, and
  // how far from it is seen.
  double radians_per_px = 0, most_radians = 0;
  Vec2 middle_px{0};
  Vec2 frame_begin_px{0}, frame_end_px{std::numeric_limits<double>::infinity()};  ///< nothing is seen outside

  /// Where a point is seen through the lens's middle, if it is.
  struct Projected {
    Vec2 raster{0};            ///< as ray() takes it
    double px_per_length = 0;  ///< of lengths across the view at the point's depth, at the most
  };
  std::optional<Projected> project(const Vec3& p) const;

  /// What a pixel's cone measures across where its ray starts, in the image's middle, and how much wider it
  /// gets with each unit of distance.
  double width() const {
    return projection == Projection::orthographic ? glm::length(per_x) : near * spread();
  }
  double spread() const {
    return projection == Projection::orthographic  ? 0
           : projection == Projection::perspective ? glm::length(per_x)
                                                   : radians_per_px;
  }
  bool has_lens() const { return lens_radius > 0; }
  /// True if all rays come from one point, through a plane, and end nowhere.
  bool is_pinhole() const {
    return projection == Projection::perspective && !has_lens() && near == 0 && std::isinf(far);
  }
  /// False if rays leave out parts of the raster.
  bool sees_all() const {
    return most_radians == 0 && frame_begin_px == Vec2(0) && std::isinf(frame_end_px.x);
  }
  bool sees(double x, double y) const;

  /// The eye ray through raster position (x, y) in pixels, of unit direction, and through the point of the
  /// unit disk that stands for the lens.
  Ray ray(double x, double y, const Vec2& lens = Vec2(0)) const;
};

/// The camera of `frame` for an image of width × height square pixels. Throws std::domain_error if the view
/// has no direction, or looks along its own up direction.
Camera make_camera(const Scene& scene, double frame, int width_px, int height_px, Fit fit = Fit::width);

}  // namespace rayfarm
