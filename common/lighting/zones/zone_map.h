#pragma once
// Zones: the cells of a (u, v) grid on every primitive of every instance, with two sides each (Shirley, Sung
// and Brown 1991, section 3). Every process derives the same from the scene's block.
#include <string>

#include "common/hierarchy/frame_state.h"
#include "common/lighting/zones/zone_shapes.h"
#include "common/scene/zone_settings.h"

namespace rayfarm {

enum class ZoneShape : uint8_t {
  none,  ///< the primitive has no zones
  triangle,
  plane,
  revolved
};

/// What a zone keeps of the light that its surface reflects.
struct ZoneStore {
  bool is_diffuse = false;  ///< one sum a side: of what leaves as Lambert's law has it
  /// Cells along each side of the square that directions are sorted into (zone_directions.h); 0: what the
  /// surface spreads about mirror directions is followed, not kept.
  uint32_t direction_cells = 0;

  bool is_any() const { return is_diffuse || direction_cells > 0; }
  /// Sums of one side.
  uint64_t slots() const { return is_any() ? 1 + uint64_t{direction_cells} * direction_cells : 0; }
};

/// A primitive of an instance, and its cells.
struct ZoneGrid {
  uint32_t instance = 0, material = 0;
  PrimitiveId primitive = kNoPrimitive;
  uint32_t block_lane = kNone;  ///< as of a hit, where triangles tell of it
  ZoneShape shape = ZoneShape::none;
  ZoneStore store;
  uint32_t record = 0;  ///< of plane or revolved cells; of a triangle the parts of its edges
  uint32_t first_cell = 0, cell_count = 0;
  uint32_t first_corner = 0, corner_count = 0;
  uint64_t first_slot = 0;

  uint64_t slot(uint32_t cell, uint32_t side) const {
    return first_slot + (2 * uint64_t{cell} + side) * store.slots();
  }
};

/// Where a sum is kept.
struct SlotPlace {
  uint32_t grid = 0, cell = 0, side = 0;
  uint32_t direction = 0;  ///< 0: the diffuse one; else 1 + the cell of directions
};

/// A point of a zone as rays leave it.
struct ZonePoint {
  Hit hit;  ///< at no distance
  Vec3 p_object{0};
  Surface surface;  ///< normals point to the side that was asked for
  Vec3 tangent{0};  ///< unit, across the normal: where directions are counted from
};

class ZoneMap {
 public:
  /// Throws std::runtime_error if zones need more memory than is allowed. `scene` and `pose` must stay as
  /// long. `has_directions`: zones keep what shiny surfaces spread, by direction.
  ZoneMap(const Scene& scene, const Pose& pose, const ZoneSettings& settings, bool has_directions = true);

  std::span<const ZoneGrid> grids() const { return grids_; }
  uint64_t cell_count() const { return areas_.size(); }
  uint64_t corner_count() const { return corners_; }
  uint64_t slot_count() const { return slots_; }
  /// Of all that is kept of grids and cells, without sums.
  uint64_t bytes() const { return areas_.size() * sizeof(double) + grids_.size() * sizeof(ZoneGrid); }
  /// Of a zone's side, in the world: what was asked for, or chosen; materials may have sizes of their own.
  double size() const { return size_; }

  /// The grid of what was hit; null: it has none.
  const ZoneGrid* grid_of(const Hit& hit) const;
  GridPlace place_of(const ZoneGrid& grid, const Hit& hit, const Vec3& p_object) const;
  uint32_t cell_at(const ZoneGrid& grid, const GridPlace& place) const;
  /// Those that a value is interpolated between; of a triangle the one that the place is in.
  NearCells cells_about(const ZoneGrid& grid, const GridPlace& place) const;
  /// Among the grid's own corners.
  CellCorners corners_at(const ZoneGrid& grid, const GridPlace& place) const;
  /// In the world; 0 of cells that others stand for.
  double area(const ZoneGrid& grid, uint32_t cell) const { return areas_[grid.first_cell + cell]; }
  SlotPlace place_of_slot(uint64_t slot) const;
  uint32_t grid_of_cell(uint64_t cell) const;

