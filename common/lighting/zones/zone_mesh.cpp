#include "common/lighting/zones/zone_mesh.h"

#include <map>

namespace rayfarm {
namespace {

/// Rows between those of zones are halved this often at most.
constexpr int kMostHalvings = 8;

/// Triangles of a grid of points, whose places rise along columns and rows.
void add_quads(ZoneMesh& mesh, uint32_t columns, uint32_t rows) {
  for (uint32_t row = 0; row < rows; ++row)
    for (uint32_t column = 0; column < columns; ++column) {
      const uint32_t first = row * (columns + 1) + column, above = first + columns + 1;
      mesh.triangles.push_back({first, first + 1, above + 1});
      mesh.triangles.push_back({first, above + 1, above});
    }
}

ZoneMesh mesh_of_triangle(const TriangleCells& cells) {
  ZoneMesh mesh;
  uint32_t corner = 0;
  for (uint32_t row = 0; row <= cells.parts; ++row)
    for (uint32_t column = 0; column <= cells.parts - row; ++column)
      mesh.vertices.push_back({cells.corner_point(corner++), GridPlace(column, row)});
  for (uint32_t cell = 0; cell < TriangleCells::cell_count(cells.parts); ++cell)
    mesh.triangles.push_back(cells.corners_of(cell));
  return mesh;
}

ZoneMesh mesh_of_plane(const PlaneCells& plane) {
  ZoneMesh mesh;
  if (plane.first_piece.empty()) {
    for (uint32_t row = 0; row <= plane.rows; ++row)
      for (uint32_t column = 0; column <= plane.columns; ++column) {
        const GridPlace place(column, row);
        mesh.vertices.push_back({plane.at(plane.low + place * plane.step), place});
      }
    add_quads(mesh, plane.columns, plane.rows);
    return mesh;
  }
  std::map<std::pair<double, double>, uint32_t> numbers;
  for (const CellPiece& piece : plane.pieces) {
    std::array<uint32_t, 3> triangle{};
    for (size_t i = 0; i < 3; ++i) {
      const Vec2& at = piece.corners[i];
      const auto [found, is_new] =
          numbers.try_emplace({at.x, at.y}, static_cast<uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back({plane.at(at), (at - plane.low) / plane.step});
      triangle[i] = found->second;
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// What is left of a mesh where n · p <= w.
void clip(ZoneMesh& mesh, const Vec4& plane, double tolerance) {
  std::vector<double> beyond;
  for (const ZoneMesh::Vertex& v : mesh.vertices) {
    const double d = glm::dot(Vec3(plane), v.p) - plane.w;
    beyond.push_back(std::abs(d) <= tolerance * glm::length(Vec3(plane)) ? 0 : d);
  }
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> cuts;  // by edge, so that neighbours share them
  const auto cut = [&](uint32_t a, uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [found, is_new] = cuts.try_emplace({a, b}, static_cast<uint32_t>(mesh.vertices.size()));
    if (is_new) {
      const double t = beyond[a] / (beyond[a] - beyond[b]);
      const ZoneMesh::Vertex va = mesh.vertices[a], vb = mesh.vertices[b];
      mesh.vertices.push_back({va.p + t * (vb.p - va.p), va.place + t * (vb.place - va.place)});
    }
    return found->second;
  };
  std::vector<std::array<uint32_t, 3>> kept;
  for (const std::array<uint32_t, 3>& triangle : mesh.triangles) {
    InlineVector<uint32_t, 6> part;
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      if (beyond[a] <= 0) part.push_back(a);
      if ((beyond[a] < 0 && beyond[b] > 0) || (beyond[a] > 0 && beyond[b] < 0)) part.push_back(cut(a, b));
    }
    for (size_t i = 2; i < part.size(); ++i) kept.push_back({part[0], part[i - 1], part[i]});
  }
  mesh.triangles = std::move(kept);
}

class RoundMesh {
 public:
  RoundMesh(const RevolvedCells& cells, const Quadric* quadric) : cells_(cells), quadric_(quadric) {}

  ZoneMesh make(std::span<const Vec4> planes) {
    std::vector<double> rows{0};
    for (uint32_t row = 0; row < cells_.rows; ++row)
      add_rows(rows, static_cast<double>(row) / cells_.rows, static_cast<double>(row + 1) / cells_.rows, 0);
    const uint32_t in_cell =
        static_cast<uint32_t>(std::ceil(2 * std::numbers::pi / kFacetTurn / cells_.columns));
    const uint32_t columns = in_cell * cells_.columns;
    ZoneMesh mesh;
    std::vector<Vec3> normals;
    for (const double v : rows)
      for (uint32_t column = 0; column <= columns; ++column) {
        // The last column is the first again.
        const RevolvedCells::Point point = at({static_cast<double>(column % columns) / columns, v});
        mesh.vertices.push_back({point.p, Vec2(static_cast<double>(column) / in_cell, v * cells_.rows)});
        normals.push_back(point.normal);
      }
    add_quads(mesh, columns, static_cast<uint32_t>(rows.size() - 1));
    turn_to_front(mesh, normals);
    const double size = glm::length(mesh.vertices.front().p - cells_.center) + cells_.high - cells_.low;
    for (const Vec4& plane : planes) clip(mesh, plane, 1e-9 * size);
    return mesh;
  }

 private:
  /// Where rounding has nothing left the axis stands in.
  RevolvedCells::Point at(const Vec2& uv) const {
    RevolvedCells::Point point = cells_.at(uv, quadric_, {});
    if (!(point.density > 0)) {
      point.p = cells_.center + (cells_.low + uv.y * (cells_.high - cells_.low)) * cells_.axes[2];
      point.normal = Vec3(0);
    }
    return point;
  }

  void add_rows(std::vector<double>& rows, double from, double to, int halvings) {
    bool is_bent = false;
    for (const double u : {0.0, 0.25}) {
      const Vec3 a = at({u, from}).normal, b = at({u, to}).normal;
      is_bent |= glm::dot(a, b) < std::cos(kFacetTurn) && a != Vec3(0) && b != Vec3(0);
    }
    if (is_bent && halvings < kMostHalvings) {
      add_rows(rows, from, 0.5 * (from + to), halvings + 1);
      add_rows(rows, 0.5 * (from + to), to, halvings + 1);
      return;
    }
    rows.push_back(to);
  }

  /// Axes and gradients may have either hand. Facets without an area are left out.
  static void turn_to_front(ZoneMesh& mesh, std::span<const Vec3> normals) {
    std::vector<std::array<uint32_t, 3>> kept;
    for (std::array<uint32_t, 3> t : mesh.triangles) {
      const Vec3 n = glm::cross(mesh.vertices[t[1]].p - mesh.vertices[t[0]].p,
                                mesh.vertices[t[2]].p - mesh.vertices[t[0]].p);
      if (n == Vec3(0)) continue;
      if (glm::dot(n, normals[t[0]] + normals[t[1]] + normals[t[2]]) < 0) std::swap(t[1], t[2]);
      kept.push_back(t);
    }
    mesh.triangles = std::move(kept);
  }

  const RevolvedCells& cells_;
  const Quadric* quadric_;
};

ZoneMesh mesh_of_round(const ZoneMap& map, const ZoneGrid& grid) {
  const Scene& scene = map.scene();
  const Quadric* const quadric =
      grid.primitive.kind() == PrimitiveKind::sphere ? nullptr : &scene.quadrics[grid.primitive.index()];
  return RoundMesh(map.revolved_cells(grid), quadric)
      .make(quadric ? scene.planes_of(*quadric) : std::span<const Vec4>{});
}

}  // namespace

ZoneMesh mesh_of(const ZoneMap& map, const ZoneGrid& grid) {
  ZoneMesh mesh = grid.shape == ZoneShape::triangle ? mesh_of_triangle(map.triangle_cells(grid))
                  : grid.shape == ZoneShape::plane  ? mesh_of_plane(map.plane_cells(grid))
                                                    : mesh_of_round(map, grid);
  const InstancePose& place = map.pose()[grid.instance];
  if (place.is_identity) return mesh;
  for (ZoneMesh::Vertex& vertex : mesh.vertices) vertex.p = place.world_from_object.point(vertex.p);
  if (glm::determinant(place.world_from_object.linear) < 0)  // it is mirrored
    for (std::array<uint32_t, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

}  // namespace rayfarm
