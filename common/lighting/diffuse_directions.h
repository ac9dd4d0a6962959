#pragma once
// The thesis's distribution of secondary diffuse rays (section 3.3): bands about the normal, each ray with
// the same share of the light that Lambert's cosine law lets through. Of a cone about the normal with half
// angle θ that share is sin²θ, the integral of cos θ over its solid angle. The thesis divides the volume of
// the sphere that Lambert's law draws, r = cos θ: the cone cuts 1 - cos⁴θ out of it, the integral of r³.
// Rays of equal weight then crowd about the normal, as if light counted with cos³θ: under an even sky both
// bring the same, but what stands low brings less than it should.
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/vector.h"
#include "common/sampling/warps.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

class DiffuseDirections {
 public:
  /// Any number of rays up to kMostDiffuseDirections; 25 are one along the normal and four bands of six
  /// (Figure 3.1).
  explicit DiffuseDirections(uint64_t rays, DiffuseBands bands = DiffuseBands::flux);

  /// Unit vectors about +y. Rays of a band stand one after the other.
  std::span<const Vec3> about_y() const { return directions_; }

  /// A direction in the part of the hemisphere that a ray stands for, chosen by `u`. The middles of bands
  /// meet a body whose rim runs along the bands too often or too seldom, and so at every place of a curved
  /// surface; directions at random are right on average.
  Vec3 jittered(size_t ray, const Vec2& u) const;

 private:
  size_t rays_, per_band_;
  DiffuseBands bands_;
  std::vector<Vec3> directions_;
};

/// Turns directions about +y around it, and then to a normal.
struct TurnedFrame {
  TurnedFrame(const Vec3& normal, double radians);
  Vec3 to_world(const Vec3& about_y) const {
    return frame.to_world(
        {cosine * about_y.x - sine * about_y.z, sine * about_y.x + cosine * about_y.z, about_y.y});
  }

  Frame frame;
  double cosine, sine;  ///< of the turn around +y
};

}  // namespace rayfarm
