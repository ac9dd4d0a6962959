#include "common/shapes/triangulate.h"

#include <cmath>
#include <utility>

#include "common/math/orientation.h"
#include "common/shapes/polygon.h"

namespace rayfarm {
namespace {

/// The polygon as seen along an axis: leaving a coordinate out rounds nothing.
std::vector<Vec2> projected(std::span<const Vec3> points, const Vec3& normal) {
  const auto axis = static_cast<int>(largest_axis(normal));
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<Vec2> flat;
  flat.reserve(points.size());
  for (const Vec3& p : points) flat.emplace_back(p[u], p[v]);
  return flat;
}

/// The remaining corners by place, so that an ear asks only those near it.
class CornerGrid {
 public:
  explicit CornerGrid(const std::vector<Vec2>& points) {
    Vec2 hi = lo_ = points[0];
    for (const Vec2& p : points) {
      lo_ = glm::min(lo_, p);
      hi = glm::max(hi, p);
    }
    side_ = std::max<size_t>(1, static_cast<size_t>(std::sqrt(static_cast<double>(points.size()))));
    for (int k = 0; k < 2; ++k)
      scale_[k] = hi[k] - lo_[k] > 1e-300 ? static_cast<double>(side_) / (hi[k] - lo_[k]) : 0;
    cells_.resize(side_ * side_);
    for (uint32_t i = 0; i < points.size(); ++i)
      cells_[cell(points[i], 1) * side_ + cell(points[i], 0)].push_back(i);
  }

  /// True if `test` is true for a corner that may lie in the box; those that `is_gone` are forgotten.
  template <typename IsGone, typename Test>
  bool any(const Vec2& lo, const Vec2& hi, const IsGone& is_gone, const Test& test) {
    for (size_t y = cell(lo, 1); y <= cell(hi, 1); ++y)
      for (size_t x = cell(lo, 0); x <= cell(hi, 0); ++x) {
        std::vector<uint32_t>& corners = cells_[y * side_ + x];
        std::erase_if(corners, is_gone);
        if (std::any_of(corners.begin(), corners.end(), test)) return true;
      }
    return false;
  }

 private:
  size_t cell(const Vec2& p, int k) const {
    return std::min(side_ - 1, static_cast<size_t>((p[k] - lo_[k]) * scale_[k]));
  }
  Vec2 lo_{0}, scale_{0};
  size_t side_ = 1;
  std::vector<std::vector<uint32_t>> cells_;
};

class EarClipper {
 public:
  explicit EarClipper(std::vector<Vec2> points)
      : points_(std::move(points)), grid_(points_), remaining_(points_.size()) {
    const auto n = static_cast<uint32_t>(points_.size());
    for (uint32_t i = 0; i < n; ++i) {
      previous_.push_back((i + n - 1) % n);
      next_.push_back((i + 1) % n);
      later_.push_back(i);
    }
    is_gone_.resize(n);
    is_for_later_.resize(n);
    double area = 0;
    for (uint32_t i = 1; i + 1 < n; ++i) {
      const Vec2 a = points_[i] - points_[0], b = points_[i + 1] - points_[0];
      area += a.x * b.y - a.y * b.x;
    }
    turn_ = area < 0 ? -1 : 1;
  }

  std::vector<std::array<uint32_t, 3>> clip() {
    uint32_t rest = 0;
    while (remaining_ >= 3) {
      if (later_.empty()) {  // no ear is left: the polygon crosses itself
        while (is_gone_[rest]) rest = next_[rest];
        for (size_t k = 0; k < remaining_ && turn(previous_[rest], rest, next_[rest]) <= 0; ++k)
          rest = next_[rest];
        cut(rest);
      }
      // Round by round: neighbours of a cut wait, or triangles would all meet in one corner.
      const std::vector<uint32_t> now = std::exchange(later_, {});
      for (const uint32_t i : now) is_for_later_[i] = false;
      for (const uint32_t i : now)
        if (remaining_ >= 3 && !is_gone_[i] && !is_for_later_[i] && (is_spike(i) || is_ear(i))) cut(i);
    }
    return std::move(triangles_);
  }

 private:
  /// Above 0 if the corners turn the way that the polygon does.
  int turn(uint32_t a, uint32_t b, uint32_t c) const {
    return turn_ * orientation(points_[a], points_[b], points_[c]);
  }

  /// No area is lost with the corner: it repeats a neighbour, or the polygon goes back where it came from.
  bool is_spike(uint32_t i) const {
    const Vec2 &a = points_[previous_[i]], &b = points_[i], &c = points_[next_[i]];
    if (a == b || b == c) return true;
    if (turn(previous_[i], i, next_[i]) != 0) return false;
    const auto lies_between = [&](int k) {
      return (a[k] <= b[k] && b[k] <= c[k]) || (c[k] <= b[k] && b[k] <= a[k]);
    };
    return !(lies_between(0) && lies_between(1));
  }

  /// True if some of the segment lies in the open triangle: no line along a side of either parts them.
  bool enters(uint32_t from, uint32_t to, const std::array<uint32_t, 3>& triangle) const {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      if (turn(a, b, from) <= 0 && turn(a, b, to) <= 0) return false;
    }
    int least = 1, most = -1;
    for (const uint32_t corner : triangle) {
      const int side = turn(from, to, corner);
      least = std::min(least, side);
      most = std::max(most, side);
    }
    return least < 0 && most > 0;
  }

