#include "common/lighting/zones/medium_zones.h"

#include <fmt/core.h>

#include <stdexcept>

#include "common/math/spherical.h"

namespace rayfarm {
namespace {

/// Points along each edge of a cell at which its density is measured.
constexpr uint32_t kDensityPoints = 4;

/// Rows of directions that tell a lobe of Henyey and Greenstein's apart.
uint32_t rows_for(double asymmetry) {
  if (asymmetry == 0) return 0;
  return static_cast<uint32_t>(std::clamp(std::ceil(4 / (1 - std::abs(asymmetry))), 6.0, 32.0));
}

}  // namespace

Vec2 SphereCells::place(const Vec3& direction) const {
  return {longitude(direction.x, direction.y) * 2 * rows, 0.5 * (1 - direction.z) * rows};
}

uint32_t SphereCells::cell(const Vec3& direction) const {
  if (rows == 0) return 0;
  const Vec2 at = place(direction);
  return std::min(static_cast<uint32_t>(std::max(at.y, 0.0)), rows - 1) * 2 * rows +
         std::min(static_cast<uint32_t>(at.x), 2 * rows - 1);
}

Vec3 SphereCells::direction(uint32_t cell, const Vec2& u) const {
  const Vec2 at = rows == 0 ? u : (Vec2(cell % (2 * rows), cell / (2 * rows)) + u) / Vec2(2 * rows, rows);
  const double z = 1 - 2 * at.y, r = std::sqrt(std::max(0.0, 1 - z * z));
  const auto [sine, cosine] = portable_sine_cosine(2 * std::numbers::pi * at.x);
  return {r * cosine, r * sine, z};
}

MediumZones::MediumZones(const Scene& scene, double zone_size, uint64_t most_cells) : scene_(scene) {
  for (uint32_t m = 0; m < scene.media.size(); ++m) {
    const ParticipatingMedium& medium = scene.media[m];
    if (medium.scattering == Color(0)) continue;
    MediumGrid& grid = grids_.emplace_back();
    grid.medium = m;
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = std::max(1.0, std::ceil(medium.box.extent()[axis] / (2 * zone_size) * (1 - 1e-9)));
      cells *= along;
      if (!(cells + static_cast<double>(densities_.size()) <= static_cast<double>(most_cells)))
        throw std::runtime_error(fmt::format(
            "zones of media would be more than {}, which is what the memory for them holds; a larger "
            "--zone-size, or more --zone-memory, is needed",
            most_cells));
      grid.count[static_cast<size_t>(axis)] = static_cast<uint32_t>(along);
      grid.step[axis] = medium.box.extent()[axis] / along;
    }
    grid.directions.rows = rows_for(medium.asymmetry);
    grid.first_cell = densities_.size();
    grid.first_slot = slots_;
    slots_ += grid.cell_count() * grid.directions.count();
    for (uint64_t cell = 0; cell < grid.cell_count(); ++cell) {
      double sum = 0, most = 0;
      constexpr uint32_t kAll = kDensityPoints * kDensityPoints * kDensityPoints;
      for (uint32_t k = 0; k < (medium.has_grid() ? kAll : 1); ++k) {
        const Vec3 u((k % kDensityPoints + 0.5) / kDensityPoints,
                     (k / kDensityPoints % kDensityPoints + 0.5) / kDensityPoints,
                     (k / kDensityPoints / kDensityPoints + 0.5) / kDensityPoints);
        const double density = medium.has_grid() ? density_at(scene, medium, point_in(grid, cell, u)) : 1;
        sum += density;
        most = std::max(most, density);
      }
      densities_.push_back(medium.has_grid() ? sum / kAll : 1);
      most_density_.push_back(static_cast<float>(1.25 * most));
    }
  }
}

const MediumGrid& MediumZones::grid_of_cell(uint64_t cell) const {
  return *(std::upper_bound(grids_.begin(), grids_.end(), cell,
                            [](uint64_t c, const MediumGrid& g) { return c < g.first_cell; }) -
           1);
}

const MediumGrid& MediumZones::grid_of_slot(uint64_t slot) const {
  return *(std::upper_bound(grids_.begin(), grids_.end(), slot,
                            [](uint64_t s, const MediumGrid& g) { return s < g.first_slot; }) -
           1);
}

}  // namespace rayfarm
