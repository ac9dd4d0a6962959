#pragma once
// Bounding volumes (thesis 2.6.1.1; Weghorst, Hooper and Greenberg 1984, section 2): shapes about points, the
// choice among them, and whether a ray meets them.
#include <optional>
#include <span>
#include <vector>

#include "common/scene/hierarchy_records.h"

namespace rayfarm {

/// A point that a volume must hold, with all that is within the radius of it.
struct FitPoint {
  Vec3 p{0};
  double radius = 0;
};

struct Ball {
  Vec3 center{0};
  double radius = 0;
};

/// The least ball about points (Welzl 1991); where they have radii, a ball not much larger. `points` are not
/// empty.
Ball least_ball(std::span<const FitPoint> points);
Box box_of(std::span<const FitPoint> points);

/// What a volume of each kind costs, in the order of VolumeKind: nanoseconds of a test, measured by
/// tests/bench/volume_factors on an Intel Xeon of the Sapphire Rapids generation.
inline constexpr std::array<double, kVolumeKinds> kVolumeFactors{6.5, 10, 17, 20};

/// Kay and Kajiya's: the axes, and the diagonals of a cube.
const std::array<Vec3, 7>& slab_normals();

/// The tightest of the kind: a least ball; a box along the axes; the cylinder of the least volume about one
/// of six axes (x, y, z and the principal axes of the points), with a least circle and caps where the points
/// end; slabs.
BoundingVolume fit_volume(VolumeKind kind, std::span<const FitPoint> points);

/// Of sphere, box and cylinder.
double volume_of(const BoundingVolume& volume);
/// The area of the shadow that parallel light of this direction, a unit vector, throws. Of sphere, box and
/// cylinder.
double projected_area(const BoundingVolume& volume, const Vec3& direction);

/// Of sphere, box and cylinder the one with the least factor × volume. `eye`: where all rays come from; then
/// the least factor × projected area, as the volume with the least area has the least void area, and is met
/// by the fewest rays.
BoundingVolume choose_volume(std::span<const FitPoint> points, const std::optional<Vec3>& eye);

/// Makes it larger on all sides.
void widen(BoundingVolume& volume, double margin);

/// True if the points are the corners of a rectangular parallelepiped, in any position.
bool is_box(std::span<const FitPoint> points);

/// Where a ray enters the volume: 0 if it begins inside; none if it misses it. `direction` is of any length,
/// not 0.
std::optional<double> entry_into(const BoundingVolume& volume, const Vec3& origin, const Vec3& direction);
std::optional<double> entry_into(const Ball& ball, const Vec3& origin, const Vec3& direction);

}  // namespace rayfarm
