#pragma once
// Zones of media: boxes in equal cells (Shirley, Sung and Brown 1991, section 4; Rushmeier and Torrance
// 1987). "The zones in the medium have volume angular distribution functions": one sum where a medium
// scatters evenly, else sums for cells of directions over the sphere, of what leaves in them.
#include <vector>

#include "common/lighting/participating_media.h"
#include "common/lighting/zones/power.h"
#include "common/scene/zone_settings.h"

namespace rayfarm {

/// Directions over the sphere in cells of equal solid angle: rows of equal height, twice as many columns.
struct SphereCells {
  uint32_t rows = 0;  ///< 0: one cell, the whole

  uint32_t count() const { return rows == 0 ? 1 : 2 * rows * rows; }
  /// Of a direction, unit: columns and rows, from 0.
  Vec2 place(const Vec3& direction) const;
  uint32_t cell(const Vec3& direction) const;
  Vec3 direction(uint32_t cell, const Vec2& u) const;
};

/// A medium's cells.
struct MediumGrid {
  uint32_t medium = 0;
  Vec3 step{1};
  std::array<uint32_t, 3> count{1, 1, 1};
  SphereCells directions;
  uint64_t first_cell = 0, first_slot = 0;  ///< slots counted from the media's first

  uint64_t cell_count() const { return uint64_t{count[0]} * count[1] * count[2]; }
  uint64_t index(const std::array<uint32_t, 3>& cell) const {
    return (uint64_t{cell[2]} * count[1] + cell[1]) * count[0] + cell[0];
  }
  std::array<uint32_t, 3> cell_at(uint64_t index) const {
    return {static_cast<uint32_t>(index % count[0]), static_cast<uint32_t>(index / count[0] % count[1]),
            static_cast<uint32_t>(index / count[0] / count[1])};
  }
  double volume() const { return step.x * step.y * step.z; }
  uint64_t slot(uint64_t cell) const { return first_slot + cell * directions.count(); }
};

class MediumZones {
 public:
  /// Cells' edges are up to twice as long as zones of surfaces.
  /// Throws std::runtime_error if there would be more than `most_cells`.
  MediumZones(const Scene& scene, double zone_size, uint64_t most_cells);

  std::span<const MediumGrid> grids() const { return grids_; }
  uint64_t cell_count() const { return densities_.size(); }
  uint64_t slot_count() const { return slots_; }
  /// Of a medium; null: it scatters nothing.
  const MediumGrid* find(uint32_t medium) const {
    for (const MediumGrid& grid : grids_)
      if (grid.medium == medium) return &grid;
    return nullptr;
  }
  const MediumGrid& grid_of_cell(uint64_t cell) const;
  const MediumGrid& grid_of_slot(uint64_t slot) const;
  /// The mean over a cell, counted through all grids.
  double density(uint64_t cell) const { return densities_[cell]; }
  /// A point in a cell, more often where it is dense; `more(i)`: pairs of random numbers.
  template <typename More>
  Vec3 point(const MediumGrid& grid, uint64_t cell, More more) const {
    Vec3 p(0);
    for (uint32_t i = 0; i < kMostTries; ++i) {
      const Vec2 xy = more(2 * i), z = more(2 * i + 1);
      p = point_in(grid, cell, {xy.x, xy.y, z.x});
      if (!scene_.media[grid.medium].has_grid() ||
          z.y * most_density_[grid.first_cell + cell] <= density_at(scene_, scene_.media[grid.medium], p))
        break;
    }
    return p;
  }
  /// `u` in [0, 1)³.
  Vec3 point_in(const MediumGrid& grid, uint64_t cell, const Vec3& u) const {
    const auto [x, y, z] = grid.cell_at(cell);
    return scene_.media[grid.medium].box.lo + (Vec3(x, y, z) + u) * grid.step;
  }

 private:
  static constexpr uint32_t kMostTries = 32;
  Scene scene_;
  std::vector<MediumGrid> grids_;
  std::vector<double> densities_;
  std::vector<float> most_density_;
  uint64_t slots_ = 0;
};

/// The part of what a medium takes out of a ray that it scatters.
inline Color albedo_of(const ParticipatingMedium& medium) {
  Color albedo(0);
  for (int c = 0; c < 3; ++c)
    if (medium.extinction()[c] > 0) albedo[c] = medium.scattering[c] / medium.extinction()[c];
  return albedo;
}

}  // namespace rayfarm
