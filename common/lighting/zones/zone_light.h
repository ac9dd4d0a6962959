#pragma once
// Radiance that zones keep, as pictures read it.
#include "common/lighting/zones/kept_light.h"
#include "common/lighting/zones/shared_corners.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/lighting/zones/zone_solution.h"

namespace rayfarm {

/// A point of a ray in a medium that scatters.
struct LitMediumPoint {
  uint32_t medium = kNone;  ///< none: nothing is scattered
  double t = 0;             ///< in lengths of the ray's direction
  Color throughput{
      0};  ///< what is scattered there and reaches the ray's origin, over the point's probability
};

/// The cells of directions of a medium's zones that are seen from one side, and how much of each.
struct DirectionsSeen {
  std::array<uint32_t, 4> cell{};
  std::array<double, 4> weight{1};
  size_t count = 1;
};

/// The zones of one colour pass.
class ZoneLight {
 public:
  /// `zones` must outlive it.
  ZoneLight(const ZoneScene& zones, size_t pass, const ZonePassSolution& solution, ZoneView view);

  ZoneView view() const { return view_; }
  /// The grid whose zones keep what the surface reflects, or null.
  const ZoneGrid* grid_of(const Hit& hit) const {
    const ZoneGrid* const grid = map_.grid_of(hit);
    return grid && grid->store.is_any() ? grid : nullptr;
  }
  /// Radiance that leaves to at.to_viewer by the lobes that are kept. `lobes`: of the surface, seen from
  /// there. In the view `direct` without what came straight from sources.
  /// `pose`: where things are for the ray, which may not be where they were for zones.
  Color radiance(const Pose& pose, const ZoneGrid& grid, const Hit& hit, const Surface& surface,
                 const Interaction& at, const Lobes& lobes) const;
  /// Radiance that media send against a ray's direction, between 0 and its t_max. In the view `direct`, and
  /// in `gather` if the ray `is_seen` (its path has not turned but along mirrors and through glass), without
  /// what comes straight from sources and is scattered once: `lit` is then a point at which to ask for it, by
  /// chance (`u` in [0, 1)) where as much is scattered as there.
  Color radiance_of_media(const Ray& ray, bool is_seen, double u, LitMediumPoint& lit) const;

 private:
  /// `values`: of all slots of media.
  Color source_at(const glm::vec3* values, const MediumGrid& grid, const Vec3& p,
                  const DirectionsSeen& seen) const;
  /// Linear between the middles of cells of directions.
  DirectionsSeen directions_seen(const MediumGrid& grid, const Vec3& to_viewer) const;
  Color per_power(uint64_t slot) const;
  glm::vec3 kept_diffusely(const ZoneGrid& grid, uint32_t cell, uint32_t side) const {
    return values_[grid.slot(cell, side)];
  }
  Color diffuse(const ZoneGrid& grid, const GridPlace& place, uint32_t side) const;
  Color directional(const InstancePose& pose, const ZoneGrid& grid, const GridPlace& on_grid,
                    const Surface& surface, const Vec3& p_object, const Vec3& to_viewer) const;

  const Scene scene_;  ///< in the pass's colours
  const ZoneMap& map_;
  const MediumZones& media_;
  ZoneColors colors_;
  ZoneView view_;
  /// By slot. Of diffuse ones power per area, in grids with textures over what the cell reflects of all;
  /// of directions radiance.
  /// Of media the radiance of what is opaque.
  GrowingArray<glm::vec3> values_;
  GrowingArray<glm::vec3> indirect_in_media_;  ///< of media, without direct light; in the view `gather` alone
  std::optional<SharedCorners> corners_;       ///< of what is kept diffusely; none in the view `flat`
};

}  // namespace rayfarm