  /// Of the remaining corners, one that the triangle cut off at `i` holds keeps it from being an ear; one on
  /// its rim only if it lies on the cut, or an edge there leads inside.
  bool is_ear(uint32_t i) {
    const std::array<uint32_t, 3> triangle{previous_[i], i, next_[i]};
    const auto [a, b, c] = triangle;
    if (turn(a, b, c) <= 0) return false;
    const Vec2 lo = glm::min(points_[a], glm::min(points_[b], points_[c]));
    const Vec2 hi = glm::max(points_[a], glm::max(points_[b], points_[c]));
    return !grid_.any(
        lo, hi, [&](uint32_t j) { return bool(is_gone_[j]); },
        [&](uint32_t j) {
          const Vec2& p = points_[j];
          if (j == triangle[0] || j == triangle[1] || j == triangle[2]) return false;
          if (p.x < lo.x || p.y < lo.y || p.x > hi.x || p.y > hi.y) return false;
          const int ab = turn(triangle[0], triangle[1], j), bc = turn(triangle[1], triangle[2], j),
                    ca = turn(triangle[2], triangle[0], j);
          if (ab < 0 || bc < 0 || ca < 0) return false;
          if (ab > 0 && bc > 0) return true;
          return enters(previous_[j], j, triangle) || enters(j, next_[j], triangle);
        });
  }

  void cut(uint32_t i) {
    const uint32_t before = previous_[i], after = next_[i];
    if (turn(before, i, after) > 0) triangles_.push_back({before, i, after});
    next_[before] = after;
    previous_[after] = before;
    is_gone_[i] = true;
    --remaining_;
    for (const uint32_t j : {before, after})
      if (!is_for_later_[j]) {
        is_for_later_[j] = true;
        later_.push_back(j);
      }
  }

  std::vector<Vec2> points_;
  CornerGrid grid_;
  size_t remaining_;
  int turn_ = 1;
  std::vector<uint32_t> previous_, next_;
  std::vector<uint32_t> later_;  ///< corners that may have become ears: only a cut beside one makes it one
  std::vector<bool> is_gone_, is_for_later_;
  std::vector<std::array<uint32_t, 3>> triangles_;
};

struct Edge {
  Vec2 from, to, after;  ///< where it leads, and where the next one does
  Vec2 lo, hi;
};

/// The edges that have a length, by their least x.
std::vector<Edge> edges_of(const std::vector<Vec2>& points) {
  std::vector<Vec2> corners;
  for (const Vec2& p : points)
    if (corners.empty() || p != corners.back()) corners.push_back(p);
  while (corners.size() > 1 && corners.back() == corners.front()) corners.pop_back();
  const size_t n = corners.size();
  std::vector<Edge> edges;
  for (size_t i = 0; i < n; ++i) {
    const Vec2 &a = corners[i], &b = corners[(i + 1) % n];
    edges.push_back({a, b, corners[(i + 2) % n], glm::min(a, b), glm::max(a, b)});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.lo.x < b.lo.x; });
  return edges;
}

/// 1 if `p` lies left of the way that goes along the edge and the next one, -1 right of it, 0 on it.
int side_of_way(const Edge& e, const Vec2& p) {
  const int first = orientation(e.from, e.to, p), second = orientation(e.to, e.after, p);
  const int bend = orientation(e.from, e.to, e.after);
  if (bend == 0) return first;
  if (first == bend && second == bend) return bend;
  return first == -bend || second == -bend ? -bend : 0;
}

bool cross(const Edge& e, const Edge& f) {
  const int from = orientation(e.from, e.to, f.from), to = orientation(e.from, e.to, f.to);
  if (from == 0 && to == 0) {  // on one line
    const int k = std::abs(e.to.x - e.from.x) > std::abs(e.to.y - e.from.y) ? 0 : 1;
    return (e.from[k] < e.to[k]) == (f.from[k] < f.to[k]) &&
           std::max(e.lo[k], f.lo[k]) < std::min(e.hi[k], f.hi[k]);
  }
  if (e.to == f.to) return side_of_way(e, f.from) * side_of_way(e, f.after) < 0;
  const auto ends_on = [](const Edge& a, const Edge& b) {  // and goes on beyond it
    return a.to != b.from && glm::clamp(a.to, b.lo, b.hi) == a.to && orientation(b.from, b.to, a.to) == 0 &&
           orientation(b.from, b.to, a.from) * orientation(b.from, b.to, a.after) < 0;
  };
  if (ends_on(e, f) || ends_on(f, e)) return true;
  return from * to < 0 && orientation(f.from, f.to, e.from) * orientation(f.from, f.to, e.to) < 0;
}

}  // namespace

std::vector<std::array<uint32_t, 3>> triangulate(std::span<const Vec3> points, const Vec3& normal) {
  if (points.size() < 3) return {};
  return EarClipper(projected(points, normal)).clip();
}

void cut_face(std::span<const Vec3> points, std::vector<std::array<uint32_t, 3>>& triangles) {
  triangles.clear();
  const Vec3 normal = newell_normal(points);
  const double least =
      -1e-6 * glm::dot(normal, normal);  // what overlaps by so little of the face is rounding
  bool is_fan = true;
  for (uint32_t i = 1; i + 1 < points.size(); ++i) {
    is_fan =
        is_fan && glm::dot(glm::cross(points[i] - points[0], points[i + 1] - points[0]), normal) >= least;
    triangles.push_back({0, i, i + 1});
  }
  if (!is_fan) triangles = triangulate(points, normal);
}

bool crosses_itself(std::span<const Vec3> points, const Vec3& normal) {
  const std::vector<Edge> edges = edges_of(projected(points, normal));
  for (size_t i = 0; i < edges.size(); ++i)
    for (size_t j = i + 1; j < edges.size() && edges[j].lo.x <= edges[i].hi.x; ++j)
      if (edges[i].lo.y <= edges[j].hi.y && edges[j].lo.y <= edges[i].hi.y && cross(edges[i], edges[j]))
        return true;
  return false;
}

}  // namespace rayfarm
