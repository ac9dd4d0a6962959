#include "common/lighting/zones/zone_map.h"

#include <fmt/core.h>

#include <stdexcept>

#include "common/hierarchy/primitive_bounds.h"
#include "common/lighting/face_corners.h"
#include "common/lighting/zones/zone_directions.h"

namespace rayfarm {
namespace {

/// How many cells there are about if no size is asked for, where primitives are large enough.
constexpr double kUsualCells = 10'000;

/// Points along each side of a cell at which a curved one's area is measured.
constexpr uint32_t kAreaPoints = 8;

size_t kind_of(PrimitiveId id) {
  return static_cast<size_t>(id.kind());
}

struct PlanePolygon {
  Gathered<Vec3> points;
  Vec3 normal;
};

PlanePolygon polygon_of(const Scene& scene, PrimitiveId id) {
  if (id.kind() == PrimitiveKind::face) {
    Gathered<Vec3> points = points_of(scene, scene.mesh_faces[id.index()]);
    const Vec3 normal = normalized(newell_normal(points.span()));
    return {std::move(points), normal};
  }
  const std::span<const Vec3> of = scene.points_of(scene.polygons[id.index()]);
  Gathered<Vec3> points(of.size());
  for (size_t i = 0; i < of.size(); ++i) points[i] = of[i];
  return {std::move(points), scene.polygons[id.index()].normal};
}

}  // namespace

ZoneStore store_of(const Scene& scene, const Material& material) {
  if (material.kind == MaterialKind::mix) {
    ZoneStore both;
    for (const uint32_t part : material.parts) {
      const ZoneStore store = store_of(scene, scene.materials[part]);
      both.is_diffuse |= store.is_diffuse;
      both.direction_cells = std::max(both.direction_cells, store.direction_cells);
    }
    return both;
  }
  ZoneStore store;
  store.is_diffuse = is_luminaire(material);  // what it emits may be shot from its zones
  for (const bool is_front : {true, false}) {
    Lobes lobes;
    scatter(material,
            {Vec3(0, 0, 1), Vec3(0, 0, 1), is_front, is_front ? material.index : 1 / material.index}, lobes);
    for (const Lobe& lobe : lobes) {
      if (lobe.attenuation == Color(0)) continue;
      if (lobe.spread == Lobe::Spread::diffuse) store.is_diffuse = true;
      if (lobe.spread == Lobe::Spread::glossy)
        store.direction_cells = std::max(store.direction_cells, direction_cells_for(lobe.exponent));
    }
  }
  return store;
}

ZoneMap::ZoneMap(const Scene& scene, const Pose& pose, const ZoneSettings& settings, bool has_directions)
    : scene_(scene), pose_(pose) {
  find_primitives(settings);
  size_ = settings.size > 0 ? settings.size : find_size();
  most_cells_ = settings.most_bytes() / (sizeof(double) + 2 * slot_bytes(1));
  make_cells(has_directions);
}

void ZoneMap::find_primitives(const ZoneSettings& settings) {
  parts_.resize(scene_.parts.size());
  for (size_t i = 0; i < parts_.size(); ++i) {
    PartTable& table = parts_[i];
    std::array<uint32_t, 5> most{};
    table.least.fill(kNone);
    for_each_named(scene_, scene_.parts[i], [&](PrimitiveId id, uint32_t) {
      table.least[kind_of(id)] = std::min(table.least[kind_of(id)], id.index());
      most[kind_of(id)] = std::max(most[kind_of(id)], id.index());
    });
    for (size_t kind = 0; kind < 5; ++kind) {
      table.first[kind] = table.grids;
      if (table.least[kind] != kNone) table.count[kind] = most[kind] - table.least[kind] + 1;
      table.grids += table.count[kind];
    }
  }
  uint64_t grids = 0;
  for (const Instance& instance : scene_.instances) {
    first_grid_.push_back(static_cast<uint32_t>(grids));
    grids += parts_[instance.part].grids;
    if (grids >= kNone) throw std::runtime_error("the scene has too many primitives for zones");
  }
  if (grids * sizeof(ZoneGrid) > settings.most_bytes())
    throw std::runtime_error(
        fmt::format("{} primitives, each copy counted, are too many for zones in {:g} GiB: they take {:.1f} "
                    "GiB before they are cut; more --zone-memory is needed",
                    grids, settings.most_GiB, static_cast<double>(grids * sizeof(ZoneGrid)) / 0x1p30));
  grids_.resize(grids);
  for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
    if (pose_[i].is_hidden) continue;
    const PartTable& table = parts_[scene_.instances[i].part];
    const Scene& shapes = pose_.shape_of(i, scene_);
    for_each_named(shapes, shapes.parts[scene_.instances[i].part], [&](PrimitiveId id, uint32_t block_lane) {
      ZoneGrid& grid =
          grids_[first_grid_[i] + table.first[kind_of(id)] + id.index() - table.least[kind_of(id)]];
      if (grid.primitive != kNoPrimitive && grid.block_lane <= block_lane) return;
      grid.instance = i;
      grid.primitive = id;
      grid.block_lane = block_lane;
      grid.material = material_of(scene_, id);
    });
  }
}

