// Points, places and corners of the zones that a ZoneMap has.
#include "common/lighting/face_corners.h"
#include "common/lighting/zones/zone_map.h"

namespace rayfarm {

GridPlace ZoneMap::place_of(const ZoneGrid& grid, const Hit& hit, const Vec3& p_object) const {
  switch (grid.shape) {
    case ZoneShape::triangle:
      return Vec2(hit.v, hit.w) * static_cast<double>(grid.record);
    case ZoneShape::plane:
      return planes_[grid.record].place_of(p_object);
    case ZoneShape::revolved:
      return revolved_[grid.record].place_of(p_object);
    case ZoneShape::none:
      break;
  }
  return {};
}

uint32_t ZoneMap::cell_at(const ZoneGrid& grid, const GridPlace& place) const {
  if (grid.shape == ZoneShape::triangle) return triangle_cells(grid).cell_at(place);
  if (grid.shape == ZoneShape::revolved)
    return rayfarm::cell_at(place, revolved_[grid.record].columns, revolved_[grid.record].rows);
  const PlaneCells& plane = planes_[grid.record];
  const uint32_t cell = rayfarm::cell_at(place, plane.columns, plane.rows);
  return plane.stands_for.empty() ? cell : plane.stands_for[cell];
}

NearCells ZoneMap::cells_about(const ZoneGrid& grid, const GridPlace& place) const {
  if (grid.shape == ZoneShape::triangle) return {{triangle_cells(grid).cell_at(place)}};
  if (grid.shape == ZoneShape::revolved) {
    const RevolvedCells& cells = revolved_[grid.record];
    return rayfarm::cells_about(place, cells.columns, cells.rows, true);
  }
  const PlaneCells& plane = planes_[grid.record];
  NearCells near = rayfarm::cells_about(place, plane.columns, plane.rows, false);
  if (!plane.stands_for.empty())
    for (uint32_t& cell : near.cell) cell = plane.stands_for[cell];
  return near;
}

CellCorners ZoneMap::corners_at(const ZoneGrid& grid, const GridPlace& place) const {
  if (grid.shape == ZoneShape::triangle) return triangle_cells(grid).corners_at(place);
  if (grid.shape == ZoneShape::revolved)
    return rayfarm::corners_at(place, revolved_[grid.record].columns, revolved_[grid.record].rows);
  return rayfarm::corners_at(place, planes_[grid.record].columns, planes_[grid.record].rows);
}

InlineVector<uint32_t, 4> ZoneMap::corners_of(const ZoneGrid& grid, uint32_t cell) const {
  InlineVector<uint32_t, 4> corners;
  if (grid.shape == ZoneShape::triangle) {
    for (const uint32_t c : triangle_cells(grid).corners_of(cell)) corners.push_back(c);
    return corners;
  }
  const uint32_t columns =
      grid.shape == ZoneShape::revolved ? revolved_[grid.record].columns : planes_[grid.record].columns;
  const uint32_t first = cell / columns * (columns + 1) + cell % columns;
  for (const uint32_t c : {first, first + 1, first + columns + 1, first + columns + 2}) corners.push_back(c);
  return corners;
}

ZoneMap::Corner ZoneMap::corner(const ZoneGrid& grid, uint32_t corner) const {
  if (grid.shape == ZoneShape::triangle) {
    const TriangleCells cells = triangle_cells(grid);
    const auto& v = cells.vertices;
    return {cells.corner_point(corner), normalized(glm::cross(v[1] - v[0], v[2] - v[0]))};
  }
  if (grid.shape == ZoneShape::plane) {
    const PlaneCells& plane = planes_[grid.record];
    const Vec2 place(corner % (plane.columns + 1), corner / (plane.columns + 1));
    return {plane.at(plane.low + place * plane.step), glm::cross(plane.x, plane.y)};
  }
  const RevolvedCells& cells = revolved_[grid.record];
  const uint32_t column = corner % (cells.columns + 1);
  // The last column is the first again.
  const Vec2 uv(static_cast<double>(column % cells.columns) / cells.columns,
                static_cast<double>(corner / (cells.columns + 1)) / cells.rows);
  const RevolvedCells::Point point = revolved_point(grid, cells, uv);
  if (point.density > 0) return {point.p, point.normal};
  // Where nothing is the axis stands in, with a place of its own.
  return {cells.center + (cells.low + uv.y * (cells.high - cells.low)) * cells.axes[2] + uv.x * cells.axes[0],
          cells.axes[2]};
}

Vec3 ZoneMap::tangent(const InstancePose& place, const ZoneGrid& grid, const Vec3& p_object) const {
  Vec3 along(1, 0, 0);
  if (grid.shape == ZoneShape::triangle) {
    const std::array<Vec3, 3> v = triangle_vertices(pose_.shape_of(grid.instance, scene_), grid.block_lane);
    along = v[1] - v[0];
  } else if (grid.shape == ZoneShape::plane) {
    along = planes_[grid.record].x;
  } else {
    const RevolvedCells& cells = revolved_[grid.record];
    along = glm::cross(cells.axes[2], p_object - cells.center);
    if (along == Vec3(0)) along = cells.axes[0];
  }
  return normalized(place.is_identity ? along : place.world_from_object.vector(along));
}

Vec2 ZoneMap::revolved_parameters(const ZoneGrid& grid, uint32_t cell, const Vec2& u) const {
  const RevolvedCells& cells = revolved_[grid.record];
  return (Vec2(cell % cells.columns, cell / cells.columns) + u) / Vec2(cells.columns, cells.rows);
}

bool ZoneMap::is_accepted(const ZoneGrid& grid, uint32_t cell, const Vec2& u, double chance) const {
  const RevolvedCells& cells = revolved_[grid.record];
  const RevolvedCells::Point point = revolved_point(grid, cells, revolved_parameters(grid, cell, u));
  return point.density > 0 && chance * cells.most_density[cell] <= point.density;
}

ZonePoint ZoneMap::point_at(const ZoneGrid& grid, uint32_t cell, uint32_t side, const Vec2& u) const {
  ZonePoint result;
  Hit& hit = result.hit;
  hit.t = 0;
  hit.instance = grid.instance;
  hit.primitive = grid.primitive;
  hit.block_lane = grid.block_lane;
  if (grid.shape == ZoneShape::triangle) {
    result.p_object = triangle_cells(grid).point(cell, u);
    hit.u = hit.v = hit.w = 1.0 / 3;  // only normals of vertices ask for them
  } else if (grid.shape == ZoneShape::plane) {
    result.p_object = planes_[grid.record].point(cell, u);
  } else {
    const RevolvedCells& cells = revolved_[grid.record];
    const RevolvedCells::Point point = revolved_point(grid, cells, revolved_parameters(grid, cell, u));
    result.p_object = point.density > 0 ? point.p : cells.center;
  }
  const InstancePose& place = pose_[grid.instance];
  const Vec3 p = place.is_identity ? result.p_object : place.world_from_object.point(result.p_object);
  result.surface = eval_surface(scene_, pose_, {p, Vec3(0, 0, 1)}, hit);
  if (result.surface.is_front != (side == 0)) {
    result.surface.is_front = side == 0;
    result.surface.geometric_normal = -result.surface.geometric_normal;
  }
  result.surface.shading_normal = result.surface.geometric_normal;
  // What rays meet as triangles has corners of 24 bits, and its plane is so much beside the polygon's: rays
  // that leave must start off both.
  if (grid.shape == ZoneShape::plane && grid.block_lane != kNone)
    result.surface.offset *= 0x1p-22 / rounding_bound(1);
  const Vec3 along = tangent(place, grid, result.p_object), &n = result.surface.geometric_normal;
  result.tangent = normalized(along - glm::dot(along, n) * n);
  return result;
}

}  // namespace rayfarm
