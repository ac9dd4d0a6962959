#include "common/lighting/zones/zone_shapes.h"

#include <numbers>

#include "common/math/spherical.h"
#include "common/math/symmetric.h"
#include "common/sampling/warps.h"
#include "common/shapes/triangulate.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// Cells of which a polygon has less than this part stand for a neighbour.
constexpr double kLeastPart = 1.0 / 16;

double clamp_to(double x, uint32_t most) {
  return std::clamp(x, 0.0, static_cast<double>(most));
}

uint32_t floor_below(double x, uint32_t most) {
  return std::min(static_cast<uint32_t>(x), most - 1);
}

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// What is left of a convex polygon where sign · coordinate <= sign · limit.
void clip(std::vector<Vec2>& polygon, int axis, double sign, double limit) {
  std::vector<Vec2> kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = sign * (p[axis] - limit), dq = sign * (q[axis] - limit);
    if (dp <= 0) kept.push_back(p);
    if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) {
      Vec2 cut = p + dp / (dp - dq) * (q - p);
      cut[axis] = limit;
      kept.push_back(cut);
    }
  }
  polygon = std::move(kept);
}

}  // namespace

uint32_t cell_at(const GridPlace& place, uint32_t columns, uint32_t rows) {
  return floor_below(clamp_to(place.y, rows), rows) * columns +
         floor_below(clamp_to(place.x, columns), columns);
}

