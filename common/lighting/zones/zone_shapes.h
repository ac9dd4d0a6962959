#pragma once
// Primitives as grids of cells over their parameters (u, v), in their objects' space: which cell a point is
// in, which corners of cells are about it, and points all over a cell. Triangles have k² cells of their own
// shape; other polygons the cells of a rectangle about them, clipped; spheres and quadrics cells of the angle
// about an axis and the height along it.
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/hierarchy/hit.h"
#include "common/lighting/surface.h"

namespace rayfarm {

/// Where a point is among cells: `x` of columns, `y` of rows.
using GridPlace = Vec2;

/// Corners of cells about a point, and their weights, which sum up to 1.
struct CellCorners {
  std::array<uint32_t, 4> corner{};
  std::array<double, 4> weight{};
};

/// Cells whose middles are about a point, and their weights, which sum up to 1.
struct NearCells {
  std::array<uint32_t, 4> cell{};
  std::array<double, 4> weight{1, 0, 0, 0};
};

/// A triangle's cells: each edge is cut into `parts`.
struct TriangleCells {
  std::array<Vec3, 3> vertices{};
  uint32_t parts = 1;

  static uint32_t cell_count(uint32_t parts) { return parts * parts; }
  static uint32_t corner_count(uint32_t parts) { return (parts + 1) * (parts + 2) / 2; }
  uint32_t cell_at(const GridPlace& place) const;
  CellCorners corners_at(const GridPlace& place) const;
  /// The corners of a cell, and where they are.
  std::array<uint32_t, 3> corners_of(uint32_t cell) const;
  Vec3 corner_point(uint32_t corner) const;
  /// Uniform on the cell.
  Vec3 point(uint32_t cell, const Vec2& u) const;

 private:
  struct Place {
    uint32_t column = 0, row = 0;
    bool is_upper = false;  ///< it hangs from the row's upper line
  };
  Place place_of(uint32_t cell) const;
  uint32_t corner(uint32_t column, uint32_t row) const {
    return row * (parts + 1) - row * (row - 1) / 2 + column;
  }
};

/// A triangle in the plane, of a cell that the polygon fills in part.
struct CellPiece {
  std::array<Vec2, 3> corners{};
  double area_through = 0;  ///< of it and the cell's pieces before it
};

/// A plane polygon's cells.
struct PlaneCells {
  Vec3 origin{0}, x{1, 0, 0}, y{0, 1, 0};  ///< unit
  Vec2 low{0}, step{1};                    ///< of the rectangle about it, and of a cell
  uint32_t columns = 1, rows = 1;
  /// Where the pieces of each cell begin, and behind the last: empty if the polygon fills the rectangle.
  std::vector<uint32_t> first_piece;
  std::vector<CellPiece> pieces;
  /// Cells of which the polygon has little stand for the largest neighbour; empty as above.
  std::vector<uint32_t> stands_for;

  GridPlace place_of(const Vec3& p) const;
  double area(uint32_t cell) const;
  Vec3 point(uint32_t cell, Vec2 u) const;
  Vec3 at(const Vec2& p) const { return origin + p.x * x + p.y * y; }
};

/// A quadric about an axis: a z² + 2 b z + c + q₀ x² + q₁ y² = 0, in axes of its own, q above 0.
struct RevolvedCells {
  Vec3 center{0};
  std::array<Vec3, 3> axes{};  ///< unit; the last is z
  double a = 0, b = 0, c = 0;
  std::array<double, 2> q{1, 1};
  double low = 0, high = 0;  ///< of z
  uint32_t columns = 1, rows = 1;
  std::vector<float> most_density;  ///< of each cell: the largest that was seen, with something to spare

  GridPlace place_of(const Vec3& p) const;
  struct Point {
    Vec3 p{0}, normal{0};  ///< unit
    double density = 0;    ///< area per part of the turn and part of the height; 0: there is nothing
  };
  /// At (u, v) in [0, 1]². `quadric`: what it is of, whose planes cut it; null: a sphere.
  Point at(const Vec2& uv, const Quadric* quadric, std::span<const Vec4> planes) const;
};

/// The axis of a quadric and how far it goes. Empty: no axis has the surface all round it, as with saddles
/// and planes.
std::optional<RevolvedCells> find_axis(const Quadric& quadric, std::span<const Vec4> planes);
RevolvedCells revolved(const SphereRecord& sphere);

/// The rectangle about a polygon, along its first edge. One cell, no pieces.
PlaneCells rectangle_about(std::span<const Vec3> points, const Vec3& normal);
/// Cuts it into cells.
void cut(PlaneCells& plane, uint32_t columns, uint32_t rows, std::span<const Vec3> points,
         const Vec3& normal);

/// Of cells in columns and rows.
uint32_t cell_at(const GridPlace& place, uint32_t columns, uint32_t rows);
CellCorners corners_at(const GridPlace& place, uint32_t columns, uint32_t rows);
/// `is_round`: the last column is beside the first.
NearCells cells_about(const GridPlace& place, uint32_t columns, uint32_t rows, bool is_round);

}  // namespace rayfarm
