#pragma once
// Weighting functions of pixels, sampled by importance (Shirley, Sung and Brown 1991, section 2.2.2): a pixel
// needs none of its neighbours' samples, so pictures don't depend on how they are cut.
#include <cstdint>
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

enum class FilterKind : uint8_t { box, tent, gaussian, mitchell };

class PixelFilter {
 public:
  explicit PixelFilter(FilterKind kind);

  struct Place {
    Vec2 offset;    ///< from the pixel's centre, in pixels
    double weight;  ///< of the sample; the mean over all samples is 1
  };
  Place sample(const Vec2& u) const;

  /// The filter's value at an offset along one axis; the filter is the product of both axes' values, and its
  /// integral is 1.
  double value(double offset) const;
  double radius() const { return radius_; }  ///< it is 0 beyond

 private:
  double sample_axis(double u) const;

  FilterKind kind_;
  double radius_ = 0.5;
  std::vector<double> cumulative_;  ///< of |value| over equal steps from -radius to radius
};

}  // namespace rayfarm