CellCorners corners_at(const GridPlace& place, uint32_t columns, uint32_t rows) {
  const double x = clamp_to(place.x, columns), y = clamp_to(place.y, rows);
  const uint32_t column = floor_below(x, columns), row = floor_below(y, rows);
  const double fx = x - column, fy = y - row;
  const uint32_t first = row * (columns + 1) + column, above = first + columns + 1;
  return {{first, first + 1, above, above + 1}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

NearCells cells_about(const GridPlace& place, uint32_t columns, uint32_t rows, bool is_round) {
  // Counted from the middle of the column, and the row, before the first.
  const double x = clamp_to(place.x, columns) + 0.5, y = clamp_to(place.y, rows) + 0.5;
  const auto column = static_cast<uint32_t>(x), row = static_cast<uint32_t>(y);
  const double fx = x - column, fy = y - row;
  const uint32_t before = column > 0 ? column - 1
                          : is_round ? columns - 1
                                     : 0,
                 behind = column < columns ? column
                          : is_round       ? 0
                                           : columns - 1,
                 below = row > 0 ? row - 1 : 0, above = std::min(row, rows - 1);
  return {{below * columns + before, below * columns + behind, above * columns + before,
           above * columns + behind},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

// Triangles: row j has 2 (k - j) - 1 cells, which stand and hang in turn; 2 k j - j² are before it.

uint32_t TriangleCells::cell_at(const GridPlace& place) const {
  const double x = clamp_to(place.x, parts), y = clamp_to(place.y, parts);
  const uint32_t row = floor_below(y, parts);
  const uint32_t column = std::min(static_cast<uint32_t>(x), parts - 1 - row);
  const bool is_upper = x - column + y - row > 1 && column + row + 1 < parts;
  return 2 * parts * row - row * row + 2 * column + (is_upper ? 1 : 0);
}

TriangleCells::Place TriangleCells::place_of(uint32_t cell) const {
  // The largest j with 2 k j - j² <= cell.
  const double k = parts;
  auto row = static_cast<uint32_t>(std::max(0.0, k - std::sqrt(std::max(0.0, k * k - cell))));
  while (row > 0 && 2 * parts * row - row * row > cell) --row;
  while (row + 1 < parts && 2 * parts * (row + 1) - (row + 1) * (row + 1) <= cell) ++row;
  const uint32_t in_row = cell - (2 * parts * row - row * row);
  return {in_row / 2, row, in_row % 2 == 1};
}

std::array<uint32_t, 3> TriangleCells::corners_of(uint32_t cell) const {
  const auto [column, row, is_upper] = place_of(cell);
  if (is_upper) return {corner(column + 1, row + 1), corner(column, row + 1), corner(column + 1, row)};
  return {corner(column, row), corner(column + 1, row), corner(column, row + 1)};
}

CellCorners TriangleCells::corners_at(const GridPlace& place) const {
  const uint32_t cell = cell_at(place);
  const auto [column, row, is_upper] = place_of(cell);
  const std::array<uint32_t, 3> c = corners_of(cell);
  double fx = std::clamp(place.x - column, 0.0, 1.0), fy = std::clamp(place.y - row, 0.0, 1.0);
  if (is_upper) {
    fx = 1 - fx;
    fy = 1 - fy;
  }
  if (const double sum = fx + fy; sum > 1) {  // rounding
    fx /= sum;
    fy /= sum;
  }
  return {{c[0], c[1], c[2], c[0]}, {1 - fx - fy, fx, fy, 0}};
}

Vec3 TriangleCells::corner_point(uint32_t index) const {
  uint32_t row = 0;
  while (row < parts && corner(0, row + 1) <= index) ++row;
  const double y = static_cast<double>(row) / parts, x = static_cast<double>(index - corner(0, row)) / parts;
  return vertices[0] + x * (vertices[1] - vertices[0]) + y * (vertices[2] - vertices[0]);
}

Vec3 TriangleCells::point(uint32_t cell, const Vec2& u) const {
  const auto [column, row, is_upper] = place_of(cell);
  Vec2 weights = sample_triangle(u);
  if (is_upper) weights = Vec2(1) - weights;
  const Vec2 at = (Vec2(column, row) + weights) / static_cast<double>(parts);
  return vertices[0] + at.x * (vertices[1] - vertices[0]) + at.y * (vertices[2] - vertices[0]);
}

// Plane polygons.

PlaneCells rectangle_about(std::span<const Vec3> points, const Vec3& normal) {
  PlaneCells plane;
  plane.origin = points[0];
  for (size_t i = 1; i < points.size(); ++i)
    if (points[i] != points[i - 1]) {
      plane.x = normalized(points[i] - points[i - 1]);
      break;
    }
  plane.y = glm::cross(normal, plane.x);
  Vec2 high(0);
  for (const Vec3& q : points) {
    const Vec2 flat(glm::dot(q - plane.origin, plane.x), glm::dot(q - plane.origin, plane.y));
    plane.low = glm::min(plane.low, flat);
    high = glm::max(high, flat);
  }
  plane.step = glm::max(high - plane.low, Vec2(1e-300));
  return plane;
}

void cut(PlaneCells& plane, uint32_t columns, uint32_t rows, std::span<const Vec3> points,
         const Vec3& normal) {
  plane.columns = columns;
  plane.rows = rows;
  plane.step /= Vec2(columns, rows);
  const double whole = plane.step.x * plane.step.y;
  std::vector<std::vector<CellPiece>> pieces(size_t{columns} * rows);
  for (const auto& triangle : triangulate(points, normal)) {
    std::vector<Vec2> flat;
    for (const uint32_t corner : triangle) {
      const Vec3 d = points[corner] - plane.origin;
      flat.emplace_back((Vec2(glm::dot(d, plane.x), glm::dot(d, plane.y)) - plane.low) / plane.step);
    }
    if (twice_area(flat[0], flat[1], flat[2]) < 0) std::swap(flat[1], flat[2]);
    const Vec2 lo = glm::min(flat[0], glm::min(flat[1], flat[2])),
               hi = glm::max(flat[0], glm::max(flat[1], flat[2]));
    for (uint32_t row = floor_below(std::max(lo.y, 0.0), rows); row < rows && row < hi.y; ++row)
      for (uint32_t column = floor_below(std::max(lo.x, 0.0), columns); column < columns && column < hi.x;
           ++column) {
        std::vector<Vec2> part = flat;
        clip(part, 0, -1, column);
        clip(part, 0, 1, column + 1);
        clip(part, 1, -1, row);
        clip(part, 1, 1, row + 1);
        std::vector<CellPiece>& of_cell = pieces[size_t{row} * columns + column];
        for (size_t i = 2; i < part.size(); ++i) {
          const double area = 0.5 * whole * twice_area(part[0], part[i - 1], part[i]);
          if (!(area > 1e-12 * whole)) continue;
          const auto place = [&](const Vec2& p) { return plane.low + p * plane.step; };
          of_cell.push_back({{place(part[0]), place(part[i - 1]), place(part[i])},
                             area + (of_cell.empty() ? 0 : of_cell.back().area_through)});
        }
      }
  }
  const auto area = [&](size_t cell) { return pieces[cell].empty() ? 0 : pieces[cell].back().area_through; };
  bool is_filled = true;
  for (size_t cell = 0; cell < pieces.size(); ++cell) is_filled &= area(cell) > (1 - 1e-9) * whole;
  if (is_filled) return;
  for (const std::vector<CellPiece>& of_cell : pieces) {
    plane.first_piece.push_back(static_cast<uint32_t>(plane.pieces.size()));
    plane.pieces.insert(plane.pieces.end(), of_cell.begin(), of_cell.end());
  }
  plane.first_piece.push_back(static_cast<uint32_t>(plane.pieces.size()));
  for (uint32_t cell = 0; cell < pieces.size(); ++cell) {
    uint32_t best = cell;
    if (area(cell) < kLeastPart * whole) {
      const uint32_t column = cell % columns, row = cell / columns;
      const auto consider = [&](uint32_t other) {
        if (area(other) > area(best)) best = other;
      };
      if (column > 0) consider(cell - 1);
      if (column + 1 < columns) consider(cell + 1);
      if (row > 0) consider(cell - columns);
      if (row + 1 < rows) consider(cell + columns);
    }
    plane.stands_for.push_back(best);
  }
  // Where a neighbour is small itself what it stands for is meant.
  for (uint32_t& cell : plane.stands_for)
    for (int i = 0; i < 64 && plane.stands_for[cell] != cell; ++i) cell = plane.stands_for[cell];
}

GridPlace PlaneCells::place_of(const Vec3& p) const {
  const Vec3 d = p - origin;
  return (Vec2(glm::dot(d, x), glm::dot(d, y)) - low) / step;
}

double PlaneCells::area(uint32_t cell) const {
  if (first_piece.empty()) return step.x * step.y;
  return first_piece[cell] == first_piece[cell + 1] ? 0 : pieces[first_piece[cell + 1] - 1].area_through;
}

Vec3 PlaneCells::point(uint32_t cell, Vec2 u) const {
  if (first_piece.empty()) return at(low + (Vec2(cell % columns, cell / columns) + u) * step);
  const auto begin = pieces.begin() + first_piece[cell], end = pieces.begin() + first_piece[cell + 1];
  const double wanted = u.x * (end - 1)->area_through;
  const auto piece = std::upper_bound(
      begin, end - 1, wanted, [](double value, const CellPiece& p) { return value < p.area_through; });
  const double before = piece == begin ? 0 : (piece - 1)->area_through;
  u.x = std::clamp((wanted - before) / (piece->area_through - before), 0.0, 1.0);
  const Vec2 weights = sample_triangle(u);
  const auto& c = piece->corners;
  return at(c[0] + weights.x * (c[1] - c[0]) + weights.y * (c[2] - c[0]));
}

// Quadrics.

std::optional<RevolvedCells> find_axis(const Quadric& quadric, std::span<const Vec4> planes) {
  Mat3 m;
  m[0] = {quadric.a[0], quadric.a[3], quadric.a[4]};
  m[1] = {quadric.a[3], quadric.a[1], quadric.a[5]};
  m[2] = {quadric.a[4], quadric.a[5], quadric.a[2]};
  const Mat3 vectors = diagonalize(m, 1e-15);
  const double largest = std::max({std::abs(m[0][0]), std::abs(m[1][1]), std::abs(m[2][2])});
  // The axis whose two others have factors of one sign, and are as alike as can be.
  int best = -1;
  double best_ratio = 1e-9;
  for (int axis = 0; axis < 3; ++axis) {
    const double q0 = m[(axis + 1) % 3][(axis + 1) % 3], q1 = m[(axis + 2) % 3][(axis + 2) % 3];
    if (!(q0 * q1 > 0) || std::min(std::abs(q0), std::abs(q1)) < 1e-9 * largest) continue;
    const double ratio = std::min(std::abs(q0), std::abs(q1)) / std::max(std::abs(q0), std::abs(q1));
    if (ratio > best_ratio) {
      best = axis;
      best_ratio = ratio;
    }
  }
  if (best < 0) return std::nullopt;
  RevolvedCells cells;
  cells.axes = {vectors[(best + 1) % 3], vectors[(best + 2) % 3], vectors[best]};
  const double sign = m[(best + 1) % 3][(best + 1) % 3] > 0 ? 1 : -1;
  cells.center = quadric.origin;
  cells.a = sign * m[best][best];
  cells.b = sign * glm::dot(quadric.b, cells.axes[2]);
  cells.c = sign * quadric.c;
  for (size_t i = 0; i < 2; ++i) {  // the axis goes where the terms along the other axes vanish
    const int axis = (best + 1 + static_cast<int>(i)) % 3;
    cells.q[i] = sign * m[axis][axis];
    const double linear = sign * glm::dot(quadric.b, cells.axes[i]);
    cells.center -= linear / cells.q[i] * cells.axes[i];
    cells.c -= linear * linear / cells.q[i];
  }
  cells.low = std::numeric_limits<double>::infinity();
  cells.high = -cells.low;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1 ? quadric.bounds.hi : quadric.bounds.lo).x,
                 (corner & 2 ? quadric.bounds.hi : quadric.bounds.lo).y,
                 (corner & 4 ? quadric.bounds.hi : quadric.bounds.lo).z);
    const double z = glm::dot(p - cells.center, cells.axes[2]);
    cells.low = std::min(cells.low, z);
    cells.high = std::max(cells.high, z);
  }
  for (const Vec4& plane : planes) {  // those across the axis cut it exactly
    const Vec3 n(plane);
    const double along = glm::dot(n, cells.axes[2]);
    if (std::abs(along) < (1 - 1e-12) * glm::length(n)) continue;
    const double z = (plane.w - glm::dot(n, cells.center)) / along;
    (along > 0 ? cells.high : cells.low) = along > 0 ? std::min(cells.high, z) : std::max(cells.low, z);
  }
  // Where the surface itself ends: a z² + 2 b z + c = 0.
  if (const double square = cells.b * cells.b - cells.a * cells.c; cells.a > 0 && square >= 0) {
    cells.low = std::max(cells.low, (-cells.b - std::sqrt(square)) / cells.a);
    cells.high = std::min(cells.high, (-cells.b + std::sqrt(square)) / cells.a);
  }
  if (!(cells.low < cells.high)) return std::nullopt;
  return cells;
}

RevolvedCells revolved(const SphereRecord& sphere) {
  RevolvedCells cells;
  cells.center = sphere.center;
  cells.axes = {Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0, 1, 0)};
  cells.a = 1;
  cells.c = -sphere.radius * sphere.radius;
  cells.low = -sphere.radius;
  cells.high = sphere.radius;
  return cells;
}

