#pragma once
// The four ways that the thesis names (2.3.3) to tell whether the point where a ray meets a polygon's plane
// lies inside the polygon, each with what it can work out beforehand; for comparing them. `Number` is double,
// or counts its operations. The plane itself (Equation 2.10) costs all of them the same and is left out.
#include <cmath>
#include <vector>

#include "common/shapes/polygon.h"

namespace rayfarm::test {

struct Operations {
  long sums = 0, products = 0, quotients = 0, roots = 0, comparisons = 0;
  long all() const { return sums + products + quotients + roots + comparisons; }
};

/// A double that counts what is done with it. Not for several threads.
struct Counted {
  double value = 0;
  static inline Operations operations;

  Counted() = default;
  Counted(double v) : value(v) {}
  friend Counted operator+(Counted a, Counted b) { return ++operations.sums, a.value + b.value; }
  friend Counted operator-(Counted a, Counted b) { return ++operations.sums, a.value - b.value; }
  friend Counted operator*(Counted a, Counted b) { return ++operations.products, a.value * b.value; }
  friend Counted operator/(Counted a, Counted b) { return ++operations.quotients, a.value / b.value; }
  friend bool operator<(Counted a, Counted b) { return ++operations.comparisons, a.value < b.value; }
  friend bool operator>(Counted a, Counted b) { return b < a; }
};
inline double root_of(double x) {
  return std::sqrt(x);
}
inline Counted root_of(Counted x) {
  return ++Counted::operations.roots, std::sqrt(x.value);
}

/// "An arbitrary ray is drawn from the intersection point on the projection plane", along an axis, and the
/// edges that it meets are counted (Figure 2.7b, Equations 2.11). For all polygons.
template <typename Number>
class EdgeCounting {
 public:
  explicit EdgeCounting(std::span<const Vec3> points) {
    const auto axis = static_cast<int>(largest_axis(newell_normal(points)));
    u_ = (axis + 1) % 3, v_ = (axis + 2) % 3;
    for (size_t i = 0; i < points.size(); ++i) {
      const Vec3 &p = points[i], &q = points[(i + 1) % points.size()];
      // A level edge has no end that the ray could lie between: infinity puts it out of reach.
      edges_.push_back({p[u_], p[v_], q[u_] - p[u_], 1 / (q[v_] - p[v_])});
    }
  }
  bool is_inside(const Vec3& p) const {
    const Number u = p[u_], v = p[v_];
    bool inside = false;
    for (const Edge& e : edges_) {
      const Number along = (v - Number(e.v)) * Number(e.steps_per_v);  // t1
      if (along < Number(0) || along > Number(1)) continue;
      if ((Number(e.u) - u) + along * Number(e.du) > Number(0)) inside = !inside;  // t0
    }
    return inside;
  }

 private:
  struct Edge {
    double u, v, du, steps_per_v;
  };
  int u_ = 0, v_ = 0;
  std::vector<Edge> edges_;
};

/// "Treats each edge as a plane that is perpendicular to the polygon. If the intersection point is on the
/// same side of each plane it is inside." For convex polygons.
template <typename Number>
class EdgePlanes {
 public:
  explicit EdgePlanes(std::span<const Vec3> points) {
    const Vec3 normal = newell_normal(points);
    for (size_t i = 0; i < points.size(); ++i) {
      const Vec3 inward = glm::cross(normal, points[(i + 1) % points.size()] - points[i]);
      planes_.emplace_back(inward, -glm::dot(inward, points[i]));
    }
  }
  bool is_inside(const Vec3& p) const {
    const Number x = p.x, y = p.y, z = p.z;
    for (const Vec4& plane : planes_)
      if (Number(plane.x) * x + Number(plane.y) * y + Number(plane.z) * z + Number(plane.w) < Number(0))
        return false;
    return true;
  }