/// By the area of all that there is.
double ZoneMap::find_size() const {
  double area = 0;
  for (const ZoneGrid& grid : grids_) {
    if (grid.primitive == kNoPrimitive) continue;
    const InstancePose& place = pose_[grid.instance];
    switch (grid.primitive.kind()) {
      case PrimitiveKind::triangle: {
        const std::array<Vec3, 3> v =
            triangle_vertices(pose_.shape_of(grid.instance, scene_), grid.block_lane);
        const Vec3 n = glm::cross(v[1] - v[0], v[2] - v[0]);
        area += 0.5 * glm::length(n) * area_scale(place, normalized(n));
        break;
      }
      case PrimitiveKind::polygon:
      case PrimitiveKind::face: {
        const PlanePolygon polygon = polygon_of(scene_, grid.primitive);
        area += 0.5 * glm::length(newell_normal(polygon.points.span())) * area_scale(place, polygon.normal);
        break;
      }
      default: {
        const Box& box = place.is_identity
                             ? bounds_of(scene_, grid.primitive)
                             : transform(place.world_from_object, bounds_of(scene_, grid.primitive));
        area += box.area() / 2;
      }
    }
  }
  for (const ParticipatingMedium& medium : scene_.media) area += medium.box.area();
  return area > 0 && std::isfinite(area) ? std::sqrt(area / kUsualCells) : 1;
}

double ZoneMap::parts_of(const ZoneGrid& grid, double length) const {
  return std::max(1.0, std::ceil(length / size_of(grid) * (1 - 1e-9)));
}

double ZoneMap::size_of(const ZoneGrid& grid) const {
  const double own = scene_.materials[grid.material].zone_size;
  return own > 0 ? own : size_;
}

/// Cells that are asked for may be beyond all bounds.
void ZoneMap::reserve_cells(ZoneGrid& grid, double columns, double rows, bool is_triangle) {
  if (!(columns * rows + static_cast<double>(areas_.size()) < static_cast<double>(most_cells_)) ||
      !((columns + 1) * (rows + 1) + static_cast<double>(corners_) < kNone)) {
    throw std::runtime_error(fmt::format(
        "zones of size {:g} would be more than {}, which is what the memory for them holds; {}, or more "
        "--zone-memory, is needed",
        size_of(grid), most_cells_,
        scene_.materials[grid.material].zone_size > 0 ? "larger `zones` in the scene"
                                                      : "a larger --zone-size"));
  }
  grid.first_cell = static_cast<uint32_t>(areas_.size());
  grid.cell_count = static_cast<uint32_t>(columns * rows);
  grid.first_corner = static_cast<uint32_t>(corners_);
  grid.corner_count = is_triangle ? TriangleCells::corner_count(static_cast<uint32_t>(columns))
                                  : static_cast<uint32_t>((columns + 1) * (rows + 1));
  corners_ += grid.corner_count;
}

