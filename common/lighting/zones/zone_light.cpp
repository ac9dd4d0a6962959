#include "common/lighting/zones/zone_light.h"

#include <numbers>
#include <unordered_map>

#include "common/sampling/random.h"

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

/// Corners so near to each other, in parts of the scene's size, are one.
constexpr double kCornerGrid = 0x1p-24;

/// What tells corners apart. Rounding is askew, so that places that scenes prefer are not on its edges.
struct CornerKey {
  std::array<int64_t, 3> p{};
  std::array<int32_t, 3> normal{};
  uint32_t material = 0;
  bool operator==(const CornerKey&) const = default;
};
struct CornerHash {
  size_t operator()(const CornerKey& key) const {
    uint64_t h = key.material;
    for (size_t i = 0; i < 3; ++i)
      h = mix_bits(mix_bits(h ^ static_cast<uint64_t>(key.p[i])) ^ static_cast<uint32_t>(key.normal[i]));
    return h;
  }
};

}  // namespace

ZoneLight::ZoneLight(const ZoneScene& zones, size_t pass, const ZonePassSolution& solution, ZoneView view)
    : scene_(zones.scene(pass)),
      map_(zones.map()),
      media_(zones.media()),
      colors_(zones.scene(pass), zones.map()),
      view_(view),
      values_(zones.slot_count(), glm::vec3(0)) {
  solution.total.for_each([&](uint64_t slot, const Power& total) {
    Power power = total;
    if (view == ZoneView::direct) power -= solution.direct.at(slot);
    values_[slot] = solution.quantum.value(power) * per_power(slot);
  });
  for (const ZoneGrid& grid : map_.grids()) {
    if (!grid.store.is_diffuse || !colors_.is_textured(grid)) continue;
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
      for (uint32_t side = 0; side < 2; ++side) {
        glm::vec3& value = values_[grid.slot(cell, side)];
        value = over(value, colors_(grid, cell).reflected[side] + colors_(grid, cell).through);
      }
  }
  if (view != ZoneView::flat) find_corners();
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

void ZoneLight::find_corners() {
  shared_corner_.assign(map_.corner_count(), kNone);
  Box bounds;
  for (uint32_t i = 0; i < map_.scene().instances.size(); ++i)
    if (!map_.pose()[i].is_hidden) bounds.grow(map_.pose()[i].bounds);
  const double step = kCornerGrid * std::max(max_component(bounds.extent()), bounds.magnitude() * 1e-8);
  std::unordered_map<CornerKey, uint32_t, CornerHash> numbers;
  std::vector<std::array<double, 2>> areas;
  std::vector<std::array<Color, 2>> sums;
  for (const ZoneGrid& grid : map_.grids()) {
    if (!grid.store.is_diffuse) continue;
    const InstancePose& place = map_.pose()[grid.instance];
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
      const double area = map_.area(grid, cell);
      if (!(area > 0)) continue;
      for (const uint32_t corner : map_.corners_of(grid, cell)) {
        uint32_t& shared = shared_corner_[grid.first_corner + corner];
        if (shared == kNone) {
          const ZoneMap::Corner at = map_.corner(grid, corner);
          const Vec3 p = place.is_identity ? at.p : place.world_from_object.point(at.p);
          const Vec3 normal = place.is_identity
                                  ? at.normal
                                  : normalized(place.object_from_world.normal_by_inverse(at.normal));
          CornerKey key;
          key.material = grid.material;
          for (int i = 0; i < 3; ++i) {
            key.p[static_cast<size_t>(i)] = static_cast<int64_t>(std::floor(p[i] / step + 0.381966));
            key.normal[static_cast<size_t>(i)] =
                static_cast<int32_t>(std::floor(normal[i] * 1000 + 0.381966));
          }
          shared = numbers.emplace(key, static_cast<uint32_t>(areas.size())).first->second;
          if (shared == areas.size()) {
            areas.emplace_back();
            sums.push_back({Color(0), Color(0)});
          }
        }
        for (uint32_t side = 0; side < 2; ++side) {
          areas[shared][side] += area;
          sums[shared][side] += area * Color(kept_diffusely(grid, cell, side));
        }
      }
    }
  }
  for (size_t i = 0; i < areas.size(); ++i)
    for (size_t side = 0; side < 2; ++side) corner_values_.push_back(sums[i][side] / areas[i][side]);
}

