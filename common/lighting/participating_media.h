#pragma once
// Rays through media that fill boxes (scene/participating_medium.h): which they cross, how dense these are,
// and how much light is left behind them. Densities lie at the centres of a grid's cells and are weighed
// linearly between them; beyond the outermost centres they stay as they are there.
#include "common/math/inline_vector.h"
#include "common/math/ray.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// The piece of a ray that lies in a medium's box; t counts in lengths of the ray's direction.
struct MediumSegment {
  uint32_t medium = 0;  ///< in Scene::media
  double t0 = 0, t1 = 0;
};
using MediumSegments = InlineVector<MediumSegment, kMostMedia>;

/// The boxes that the ray crosses between 0 and its t_max, the nearest first. Boxes do not overlap.
MediumSegments media_along(const Scene& scene, const Ray& ray);

/// At a point in the medium's box, in the world. Coefficients there are the medium's times this.
double density_at(const Scene& scene, const ParticipatingMedium& medium, const Vec3& p);

/// The density times length, summed up along the segment: times the extinction it is the optical depth. Exact
/// but for rounding, with a grid too: between planes through cells' centres the density along a ray is a
/// cubic polynomial, which two of Gauss's points integrate.
double density_along(const Scene& scene, const Ray& ray, const MediumSegment& segment);

/// What is left of light between 0 and the ray's t_max: exp(-∫ extinction), Bouguer's law.
Color transmittance(const Scene& scene, const Ray& ray);

/// exp(-depth), channel by channel.
Color attenuation(const Color& depth);

/// A walk along a piece of a ray through a regular grid, cell by cell (Amanatides and Woo 1987). What is left
/// behind the last cell belongs to it, so that rounding loses no piece.
class GridWalk {
 public:
  /// `first`: the corner of the first cell; `step`: a cell's size; `count`: of cells along each axis.
  GridWalk(const Ray& ray, double t0, double t1, const Vec3& first, const Vec3& step,
           const std::array<uint32_t, 3>& count);

  /// Goes to the next piece, the first at first. False: there is none.
  bool next();
  double t0() const { return t0_; }
  double t1() const { return t1_; }
  const std::array<uint32_t, 3>& cell() const { return cell_; }

 private:
  double plane(size_t axis) const;

  Vec3 origin_, direction_, first_, step_;
  std::array<uint32_t, 3> count_, cell_, next_cell_;
  Vec3 crossing_;  ///< where the ray leaves the cell along each axis
  double t0_, t1_, end_;
};

/// A walk along a segment through the blocks of cells of its medium's grid, from majorant to majorant.
class MajorantWalk {
 public:
  MajorantWalk(const Scene& scene, const Ray& ray, const MediumSegment& segment);

  /// Goes to the next piece whose majorant is above 0. False: there is none.
  bool next();
  double t0() const { return walk_.t0(); }
  double t1() const { return walk_.t1(); }
  /// No density on the piece is above it.
  double majorant() const { return majorant_; }

 private:
  std::span<const float> majorants_;
  std::array<uint32_t, 3> blocks_;
  GridWalk walk_;
  double majorant_ = 0;
};

}  // namespace rayfarm