void ZoneMap::make_cells(bool has_directions) {
  std::vector<ZoneStore> stores;
  for (const Material& material : scene_.materials) stores.push_back(store_of(scene_, material));
  for (uint32_t i = 0; i < grids_.size(); ++i) {
    ZoneGrid& grid = grids_[i];
    if (grid.primitive == kNoPrimitive) continue;
    grid.store = stores[grid.material];
    if (!has_directions) grid.store.direction_cells = 0;
    switch (grid.primitive.kind()) {
      case PrimitiveKind::triangle:
        make_triangle(grid);
        break;
      case PrimitiveKind::polygon:
      case PrimitiveKind::face:
        make_plane(grid);
        break;
      default:
        make_revolved(grid);
    }
    if (grid.shape == ZoneShape::none) {
      grid.store = {};
      continue;
    }
    grid.first_slot = slots_;
    slots_ += 2 * uint64_t{grid.cell_count} * grid.store.slots();
    grid_order_.push_back(i);
  }
}

void ZoneMap::make_triangle(ZoneGrid& grid) {
  const InstancePose& place = pose_[grid.instance];
  const std::array<Vec3, 3> v = triangle_vertices(pose_.shape_of(grid.instance, scene_), grid.block_lane);
  double longest = 0;
  for (size_t i = 0; i < 3; ++i) {
    const Vec3 edge = v[(i + 1) % 3] - v[i];
    longest = std::max(longest, glm::length(place.is_identity ? edge : place.world_from_object.vector(edge)));
  }
  const double parts = parts_of(grid, longest);
  reserve_cells(grid, parts, parts, true);
  grid.shape = ZoneShape::triangle;
  grid.record = static_cast<uint32_t>(parts);
  const Vec3 n = glm::cross(v[1] - v[0], v[2] - v[0]);
  const double area = 0.5 * glm::length(n) * area_scale(place, normalized(n)) / grid.cell_count;
  areas_.insert(areas_.end(), grid.cell_count, area);
}

void ZoneMap::make_plane(ZoneGrid& grid) {
  const InstancePose& place = pose_[grid.instance];
  const PlanePolygon polygon = polygon_of(scene_, grid.primitive);
  PlaneCells plane = rectangle_about(polygon.points.span(), polygon.normal);
  const auto world_length = [&](const Vec3& v) {
    return glm::length(place.is_identity ? v : place.world_from_object.vector(v));
  };
  const double columns = parts_of(grid, plane.step.x * world_length(plane.x)),
               rows = parts_of(grid, plane.step.y * world_length(plane.y));
  reserve_cells(grid, columns, rows, false);
  cut(plane, static_cast<uint32_t>(columns), static_cast<uint32_t>(rows), polygon.points.span(),
      polygon.normal);
  grid.shape = ZoneShape::plane;
  grid.record = static_cast<uint32_t>(planes_.size());
  const double scale = area_scale(place, polygon.normal);
  const size_t first = areas_.size();
  areas_.resize(first + grid.cell_count);
  for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
    areas_[first + (plane.stands_for.empty() ? cell : plane.stands_for[cell])] += scale * plane.area(cell);
  planes_.push_back(std::move(plane));
}

RevolvedCells::Point ZoneMap::revolved_point(const ZoneGrid& grid, const RevolvedCells& cells,
                                             const Vec2& uv) const {
  const bool is_sphere = grid.primitive.kind() == PrimitiveKind::sphere;
  const Quadric* const quadric = is_sphere ? nullptr : &scene_.quadrics[grid.primitive.index()];
  RevolvedCells::Point point =
      cells.at(uv, quadric, quadric ? scene_.planes_of(*quadric) : std::span<const Vec4>{});
  if (point.density > 0) point.density *= area_scale(pose_[grid.instance], point.normal);
  return point;
}