Color ZoneLight::diffuse(const ZoneGrid& grid, const GridPlace& place, uint32_t side) const {
  if (view_ == ZoneView::flat) return kept_diffusely(grid, map_.cell_at(grid, place), side);
  const CellCorners corners = map_.corners_at(grid, place);
  Color sum(0);
  double weight = 0;
  for (size_t i = 0; i < 4; ++i) {
    const uint32_t shared = shared_corner_[grid.first_corner + corners.corner[i]];
    if (shared == kNone || !(corners.weight[i] > 0)) continue;  // only cells without an area are about it
    sum += corners.weight[i] * Color(corner_values_[2 * size_t{shared} + side]);
    weight += corners.weight[i];
  }
  return weight > 0 ? sum / weight : Color(kept_diffusely(grid, map_.cell_at(grid, place), side));
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

/// Linear between the middles of cells, and of cells of directions.
Color ZoneLight::source_at(const MediumGrid& grid, const Vec3& p, const Vec3& to_viewer) const {
  const Vec3 place = (p - scene_.media[grid.medium].box.lo) / grid.step;
  const uint32_t directions = grid.directions.count(), rows = grid.directions.rows, columns = 2 * rows;
  const auto in_cell = [&](const std::array<uint32_t, 3>& cell) -> Color {
    const uint64_t first = map_.slot_count() + grid.slot(grid.index(cell));
    if (directions == 1) return values_[first];
    if (view_ == ZoneView::flat) return values_[first + grid.directions.cell(to_viewer)];
    const Vec2 at = grid.directions.place(to_viewer) - Vec2(0.5);
    const double row = std::clamp(at.y, 0.0, rows - 1.0), column = at.x < 0 ? at.x + columns : at.x;
    const auto i = std::min(static_cast<uint32_t>(column), columns - 1),
               j = std::min(static_cast<uint32_t>(row), rows - 2);
    const double fx = column - i, fy = row - j;
    const auto value = [&](uint32_t x, uint32_t y) {
      return Color(values_[first + y * columns + x % columns]);
    };
    return (1 - fy) * ((1 - fx) * value(i, j) + fx * value(i + 1, j)) +
           fy * ((1 - fx) * value(i, j + 1) + fx * value(i + 1, j + 1));
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

Color ZoneLight::radiance_of_media(const Ray& ray, double u, LitMediumPoint& lit) const {
  Color result(0), left(1);
  double scattered = 0, left_of_u = u;  // scattered: by all pieces so far
  struct {
    double t0 = 0, t1 = 0, scattered = 0;
    Color left{0};
  } chosen;
  for (const MediumSegment& segment : media_along(scene_, ray)) {
    const ParticipatingMedium& medium = scene_.media[segment.medium];
    const MediumGrid* const grid = media_.find(segment.medium);
    if (!grid) {
      left *= attenuation(density_along(scene_, ray, segment) * medium.extinction());
      continue;
    }
    const Color albedo = over(medium.scattering, medium.extinction());
    GridWalk piece(ray, segment.t0, segment.t1, medium.box.lo, grid->step, grid->count);
    while (piece.next()) {
      const Color gone = attenuation(density_along(scene_, ray, {segment.medium, piece.t0(), piece.t1()}) *
                                     medium.extinction());
      const Vec3 middle = ray.origin + 0.5 * (piece.t0() + piece.t1()) * ray.direction;
      result += left * (Color(1) - gone) * source_at(*grid, middle, -normalized(ray.direction));
      if (view_ == ZoneView::direct) {
        // One piece of all, each by what it scatters; u is used up by and by.
        const double here = max_component(left * (Color(1) - gone) * albedo);
        scattered += here;
        const double chance = scattered > 0 ? here / scattered : 0;
        if (left_of_u < chance || chance >= 1) {
          lit.medium = segment.medium;
          chosen = {piece.t0(), piece.t1(), here, left};
          left_of_u /= chance;
        } else if (chance > 0) {
          left_of_u = (left_of_u - chance) / (1 - chance);
        }
      }
      left *= gone;
    }
  }
  if (lit.medium != kNone) {
    const ParticipatingMedium& medium = scene_.media[lit.medium];
    lit.t = chosen.t0 + std::min(left_of_u, 1.0) * (chosen.t1 - chosen.t0);
    const double per_probability =
        (chosen.t1 - chosen.t0) * glm::length(ray.direction) * scattered / chosen.scattered;
    lit.throughput =
        per_probability * density_at(scene_, medium, ray.origin + lit.t * ray.direction) * medium.scattering *
        chosen.left *
        attenuation(density_along(scene_, ray, {lit.medium, chosen.t0, lit.t}) * medium.extinction());
  }
  return result;
}

}  // namespace rayfarm
