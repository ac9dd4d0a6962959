#pragma once
// Radiance of zones apart from any view, as it is baked: what surfaces emit along their normals, and what
// they reflect as if it left evenly.
#include "common/lighting/zones/shared_corners.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/lighting/zones/zone_solution.h"

namespace rayfarm {

class BakedLight {
 public:
  /// `zones` must outlive it.
  BakedLight(const ZoneScene& zones, std::span<const ZonePassSolution> passes);

  /// Linear Rec. 709. `cell`: of any that stands for itself or for others.
  Color of_cell(const ZoneGrid& grid, uint32_t cell, uint32_t side) const {
    return values_[2 * (size_t{grid.first_cell} + cell) + side];
  }
  /// Linear between the corners of zones, as the view `smooth` has it.
  Color at(const ZoneGrid& grid, const GridPlace& place, uint32_t side) const {
    const std::optional<Color> smooth = corners_.at(grid, place, side);
    return smooth ? *smooth : of_cell(grid, map_.cell_at(grid, place), side);
  }
  /// True if any zone on the grid's side has light.
  bool is_lit(const ZoneGrid& grid, uint32_t side) const;

 private:
  void add_pass(const ZoneScene& zones, size_t pass, const ZonePassSolution& solution);

  const ZoneMap& map_;
  GrowingArray<glm::vec3> values_;  ///< by cell and side
  SharedCorners corners_;
};

/// True if light goes on through surfaces of the material otherwise than diffusely: glass.
bool is_clear(const Scene& scene, const Material& material);

}  // namespace rayfarm
