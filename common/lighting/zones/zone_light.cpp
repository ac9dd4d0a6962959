#include "common/lighting/zones/zone_light.h"

#include <algorithm>
#include <numbers>
#include <vector>

namespace rayfarm {
namespace {

using std::numbers::pi;

/// `a` over `b` where there is any.
Color over(const Color& a, const Color& b) {
  Color result(0);
  for (int c = 0; c < 3; ++c)
    if (b[c] > 0) result[c] = a[c] / b[c];
  return result;
}

}  // namespace

ZoneLight::ZoneLight(const ZoneScene& zones, size_t pass, const ZonePassSolution& solution, ZoneView view)
    : scene_(zones.scene(pass)),
      map_(zones.map()),
      media_(zones.media()),
      colors_(zones.scene(pass), zones.map()),
      view_(view),
      values_(zones.slot_count(), glm::vec3(0)),
      indirect_in_media_(view == ZoneView::gather ? media_.slot_count() : 0, glm::vec3(0)) {
  solution.total.for_each([&](uint64_t slot, const Power& total) {
    Power indirect = total;
    indirect -= solution.direct.at(slot);
    const Color scale = per_power(slot);
    values_[slot] = solution.quantum.value(view == ZoneView::direct ? indirect : total) * scale;
    if (view == ZoneView::gather && slot >= map_.slot_count())
      indirect_in_media_[slot - map_.slot_count()] = solution.quantum.value(indirect) * scale;
  });
  for (const ZoneGrid& grid : map_.grids()) {
    if (!grid.store.is_diffuse || !colors_.is_textured(grid)) continue;
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
      for (uint32_t side = 0; side < 2; ++side) {
        glm::vec3& value = values_[grid.slot(cell, side)];
        value = over(value, colors_(grid, cell).reflected[side] + colors_(grid, cell).through);
      }
  }
  if (view == ZoneView::flat) return;
  corners_.emplace(map_, [](const ZoneGrid& grid) { return grid.store.is_diffuse; });
  corners_->set(
      [&](const ZoneGrid& grid, uint32_t cell, uint32_t side) { return kept_diffusely(grid, cell, side); });
}

/// Makes values of power.
Color ZoneLight::per_power(uint64_t slot) const {
  if (slot < map_.slot_count()) {
    const SlotPlace place = map_.place_of_slot(slot);
    const ZoneGrid& grid = map_.grids()[place.grid];
    const double area = map_.area(grid, place.cell), cells = grid.store.direction_cells;
    if (!(area > 0)) return Color(0);
    return Color(place.direction > 0 ? cells * cells / (pi * area) : 1 / area);
  }
  const uint64_t in_media = slot - map_.slot_count();
  const MediumGrid& grid = media_.grid_of_slot(in_media);
  const uint64_t cell = (in_media - grid.first_slot) / grid.directions.count();
  const Color extinction = 4 * pi * grid.volume() * media_.density(grid.first_cell + cell) *
                           scene_.media[grid.medium].extinction();
  return over(Color(grid.directions.count()), extinction);
}

Color ZoneLight::diffuse(const ZoneGrid& grid, const GridPlace& place, uint32_t side) const {
  if (corners_)
    if (const std::optional<Color> smooth = corners_->at(grid, place, side)) return *smooth;
  return kept_diffusely(grid, map_.cell_at(grid, place), side);
}

/// Linear between the middles of cells, and of the cells of directions.
Color ZoneLight::directional(const InstancePose& pose, const ZoneGrid& grid, const GridPlace& on_grid,
                             const Surface& surface, const Vec3& p_object, const Vec3& to_viewer) const {
  const Vec3 along = map_.tangent(pose, grid, p_object), &n = surface.geometric_normal;
  const DirectionFrame frame(n, normalized(along - glm::dot(along, n) * n));
  const uint32_t cells = grid.store.direction_cells;
  const auto first_of = [&](uint32_t cell) { return grid.slot(cell, surface.is_front ? 0 : 1) + 1; };
  const Vec2 place = direction_place(frame.to_local(to_viewer)) * static_cast<double>(cells);
  if (view_ == ZoneView::flat)
    return values_[first_of(map_.cell_at(grid, on_grid)) - 1 +
                   direction_slot(grid.store, place / static_cast<double>(cells))];
  const Vec2 from_middle = glm::clamp(place - Vec2(0.5), Vec2(0), Vec2(cells - 1));
  const auto x = std::min(static_cast<uint32_t>(from_middle.x), cells - 2),
             y = std::min(static_cast<uint32_t>(from_middle.y), cells - 2);
  const double fx = from_middle.x - x, fy = from_middle.y - y;
  const auto in_cell = [&](uint64_t first) {
    const auto value = [&](uint32_t i, uint32_t j) {
      return Color(values_[first + (y + j) * cells + x + i]);
    };
    return (1 - fy) * ((1 - fx) * value(0, 0) + fx * value(1, 0)) +
           fy * ((1 - fx) * value(0, 1) + fx * value(1, 1));
  };
  const NearCells near = map_.cells_about(grid, on_grid);
  Color sum(0);
  double weight = 0;
  for (size_t i = 0; i < 4; ++i) {
    if (!(near.weight[i] > 0) || !(map_.area(grid, near.cell[i]) > 0)) continue;
    sum += near.weight[i] * in_cell(first_of(near.cell[i]));
    weight += near.weight[i];
  }
  return weight > 0 ? sum / weight : Color(0);
}

Color ZoneLight::radiance(const Pose& pose, const ZoneGrid& grid, const Hit& hit, const Surface& surface,
                          const Interaction& at, const Lobes& lobes) const {
  const InstancePose& place = pose[hit.instance];
  const Vec3 p_object = place.in_object(surface.p);
  const GridPlace on_grid = map_.place_of(grid, hit, p_object);
  const uint32_t cell = map_.cell_at(grid, on_grid), side = surface.is_front ? 0 : 1;
  Color result(0);
  if (grid.store.is_diffuse) {
    Color seen(0);
    for (const Lobe& lobe : lobes)
      if (lobe.spread == Lobe::Spread::diffuse) seen += lobe.attenuation;
    const ZoneAlbedo& albedo = colors_(grid, cell);
    const Color kept = diffuse(grid, on_grid, side);
    // Of what zones have, seen through a polish, or of the texture's colour just here.
    const Color part = colors_.is_textured(grid) ? seen : over(seen, albedo.reflected[side] + albedo.through);
    result += kept * part / pi;
  }
  if (grid.store.direction_cells > 0)
    result += directional(place, grid, on_grid, surface, p_object, at.to_viewer);
  return result;
}

DirectionsSeen ZoneLight::directions_seen(const MediumGrid& grid, const Vec3& to_viewer) const {
  const uint32_t rows = grid.directions.rows, columns = 2 * rows;
  if (rows == 0) return {};
  if (view_ == ZoneView::flat) return {{grid.directions.cell(to_viewer)}, {1}, 1};
  const Vec2 at = grid.directions.place(to_viewer) - Vec2(0.5);
  const double row = std::clamp(at.y, 0.0, rows - 1.0), column = at.x < 0 ? at.x + columns : at.x;
  const auto i = std::min(static_cast<uint32_t>(column), columns - 1),
             j = std::min(static_cast<uint32_t>(row), rows - 2);
  const double fx = column - i, fy = row - j;
  const uint32_t next = (i + 1) % columns;
  return {{j * columns + i, j * columns + next, (j + 1) * columns + i, (j + 1) * columns + next},
          {(1 - fy) * (1 - fx), (1 - fy) * fx, fy * (1 - fx), fy * fx},
          4};
}

/// Linear between the middles of cells.
Color ZoneLight::source_at(const glm::vec3* values, const MediumGrid& grid, const Vec3& p,
                           const DirectionsSeen& seen) const {
  const Vec3 place = (p - scene_.media[grid.medium].box.lo) / grid.step;
  const auto in_cell = [&](const std::array<uint32_t, 3>& cell) {
    const uint64_t first = grid.slot(grid.index(cell));
    Color sum(0);
    for (size_t i = 0; i < seen.count; ++i) sum += seen.weight[i] * Color(values[first + seen.cell[i]]);
    return sum;
  };
  std::array<uint32_t, 3> low{}, high{};
  Vec3 share(0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<size_t>(axis);
    const double most = grid.count[i] - 1.0;
    const double x = view_ == ZoneView::flat ? std::clamp(std::floor(place[axis]), 0.0, most)
                                             : std::clamp(place[axis] - 0.5, 0.0, most);
    low[i] = static_cast<uint32_t>(x);
    high[i] = std::min(low[i] + 1, grid.count[i] - 1);
    share[axis] = x - low[i];
  }
  Color sum(0);
  for (uint32_t corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<uint32_t, 3> cell{};
    for (size_t i = 0; i < 3; ++i) {
      const bool is_high = corner >> i & 1;
      const double s = share[static_cast<int>(i)];
      weight *= is_high ? s : 1 - s;
      cell[i] = is_high ? high[i] : low[i];
    }
    if (weight > 0) sum += weight * in_cell(cell);
  }
  return sum;
}

Color ZoneLight::radiance_of_media(const Ray& ray, bool is_seen, double u, LitMediumPoint& lit) const {
  const bool asks_sources = view_ == ZoneView::direct || (view_ == ZoneView::gather && is_seen);
  const glm::vec3* const values =
      view_ == ZoneView::gather && is_seen ? indirect_in_media_.data() : values_.data() + map_.slot_count();
  struct Piece {
    uint32_t medium = kNone;
    double t0 = 0, t1 = 0, scattered = 0;  ///< scattered: by all pieces up to this one
    Color left{0};
  };
  std::vector<Piece> pieces;
  Color result(0), left(1);
  double scattered = 0;
  for (const MediumSegment& segment : media_along(scene_, ray)) {
    const ParticipatingMedium& medium = scene_.media[segment.medium];
    const MediumGrid* const grid = media_.find(segment.medium);
    if (!grid) {
      left *= attenuation(density_along(scene_, ray, segment) * medium.extinction());
      continue;
    }
    const Color albedo = over(medium.scattering, medium.extinction());
    const DirectionsSeen seen = directions_seen(*grid, -normalized(ray.direction));
    GridWalk piece(ray, segment.t0, segment.t1, medium.box.lo, grid->step, grid->count);
    while (piece.next()) {
      const Color gone = attenuation(density_along(scene_, ray, {segment.medium, piece.t0(), piece.t1()}) *
                                     medium.extinction());
      const Vec3 middle = ray.origin + 0.5 * (piece.t0() + piece.t1()) * ray.direction;
      result += left * (Color(1) - gone) * source_at(values, *grid, middle, seen);
      if (asks_sources) {
        scattered += max_component(left * (Color(1) - gone) * albedo);
        pieces.push_back({segment.medium, piece.t0(), piece.t1(), scattered, left});
      }
      left *= gone;
    }
  }
  if (scattered > 0) {
    // Farther away the greater u is, so that numbers that are spread evenly give points that are.
    const auto chosen =
        std::upper_bound(pieces.begin(), pieces.end() - 1, u * scattered,
                         [](double part, const Piece& piece) { return part < piece.scattered; });
    const double before = chosen == pieces.begin() ? 0 : (chosen - 1)->scattered,
                 here = chosen->scattered - before;
    if (!(here > 0)) return result;
    const double within = std::clamp((u * scattered - before) / here, 0.0, 1.0);
    const ParticipatingMedium& medium = scene_.media[chosen->medium];
    lit.medium = chosen->medium;
    lit.t = chosen->t0 + within * (chosen->t1 - chosen->t0);
    const double per_probability = (chosen->t1 - chosen->t0) * glm::length(ray.direction) * scattered / here;
    lit.throughput =
        per_probability * density_at(scene_, medium, ray.origin + lit.t * ray.direction) * medium.scattering *
        chosen->left *
        attenuation(density_along(scene_, ray, {lit.medium, chosen->t0, lit.t}) * medium.extinction());
  }
  return result;
}

}  // namespace rayfarm