 private:
  std::vector<Vec4> planes_;
};

/// "Translates the polygon and intersection point such that the intersection point is on the origin. The x
/// axis is used to intersect each edge." For all polygons; `intersect` in common/shapes/polygon.h does so.
template <typename Number>
class Translation {
 public:
  explicit Translation(std::span<const Vec3> points) {
    const auto axis = static_cast<int>(largest_axis(newell_normal(points)));
    u_ = (axis + 1) % 3, v_ = (axis + 2) % 3;
    for (const Vec3& p : points) corners_.emplace_back(p[u_], p[v_]);
  }
  bool is_inside(const Vec3& p) const {
    const Number u = p[u_], v = p[v_];
    bool inside = false;
    Number pu = Number(corners_.back().x) - u, pv = Number(corners_.back().y) - v;
    bool is_above = pv > Number(0);
    for (const Vec2& corner : corners_) {
      const Number qu = Number(corner.x) - u, qv = Number(corner.y) - v;
      const bool ends_above = qv > Number(0);
      if (is_above != ends_above && (pu * qv - qu * pv > Number(0)) == ends_above) inside = !inside;
      pu = qu;
      pv = qv;
      is_above = ends_above;
    }
    return inside;
  }

 private:
  int u_ = 0, v_ = 0;
  std::vector<Vec2> corners_;
};

/// "The equations to determine the parametric values of u and v … were derived by Ullner. [They] require
/// numerous operations including a square root. If the values of u and v are both between zero and one, the
/// intersection point is inside." For convex quadrilaterals: p = p0 + u b + v (c + u a).
template <typename Number>
class Parametric {
 public:
  explicit Parametric(std::span<const Vec3> points)
      : p0_(points[0]),
        a_(points[0] - points[1] + points[2] - points[3]),
        b_(points[1] - points[0]),
        c_(points[3] - points[0]) {
    const Vec3 normal = newell_normal(points);
    across_a_ = glm::cross(a_, normal);
    across_c_ = glm::cross(c_, normal);
    ba_ = glm::dot(b_, across_a_);
    bc_ = glm::dot(b_, across_c_);
  }
  bool is_inside(const Vec3& p) const {
    // (p - p0 - u b) is parallel to (c + u a): a quadratic equation in u.
    const Number x = Number(p.x) - Number(p0_.x), y = Number(p.y) - Number(p0_.y),
                 z = Number(p.z) - Number(p0_.z);
    const auto dot = [&](const Vec3& v) { return Number(v.x) * x + Number(v.y) * y + Number(v.z) * z; };
    const Number constant = dot(across_c_), linear = dot(across_a_) - Number(bc_);
    const Number square = linear * linear + Number(4) * Number(ba_) * constant;
    if (square < Number(0)) return false;
    const Number root = root_of(square);
    // The root without cancellation, and the other one from the product of both.
    const Number q = linear < Number(0) ? root - linear : Number(0) - (root + linear);
    const Number first = Number(2) * constant / q;
    if (is_inside_at(first, x, y, z)) return true;
    if (ba_ == 0) return false;  // parallel sides: there is no other root
    return is_inside_at(q / (Number(-2) * Number(ba_)), x, y, z);
  }

 private:
  bool is_inside_at(Number u, Number x, Number y, Number z) const {
    if (u < Number(0) || u > Number(1)) return false;
    const auto way = [&](int k) { return Number(c_[k]) + u * Number(a_[k]); };
    const Number wx = way(0), wy = way(1), wz = way(2);
    const Number length2 = wx * wx + wy * wy + wz * wz;
    const Number along = (x - u * Number(b_.x)) * wx + (y - u * Number(b_.y)) * wy +
                         (z - u * Number(b_.z)) * wz;  // v, times the square of the way's length
    return !(along < Number(0) || along > length2);
  }

  Vec3 p0_, a_, b_, c_, across_a_, across_c_;
  double ba_ = 0, bc_ = 0;
};

}  // namespace rayfarm::test
