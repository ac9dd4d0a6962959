#pragma once
// How the view becomes a flat picture.
#include <array>
#include <cstdint>

namespace rayfarm {

enum class Projection : uint32_t {
  perspective,   ///< onto a plane, from a point or a lens (the thesis's 2.3.2)
  orthographic,  ///< onto a plane, by parallel rays
  panoramic,     ///< longitude across, latitude down, in equal steps: what maps of all directions are
  fisheye        ///< the angle from the direction of view grows evenly from the middle; a disk
};
inline constexpr std::array kProjectionWords{"perspective", "orthographic", "panoramic", "fisheye"};

/// The widest field of view, in degrees, and that which is meant if none is given.
constexpr double most_field_of_view(Projection projection) {
  return projection == Projection::perspective ? 180 : 360;
}
constexpr double usual_field_of_view(Projection projection) {
  return projection == Projection::panoramic ? 360 : projection == Projection::fisheye ? 180 : 45;
}

/// What becomes of the view's frame, which has the view's aspect, in a picture of another one.
enum class Fit : uint32_t {
  width,     ///< it is as wide as the picture: less is seen above and below, or more
  crop,      ///< it covers the picture: its sides, or its top and bottom, are cut off
  letterbox  ///< all of it is in the picture, between bars that are empty
};
inline constexpr std::array kFitWords{"width", "crop", "letterbox"};

}  // namespace rayfarm
