#include "common/lighting/participating_media.h"

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The part of (t0, t1) in which the ray is in the box; empty if t0 >= t1.
void clip(const Ray& ray, const Box& box, double& t0, double& t1) {
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < box.lo[axis] || o > box.hi[axis]) t1 = t0;
      continue;
    }
    const double a = (box.lo[axis] - o) / d, b = (box.hi[axis] - o) / d;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
}

Vec3 cell_size(const ParticipatingMedium& medium) {
  return medium.box.extent() / Vec3(medium.cells[0], medium.cells[1], medium.cells[2]);
}

}  // namespace

MediumSegments media_along(const Scene& scene, const Ray& ray) {
  MediumSegments segments;
  for (uint32_t i = 0; i < scene.media.size(); ++i) {
    MediumSegment segment{i, 0, ray.t_max};
    clip(ray, scene.media[i].box, segment.t0, segment.t1);
    if (!(segment.t0 < segment.t1)) continue;
    segments.push_back(segment);
    for (size_t k = segments.size() - 1; k > 0 && segments[k].t0 < segments[k - 1].t0; --k)
      std::swap(segments[k], segments[k - 1]);
  }
  return segments;
}

double density_at(const Scene& scene, const ParticipatingMedium& medium, const Vec3& p) {
  if (!medium.has_grid()) return 1;
  const float* const densities = &scene.medium_densities[medium.first_density];
  std::array<size_t, 3> low, high;
  std::array<double, 3> share;  // of the higher
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t n = medium.cells[static_cast<size_t>(axis)];
    const double place =
        (p[axis] - medium.box.lo[axis]) / (medium.box.hi[axis] - medium.box.lo[axis]) * n - 0.5;
    const double at = std::clamp(place, 0.0, n - 1.0), floor = std::floor(at);
    const auto i = static_cast<size_t>(axis);
    low[i] = static_cast<size_t>(floor);
    high[i] = std::min(low[i] + 1, size_t{n} - 1);
    share[i] = at - floor;
  }
  const auto along_x = [&](size_t y, size_t z) {
    const float* const row = densities + (z * medium.cells[1] + y) * medium.cells[0];
    const double a = row[low[0]], b = row[high[0]];
    return a + share[0] * (b - a);
  };
  const auto along_y = [&](size_t z) {
    const double a = along_x(low[1], z), b = along_x(high[1], z);
    return a + share[1] * (b - a);
  };
  const double a = along_y(low[2]), b = along_y(high[2]);
  return a + share[2] * (b - a);
}

double density_along(const Scene& scene, const Ray& ray, const MediumSegment& segment) {
  const ParticipatingMedium& medium = scene.media[segment.medium];
  const double length = glm::length(ray.direction);
  if (!medium.has_grid()) return (segment.t1 - segment.t0) * length;
  const Vec3 cell = cell_size(medium);
  double sum = 0;
  for (MajorantWalk block(scene, ray, segment); block.next();) {
    // Between the planes through cells' centres.
    GridWalk piece(ray, block.t0(), block.t1(), medium.box.lo - 0.5 * cell, cell,
                   {medium.cells[0] + 1, medium.cells[1] + 1, medium.cells[2] + 1});
    while (piece.next()) {
      constexpr double kPoint = 0.5773502691896257645;  // of Gauss, 1 / √3
      const double middle = 0.5 * (piece.t0() + piece.t1()), half = 0.5 * (piece.t1() - piece.t0());
      sum += half * (density_at(scene, medium, ray.origin + (middle - kPoint * half) * ray.direction) +
                     density_at(scene, medium, ray.origin + (middle + kPoint * half) * ray.direction));
    }
  }
  return sum * length;
}

Color attenuation(const Color& depth) {
  if (depth.x == depth.y && depth.y == depth.z) return Color(portable_exp(-depth.x));
  return {portable_exp(-depth.x), portable_exp(-depth.y), portable_exp(-depth.z)};
}

Color transmittance(const Scene& scene, const Ray& ray) {
  Color depth(0);
  for (const MediumSegment& segment : media_along(scene, ray))
    depth += density_along(scene, ray, segment) * scene.media[segment.medium].extinction();
  return attenuation(depth);
}

GridWalk::GridWalk(const Ray& ray, double t0, double t1, const Vec3& first, const Vec3& step,
                   const std::array<uint32_t, 3>& count)
    : origin_(ray.origin),
      direction_(ray.direction),
      first_(first),
      step_(step),
      count_(count),
      t1_(t0),
      end_(t1) {
  const Vec3 p = origin_ + t0 * direction_;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<size_t>(axis);
    const double place = (p[axis] - first[axis]) / step[axis];
    next_cell_[i] = static_cast<uint32_t>(std::clamp(place, 0.0, count[i] - 1.0));
    cell_[i] = next_cell_[i];
    crossing_[axis] = plane(i);
  }
}

double GridWalk::plane(size_t axis) const {
  const auto i = static_cast<int>(axis);
  const double d = direction_[i];
  const uint32_t cell = next_cell_[axis];
  if (d == 0 || (d > 0 ? cell + 1 == count_[axis] : cell == 0)) return kInfinity;  // the last one
  return (first_[i] + (cell + (d > 0 ? 1.0 : 0.0)) * step_[i] - origin_[i]) / d;
}

bool GridWalk::next() {
  while (t1_ < end_) {
    const int axis = crossing_.x <= crossing_.y ? (crossing_.x <= crossing_.z ? 0 : 2)
                                                : (crossing_.y <= crossing_.z ? 1 : 2);
    const auto i = static_cast<size_t>(axis);
    cell_ = next_cell_;
    t0_ = t1_;
    t1_ = std::min(end_, std::max(t0_, crossing_[axis]));
    if (t1_ < end_) {
      direction_[axis] > 0 ? ++next_cell_[i] : --next_cell_[i];
      crossing_[axis] = plane(i);
    }
    if (t0_ < t1_) return true;
  }
  return false;
}

MajorantWalk::MajorantWalk(const Scene& scene, const Ray& ray, const MediumSegment& segment)
    : majorants_(scene.medium_majorants.subspan(scene.media[segment.medium].first_majorant)),
      blocks_(scene.media[segment.medium].blocks()),
      walk_(ray, segment.t0, segment.t1, scene.media[segment.medium].box.lo,
            double{kMajorantCells} * cell_size(scene.media[segment.medium]), blocks_) {}

bool MajorantWalk::next() {
  while (walk_.next()) {
    const auto& cell = walk_.cell();
    majorant_ = majorants_[(size_t{cell[2]} * blocks_[1] + cell[1]) * blocks_[0] + cell[0]];
    if (majorant_ > 0) return true;
  }
  return false;
}

}  // namespace rayfarm
