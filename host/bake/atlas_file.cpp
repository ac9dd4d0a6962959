#include "host/bake/atlas_file.h"

#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <iterator>
#include <numeric>

#include "common/errors/input_error.h"
#include "common/image/image_file.h"
#include "host/files/json.h"

namespace rayfarm {
namespace {

constexpr uint64_t kMostAtlasSide = 1 << 20, kMostRectangles = 1 << 24;  // floats count no further

std::array<uint32_t, 2> size_of(const ZoneMap& map, const ZoneGrid& grid) {
  if (grid.shape == ZoneShape::triangle) return {grid.record, grid.record};
  if (grid.shape == ZoneShape::revolved)
    return {map.revolved_cells(grid).columns, map.revolved_cells(grid).rows};
  return {map.plane_cells(grid).columns, map.plane_cells(grid).rows};
}

const char* name_of(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::triangle:
      return "triangle";
    case PrimitiveKind::sphere:
      return "sphere";
    case PrimitiveKind::quadric:
      return "quadric";
    case PrimitiveKind::polygon:
      return "polygon";
    case PrimitiveKind::face:
      return "face";
    case PrimitiveKind::collection:  // has no zones
      break;
  }
  return "";
}

/// Points that tell where the rectangle's cells are, in the world.
std::vector<Vec3> points_of(const ZoneMap& map, const ZoneGrid& grid) {
  std::vector<Vec3> points;
  if (grid.shape == ZoneShape::triangle) {
    const auto& v = map.triangle_cells(grid).vertices;
    points.assign(v.begin(), v.end());
  } else if (grid.shape == ZoneShape::plane) {
    const PlaneCells& plane = map.plane_cells(grid);
    const Vec2 size = plane.step * Vec2(plane.columns, plane.rows);
    points = {plane.at(plane.low), plane.at(plane.low + Vec2(size.x, 0)),
              plane.at(plane.low + Vec2(0, size.y))};
  } else {
    const RevolvedCells& cells = map.revolved_cells(grid);
    const Vec3 low = cells.center + cells.low * cells.axes[2];
    points = {low, cells.center + cells.high * cells.axes[2], low + cells.axes[0], low + cells.axes[1]};
  }
  const InstancePose& place = map.pose()[grid.instance];
  if (!place.is_identity)
    for (Vec3& p : points) p = place.world_from_object.point(p);
  return points;
}

std::string describe(const ZoneMap& map, const AtlasLayout& layout, const AtlasNames& names) {
  std::string text = fmt::format("{{\"objects\":{},\"materials\":{},\"rectangles\":[",
                                 Json(names.objects).dump(), Json(names.materials).dump());
  auto out = std::back_inserter(text);
  for (const AtlasRectangle& r : layout.rectangles) {
    const ZoneGrid& grid = map.grids()[r.grid];
    fmt::format_to(out,
                   "{}{{\"x\":{},\"y\":{},\"columns\":{},\"rows\":{},\"object\":{},\"material\":{},"
                   "\"kind\":\"{}\",\"index\":{},\"points\":[",
                   &r == layout.rectangles.data() ? "" : ",", r.x, r.y, r.columns, r.rows, grid.instance,
                   grid.material, name_of(grid.primitive.kind()), grid.primitive.index());
    const char* separator = "";
    for (const Vec3& p : points_of(map, grid)) {
      fmt::format_to(out, "{}[{},{},{}]", separator, p.x, p.y, p.z);
      separator = ",";
    }
    text += "]}";
  }
  return text + "]}";
}

}  // namespace