  /// A point on side `side` (0: the front) of a cell that has an area, uniform over it for uniform `u`;
  /// `more(i)` gives other pairs of random numbers, which few shapes ask for.
  template <typename More>
  ZonePoint point(const ZoneGrid& grid, uint32_t cell, uint32_t side, const Vec2& u, More more) const {
    Vec2 chosen = u;
    if (grid.shape == ZoneShape::revolved)
      for (uint32_t i = 0; i < kMostTries; ++i) {
        const Vec2 r = more(i);
        chosen = i == 0 ? u : more(kMostTries + i);
        if (is_accepted(grid, cell, chosen, r.x)) break;
      }
    return point_at(grid, cell, side, chosen);
  }
  /// Where a corner is, in the object's space, and the front's normal there, unit.
  struct Corner {
    Vec3 p{0}, normal{0};
  };
  Corner corner(const ZoneGrid& grid, uint32_t corner) const;
  /// The corners of a cell: three or four.
  InlineVector<uint32_t, 4> corners_of(const ZoneGrid& grid, uint32_t cell) const;
  /// Where directions are counted from at a point: unit, in the world, not yet across a normal.
  Vec3 tangent(const InstancePose& place, const ZoneGrid& grid, const Vec3& p_object) const;

  // The cells of a grid, by its shape.
  TriangleCells triangle_cells(const ZoneGrid& grid) const {
    return {triangle_vertices(pose_.shape_of(grid.instance, scene_), grid.block_lane), grid.record};
  }
  const PlaneCells& plane_cells(const ZoneGrid& grid) const { return planes_[grid.record]; }
  const RevolvedCells& revolved_cells(const ZoneGrid& grid) const { return revolved_[grid.record]; }

  const Scene& scene() const { return scene_; }
  const Pose& pose() const { return pose_; }

 private:
  static constexpr uint32_t kMostTries = 32;

  /// Where the grids of a part's primitives of each kind begin, counted from an instance's first, and the
  /// least index of that kind.
  struct PartTable {
    std::array<uint32_t, 5> first{}, least{}, count{};
    uint32_t grids = 0;
  };

  void find_primitives(const ZoneSettings& settings);
  double find_size() const;
  void make_cells(bool has_directions);
  void make_triangle(ZoneGrid& grid);
  void make_plane(ZoneGrid& grid);
  void make_revolved(ZoneGrid& grid);
  bool is_accepted(const ZoneGrid& grid, uint32_t cell, const Vec2& u, double chance) const;
  ZonePoint point_at(const ZoneGrid& grid, uint32_t cell, uint32_t side, const Vec2& u) const;
  Vec2 revolved_parameters(const ZoneGrid& grid, uint32_t cell, const Vec2& u) const;
  RevolvedCells::Point revolved_point(const ZoneGrid& grid, const RevolvedCells& cells, const Vec2& uv) const;
  void reserve_cells(ZoneGrid& grid, double columns, double rows, bool is_triangle);
  /// Its material's own, or size().
  double size_of(const ZoneGrid& grid) const;
  /// Into how many zones of the grid's material that length is cut.
  double parts_of(const ZoneGrid& grid, double length) const;

  Scene scene_;
  Pose pose_;
  double size_ = 0;
  uint64_t most_cells_ = 0;
  std::vector<PartTable> parts_;
  std::vector<uint32_t> first_grid_;  ///< of each instance
  GrowingArray<ZoneGrid> grids_;
  std::vector<uint32_t> grid_order_;  ///< those that have cells, as these and slots rise
  GrowingArray<double> areas_;
  std::vector<PlaneCells> planes_;
  std::vector<RevolvedCells> revolved_;
  uint64_t slots_ = 0, corners_ = 0;
};

/// What zones of the material keep. `scene`: of a mix's parts.
ZoneStore store_of(const Scene& scene, const Material& material);

/// Bytes that the host needs for a slot's sums, at the most: four while a pass is solved, and two of each
/// pass that is.
constexpr uint64_t slot_bytes(size_t passes) {
  return (4 + 2 * (passes - 1)) * 3 * sizeof(int64_t);
}

}  // namespace rayfarm
