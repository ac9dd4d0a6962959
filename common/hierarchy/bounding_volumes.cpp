#include "common/hierarchy/bounding_volumes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/math/symmetric.h"

namespace rayfarm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The distances between which a ray is inside of something.
struct Passage {
  double begin = -kInfinity, end = kInfinity;
  /// Between two parallel planes: `at` is the ray's distance from the middle, `speed` how it grows.
  void cut(double at, double speed, double half_width) {
    if (speed == 0) {
      if (!(std::abs(at) <= half_width)) end = -kInfinity;
      return;
    }
    const double a = (-half_width - at) / speed, b = (half_width - at) / speed;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  /// `start`: how far the ray is at the distance 0 of this passage.
  std::optional<double> entry(double start = 0) const {
    if (!(begin <= end) || !(start + end >= 0)) return std::nullopt;
    return std::max(0.0, start + begin);
  }
};

Vec3 at(const BoundingVolume& v, size_t first) {
  return {v.numbers[first], v.numbers[first + 1], v.numbers[first + 2]};
}
void set(BoundingVolume& v, size_t first, const Vec3& p) {
  for (size_t i = 0; i < 3; ++i) v.numbers[first + i] = p[static_cast<int>(i)];
}

std::optional<double> entry_into_box(const BoundingVolume& v, const Vec3& o, const Vec3& d) {
  Passage passage;
  for (size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    const double lo = v.numbers[i], hi = v.numbers[i + 3];
    if (d[axis] == 0) {
      if (!(o[axis] >= lo && o[axis] <= hi)) return std::nullopt;
      continue;
    }
    const double a = (lo - o[axis]) / d[axis], b = (hi - o[axis]) / d[axis];
    passage.begin = std::max(passage.begin, std::min(a, b));
    passage.end = std::min(passage.end, std::max(a, b));
  }
  return passage.entry();
}

/// The quadratic's interval ∩ the caps' slab, from the point of the ray that is nearest to the cylinder's
/// middle: so rounding there is that of the cylinder's size.
std::optional<double> entry_into_cylinder(const BoundingVolume& v, const Vec3& o, const Vec3& d) {
  constexpr double kParallel = 1e-5;  // the sine of an angle at which the quadratic loses too many digits
  const Vec3 to_middle = at(v, 0) - o, axis = at(v, 3);
  const double radius = v.numbers[6], half_height = v.numbers[7];
  const double dd = glm::dot(d, d), nearest = glm::dot(to_middle, d) / dd;
  const Vec3 p = nearest * d - to_middle;
  if (!(glm::dot(p, p) <= radius * radius + half_height * half_height)) return std::nullopt;
  const double along = glm::dot(p, axis), speed = glm::dot(d, axis);
  Passage passage;
  passage.cut(along, speed, half_height);
  if (!(passage.begin <= passage.end)) return std::nullopt;
  const Vec3 across = p - along * axis, drift = d - speed * axis;
  const double a = glm::dot(drift, drift);
  if (a > kParallel * kParallel * dd) {
    const double t = -glm::dot(across, drift) / a;
    const Vec3 off = across + t * drift;
    const double rest = radius * radius - glm::dot(off, off);
    if (!(rest >= 0)) return std::nullopt;
    const double half = std::sqrt(rest / a);
    passage.begin = std::max(passage.begin, t - half);
    passage.end = std::min(passage.end, t + half);
  } else {
    const double length = (passage.end - passage.begin) * std::sqrt(dd);
    const Vec3 off = across + passage.begin * drift;
    if (!(glm::length(off) <= radius + 2 * kParallel * length)) return std::nullopt;
  }
  return passage.entry(nearest);
}

std::optional<double> entry_into_slabs(const BoundingVolume& v, const Vec3& o, const Vec3& d) {
  Passage passage;
  for (size_t i = 0; i < 7; ++i) {
    const Vec3& n = slab_normals()[i];
    const double lo = v.numbers[2 * i], hi = v.numbers[2 * i + 1], middle = 0.5 * lo + 0.5 * hi;
    passage.cut(glm::dot(n, o) - middle, glm::dot(n, d), 0.5 * hi - 0.5 * lo);
    if (!(passage.begin <= passage.end)) return std::nullopt;
  }
  return passage.entry();
}

/// The principal axes: eigenvectors of the points' covariance.
Mat3 principal_axes(std::span<const FitPoint> points) {
  Vec3 mean(0);
  for (const FitPoint& f : points) mean += f.p / static_cast<double>(points.size());
  Mat3 c(0);
  for (const FitPoint& f : points) c += glm::outerProduct(f.p - mean, f.p - mean);
  return diagonalize(c);
}

BoundingVolume fit_cylinder(std::span<const FitPoint> points, const Vec3& axis) {
  const Vec3 u = normalized(glm::cross(axis, std::abs(axis.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  const Vec3 w = glm::cross(axis, u), base = points[0].p;
  double lo = kInfinity, hi = -kInfinity;
  std::vector<FitPoint> flat;
  flat.reserve(points.size());
  for (const FitPoint& f : points) {
    const Vec3 p = f.p - base;
    const double along = glm::dot(p, axis);
    lo = std::min(lo, along - f.radius);
    hi = std::max(hi, along + f.radius);
    flat.push_back({Vec3(glm::dot(p, u), glm::dot(p, w), 0), f.radius});
  }
  const Ball circle = least_ball(flat);
  BoundingVolume v{VolumeKind::cylinder};
  set(v, 0, base + circle.center.x * u + circle.center.y * w + 0.5 * (lo + hi) * axis);
  set(v, 3, axis);
  v.numbers[6] = circle.radius;
  v.numbers[7] = 0.5 * (hi - lo);
  return v;
}

BoundingVolume fit_least_cylinder(std::span<const FitPoint> points) {
  const Mat3 principal = principal_axes(points);
  std::optional<BoundingVolume> least;
  for (int i = 0; i < 6; ++i) {
    Vec3 axis(0);
    if (i < 3)
      axis[i] = 1;
    else
      axis = normalized(principal[i - 3]);
    const BoundingVolume v = fit_cylinder(points, axis);
    if (!least || volume_of(v) < volume_of(*least)) least = v;
  }
  return *least;
}

}  // namespace

Box box_of(std::span<const FitPoint> points) {
  Box box;
  for (const FitPoint& f : points) {
    box.grow(f.p - Vec3(f.radius));
    box.grow(f.p + Vec3(f.radius));
  }
  return box;
}

const std::array<Vec3, 7>& slab_normals() {
  constexpr double k = std::numbers::inv_sqrt3;
  static const std::array<Vec3, 7> normals{Vec3(1, 0, 0),  Vec3(0, 1, 0),  Vec3(0, 0, 1), Vec3(k, k, k),
                                           Vec3(k, k, -k), Vec3(k, -k, k), Vec3(-k, k, k)};
  return normals;
}

BoundingVolume fit_volume(VolumeKind kind, std::span<const FitPoint> points) {
  BoundingVolume v{kind};
  switch (kind) {
    case VolumeKind::sphere: {
      const Ball ball = least_ball(points);
      set(v, 0, ball.center);
      v.numbers[3] = ball.radius;
      break;
    }
    case VolumeKind::box: {
      const Box box = box_of(points);
      set(v, 0, box.lo);
      set(v, 3, box.hi);
      break;
    }
    case VolumeKind::cylinder:
      return fit_least_cylinder(points);
    case VolumeKind::slabs:
      for (size_t i = 0; i < 7; ++i) {
        v.numbers[2 * i] = kInfinity;
        v.numbers[2 * i + 1] = -kInfinity;
        for (const FitPoint& f : points) {
          const double d = glm::dot(slab_normals()[i], f.p);
          v.numbers[2 * i] = std::min(v.numbers[2 * i], d - f.radius);
          v.numbers[2 * i + 1] = std::max(v.numbers[2 * i + 1], d + f.radius);
        }
      }
      break;
  }
  return v;
}

double volume_of(const BoundingVolume& v) {
  if (v.kind == VolumeKind::sphere) return 4.0 / 3 * std::numbers::pi * std::pow(v.numbers[3], 3);
  if (v.kind == VolumeKind::cylinder)
    return 2 * std::numbers::pi * v.numbers[6] * v.numbers[6] * v.numbers[7];
  const Vec3 e = at(v, 3) - at(v, 0);
  return e.x * e.y * e.z;
}

double projected_area(const BoundingVolume& v, const Vec3& d) {
  if (v.kind == VolumeKind::sphere) return std::numbers::pi * v.numbers[3] * v.numbers[3];
  if (v.kind == VolumeKind::cylinder) {
    const double cosine = std::min(1.0, std::abs(glm::dot(at(v, 3), d)));
    return std::numbers::pi * v.numbers[6] * v.numbers[6] * cosine +
           4 * v.numbers[6] * v.numbers[7] * std::sqrt(1 - cosine * cosine);
  }
  const Vec3 e = at(v, 3) - at(v, 0);
  return e.y * e.z * std::abs(d.x) + e.z * e.x * std::abs(d.y) + e.x * e.y * std::abs(d.z);
}

BoundingVolume choose_volume(std::span<const FitPoint> points, const std::optional<Vec3>& eye) {
  const Vec3 from_eye = eye ? normalized(box_of(points).center() - *eye) : Vec3(0);
  std::optional<BoundingVolume> best;
  double least = kInfinity;
  for (const VolumeKind kind : {VolumeKind::sphere, VolumeKind::box, VolumeKind::cylinder}) {
    const BoundingVolume v = fit_volume(kind, points);
    const double cost = kVolumeFactors[static_cast<size_t>(kind)] *
                        (eye && max_magnitude(from_eye) > 0 ? projected_area(v, from_eye) : volume_of(v));
    if (best && !(cost < least)) continue;
    best = v;
    least = cost;
  }
  return *best;
}

void widen(BoundingVolume& v, double margin) {
  switch (v.kind) {
    case VolumeKind::sphere:
      v.numbers[3] += margin;
      return;
    case VolumeKind::box:
      for (size_t i = 0; i < 6; ++i) v.numbers[i] += i < 3 ? -margin : margin;
      return;
    case VolumeKind::cylinder:
      v.numbers[6] += margin;
      v.numbers[7] += margin;
      return;
    case VolumeKind::slabs:
      for (size_t i = 0; i < 14; ++i) v.numbers[i] += i % 2 == 0 ? -margin : margin;
      return;
  }
}

bool is_box(std::span<const FitPoint> points) {
  std::vector<Vec3> corners;
  for (const FitPoint& f : points) {
    if (f.radius > 0) return false;
    if (std::find(corners.begin(), corners.end(), f.p) != corners.end()) continue;
    if (corners.size() == 8) return false;
    corners.push_back(f.p);
  }
  if (corners.size() != 8) return false;
  const auto is_corner = [&](const Vec3& p, double tolerance) {
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Vec3& c) { return max_magnitude(c - p) <= tolerance; });
  };
  const Vec3& o = corners[0];
  for (size_t i = 1; i < 8; ++i)
    for (size_t j = i + 1; j < 8; ++j)
      for (size_t k = j + 1; k < 8; ++k) {
        const Vec3 a = corners[i] - o, b = corners[j] - o, c = corners[k] - o;
        const double size = glm::length(a + b + c), tolerance = 1e-5 * size;  // corners may be floats
        if (std::abs(glm::dot(a, b)) > tolerance * size || std::abs(glm::dot(b, c)) > tolerance * size ||
            std::abs(glm::dot(c, a)) > tolerance * size)
          continue;
        if (is_corner(o + a + b, tolerance) && is_corner(o + b + c, tolerance) &&
            is_corner(o + c + a, tolerance) && is_corner(o + a + b + c, tolerance))
          return true;
      }
  return false;
}

std::optional<double> entry_into(const BoundingVolume& volume, const Vec3& origin, const Vec3& direction) {
  switch (volume.kind) {
    case VolumeKind::sphere:
      return entry_into(Ball{at(volume, 0), volume.numbers[3]}, origin, direction);
    case VolumeKind::box:
      return entry_into_box(volume, origin, direction);
    case VolumeKind::cylinder:
      return entry_into_cylinder(volume, origin, direction);
    case VolumeKind::slabs:
      return entry_into_slabs(volume, origin, direction);
  }
  return 0;
}

std::optional<double> entry_into(const Ball& ball, const Vec3& o, const Vec3& d) {
  const Vec3 to_center = ball.center - o;
  const double dd = glm::dot(d, d), nearest = glm::dot(to_center, d) / dd;
  const Vec3 off = nearest * d - to_center;
  const double rest = ball.radius * ball.radius - glm::dot(off, off);
  if (!(rest >= 0)) return std::nullopt;
  const double half = std::sqrt(rest / dd);
  return Passage{-half, half}.entry(nearest);
}

}  // namespace rayfarm