AtlasLayout lay_out_atlas(const ZoneMap& map) {
  AtlasLayout layout;
  uint64_t texels = 0, widest = 0;
  for (uint32_t i = 0; i < map.grids().size(); ++i) {
    const ZoneGrid& grid = map.grids()[i];
    if (grid.shape == ZoneShape::none) continue;
    const auto [columns, rows] = size_of(map, grid);
    layout.rectangles.push_back({i, 0, 0, columns, rows});
    texels += uint64_t{2} * columns * rows;
    widest = std::max(widest, uint64_t{2} * columns);
  }
  const uint64_t width =
      std::max(widest, static_cast<uint64_t>(std::ceil(std::sqrt(static_cast<double>(texels)))));
  std::vector<uint32_t> order(layout.rectangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return layout.rectangles[a].rows > layout.rectangles[b].rows;
  });
  uint64_t x = 0, y = 0, shelf = 0;
  for (const uint32_t i : order) {
    AtlasRectangle& r = layout.rectangles[i];
    if (x + uint64_t{2} * r.columns > width) {
      y += shelf;
      x = shelf = 0;
    }
    r.x = static_cast<uint32_t>(x);
    r.y = static_cast<uint32_t>(y);
    x += uint64_t{2} * r.columns;
    shelf = std::max<uint64_t>(shelf, r.rows);
  }
  if (width > kMostAtlasSide || y + shelf > kMostAtlasSide || order.size() >= kMostRectangles)
    throw std::runtime_error(
        fmt::format("an atlas of {} × {} texels and {} rectangles is more than can be written ({} a side, {} "
                    "rectangles); a larger --zone-size is needed",
                    width, y + shelf, order.size(), kMostAtlasSide, kMostRectangles));
  layout.width = static_cast<uint32_t>(width);
  layout.height = static_cast<uint32_t>(y + shelf);
  return layout;
}

std::array<uint32_t, 2> texel_of(const ZoneMap& map, const ZoneGrid& grid, uint32_t cell) {
  const auto [columns, rows] = size_of(map, grid);
  if (grid.shape != ZoneShape::triangle) return {cell % columns, cell / columns};
  const auto [column, row, is_upper] = map.triangle_cells(grid).place_of(cell);
  if (is_upper) return {columns - 1 - column, rows - 1 - row};
  return {column, row};
}

void write_atlas(const std::string& path, const ZoneMap& map, const BakedLight& light,
                 const AtlasLayout& layout, const AtlasNames& names,
                 std::map<std::string, std::string> attributes) {
  Image image;
  image.width_px = static_cast<int>(layout.width);
  image.height_px = static_cast<int>(layout.height);
  image.window = {0, 0, image.width_px, image.height_px};
  for (const char* name : {"R", "G", "B", "id"}) {
    image.layout.channels.push_back({name, PixelFormat::float32, image.layout.bytes});
    image.layout.bytes += sizeof(float);
  }
  image.pixels.resize(image.layout.bytes * layout.width * layout.height);
  for (size_t i = 0; i < layout.rectangles.size(); ++i) {
    const AtlasRectangle& r = layout.rectangles[i];
    const ZoneGrid& grid = map.grids()[r.grid];
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
      const uint32_t shown = grid.shape == ZoneShape::plane && !map.plane_cells(grid).stands_for.empty()
                                 ? map.plane_cells(grid).stands_for[cell]
                                 : cell;
      if (!(map.area(grid, shown) > 0)) continue;
      const auto [column, row] = texel_of(map, grid, cell);
      for (uint32_t side = 0; side < 2; ++side) {
        const glm::vec3 radiance(light.of_cell(grid, shown, side));
        const std::array<float, 4> texel{radiance.x, radiance.y, radiance.z, static_cast<float>(i + 1)};
        const size_t at = (size_t{r.y} + row) * layout.width + r.x + side * r.columns + column;
        std::memcpy(image.pixels.data() + at * sizeof texel, texel.data(), sizeof texel);
      }
    }
  }
  try {
    attributes["rayfarm/atlas"] = describe(map, layout, names);
  } catch (const JsonError& e) {
    throw IoError(fmt::format("{}: can't be written: a name in the scene is no text ({})", path, e.what()));
  }
  write_image(path, image, attributes);
}

}  // namespace rayfarm