void ZoneMap::make_revolved(ZoneGrid& grid) {
  const InstancePose& place = pose_[grid.instance];
  std::optional<RevolvedCells> found;
  if (grid.primitive.kind() == PrimitiveKind::sphere) {
    found = revolved(scene_.spheres[grid.primitive.index()]);
  } else {
    const Quadric& quadric = scene_.quadrics[grid.primitive.index()];
    found = find_axis(quadric, scene_.planes_of(quadric));
  }
  if (!found) return;
  // How long it is along its axis and about it, in the world, measured along lines.
  constexpr int kLinePoints = 64;
  double about = 0, along = 0;
  const auto world = [&](const Vec3& p) { return place.is_identity ? p : place.world_from_object.point(p); };
  for (int line = 0; line < 4; ++line) {
    double length = 0;
    std::optional<Vec3> before;
    for (int i = 0; i <= kLinePoints; ++i) {
      const auto point = revolved_point(grid, *found, {line / 4.0, static_cast<double>(i) / kLinePoints});
      if (!(point.density > 0)) continue;
      const Vec3 p = world(point.p);
      if (before) length += glm::length(p - *before);
      before = p;
      const Vec3 z = glm::dot(point.p - found->center, found->axes[2]) * found->axes[2];
      about = std::max(about, 2 * std::numbers::pi * glm::length(p - world(found->center + z)));
    }
    along = std::max(along, length);
  }
  const double columns = std::max(4.0, parts_of(grid, about)), rows = std::max(2.0, parts_of(grid, along));
  reserve_cells(grid, columns, rows, false);
  found->columns = static_cast<uint32_t>(columns);
  found->rows = static_cast<uint32_t>(rows);
  found->most_density.resize(grid.cell_count);
  for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
    double sum = 0, most = 0;
    for (uint32_t i = 0; i < kAreaPoints; ++i)
      for (uint32_t j = 0; j < kAreaPoints; ++j) {
        const Vec2 in_cell((i + 0.5) / kAreaPoints, (j + 0.5) / kAreaPoints);
        const Vec2 uv = (Vec2(cell % found->columns, cell / found->columns) + in_cell) / Vec2(columns, rows);
        const double density = revolved_point(grid, *found, uv).density;
        sum += density;
        most = std::max(most, density);
      }
    areas_.push_back(sum / (kAreaPoints * kAreaPoints * columns * rows));
    found->most_density[cell] = static_cast<float>(1.125 * most);
  }
  grid.shape = ZoneShape::revolved;
  grid.record = static_cast<uint32_t>(revolved_.size());
  revolved_.push_back(std::move(*found));
}

const ZoneGrid* ZoneMap::grid_of(const Hit& hit) const {
  const PartTable& table = parts_[scene_.instances[hit.instance].part];
  const size_t kind = kind_of(hit.primitive);
  const ZoneGrid& grid =
      grids_[first_grid_[hit.instance] + table.first[kind] + hit.primitive.index() - table.least[kind]];
  return grid.shape == ZoneShape::none ? nullptr : &grid;
}

uint32_t ZoneMap::grid_of_cell(uint64_t cell) const {
  return *(std::upper_bound(grid_order_.begin(), grid_order_.end(), cell,
                            [&](uint64_t c, uint32_t grid) { return c < grids_[grid].first_cell; }) -
           1);
}

SlotPlace ZoneMap::place_of_slot(uint64_t slot) const {
  const auto found = std::upper_bound(grid_order_.begin(), grid_order_.end(), slot,
                                      [&](uint64_t s, uint32_t grid) { return s < grids_[grid].first_slot; });
  const uint32_t index = *(found - 1);
  const ZoneGrid& grid = grids_[index];
  const uint64_t in_grid = slot - grid.first_slot, slots = grid.store.slots();
  return {index, static_cast<uint32_t>(in_grid / slots / 2), static_cast<uint32_t>(in_grid / slots % 2),
          static_cast<uint32_t>(in_grid % slots)};
}

}  // namespace rayfarm