GridPlace RevolvedCells::place_of(const Vec3& p) const {
  const Vec3 d = p - center;
  return Vec2(longitude(glm::dot(d, axes[0]), glm::dot(d, axes[1])),
              (glm::dot(d, axes[2]) - low) / (high - low)) *
         Vec2(columns, rows);
}

RevolvedCells::Point RevolvedCells::at(const Vec2& uv, const Quadric* quadric,
                                       std::span<const Vec4> planes) const {
  const double z = low + uv.y * (high - low);
  const auto [sine, cosine] = portable_sine_cosine(2 * pi * uv.x);
  const double across = q[0] * cosine * cosine + q[1] * sine * sine;
  const double square = -(a * z * z + 2 * b * z + c) / across;
  if (!(square >= 0)) return {};
  const double radius = std::sqrt(square);
  Point point;
  point.p = center + radius * (cosine * axes[0] + sine * axes[1]) + z * axes[2];
  const Vec3 gradient = radius * (q[0] * cosine * axes[0] + q[1] * sine * axes[1]) + (a * z + b) * axes[2];
  point.normal = normalized(quadric ? quadric->gradient(point.p) : gradient);
  for (const Vec4& plane : planes)
    if (glm::dot(Vec3(plane), point.p) > plane.w) return {};
  // dA = ρ |∇F| / |∇F·e_ρ| dφ dz, and ∇F·e_ρ = ρ × `across`.
  point.density = glm::length(gradient) / across * 2 * pi * (high - low);
  return point;
}

}  // namespace rayfarm
