#include "common/hierarchy/ray_coherence.h"

#include <algorithm>
#include <cmath>

#include "common/hierarchy/primitive_bounds.h"

namespace rayfarm {
namespace {

/// Balls and cones are made larger by what rounding may come to, and far more: of coordinates, and in
/// radians.
constexpr double kMargin = 1e-9;

uint64_t key_of(uint32_t first, uint32_t second) {
  return uint64_t{first} << 32 | second;
}

/// About points that are given in the space of an instance.
Ball ball_about(std::span<const Vec3> points, const InstancePose& pose) {
  std::vector<FitPoint> placed;
  double magnitude = max_magnitude(pose.world_from_object.translation);
  for (const Vec3& p : points) {
    placed.push_back({pose.is_identity ? p : pose.world_from_object.point(p)});
    if (!is_finite(placed.back().p)) return {Vec3(0), std::numeric_limits<double>::infinity()};
    magnitude = std::max(magnitude, max_magnitude(placed.back().p));
  }
  Ball ball = least_ball(placed);
  ball.radius += kMargin * magnitude;
  return ball;
}

Ball ball_about(const Box& box, const InstancePose& pose) {
  return ball_about(corners_of(box), pose);
}

/// Calls visit(pointer) for each primitive that a part's leaves refer to; triangles that a primitive was cut
/// into and that stand side by side are named by the first.
template <typename Visit>
void for_each_pointer(const Scene& scene, const Part& part, Visit visit) {
  PrimitiveId previous = kNoPrimitive;
  for (uint32_t i = 8 * part.first_triangle_block;
       i < 8 * (part.first_triangle_block + part.triangle_block_count); ++i) {
    const PrimitiveId id = scene.triangle_blocks[i / 8].primitives[i % 8];
    if (id != kNoPrimitive && !(id == previous)) visit(make_pointer(PointerKind::triangle, i));
    previous = id;
  }
  for (uint32_t i = 8 * part.first_sphere_block; i < 8 * (part.first_sphere_block + part.sphere_block_count);
       ++i)
    if (scene.sphere_blocks[i / 8].spheres[i % 8] != kNone) visit(make_pointer(PointerKind::sphere, i));
  for (uint32_t i = part.first_leaf_primitive; i < part.first_leaf_primitive + part.leaf_primitive_count; ++i)
    if (scene.leaf_primitives[i].kind() != PrimitiveKind::collection)
      visit(make_pointer(PointerKind::other, i));
}

Ball ball_about(const Scene& scene, PrimitivePointer pointer, const InstancePose& pose) {
  if (pointer.kind() == PointerKind::triangle) return ball_about(corners_of(scene, pointer), pose);
  if (pointer.kind() == PointerKind::sphere && pose.is_identity) {
    const SphereBlock& block = scene.sphere_blocks[pointer.place() / 8];
    const SphereRecord& sphere = scene.spheres[block.spheres[pointer.place() % 8]];
    return {sphere.center, sphere.radius + kMargin * (max_magnitude(sphere.center) + sphere.radius)};
  }
  return ball_about(bounds_of(scene, pointer), pose);
}

}  // namespace

std::vector<Candidate> candidates_of(const Scene& scene) {
  std::vector<Candidate> all;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Part& part = scene.parts[instance.part];
    if (instance.moving != kNone) continue;
    if (part.primitive_count() > kMostPrimitivesApart) {
      // A tree of the scene's objects reaches into it.
      if (scene.head().object_tree != kNone) return {};
      all.push_back({ball_about(part.collection.bounds, scene.poses[i]), {i, {}}, true});
    } else {
      for_each_pointer(scene, part, [&](PrimitivePointer pointer) {
        all.push_back({ball_about(scene, pointer, scene.poses[i]), {i, pointer}});
      });
    }
    if (all.size() > kMostCandidates) return {};
  }
  return all;
}

RayCoherence::RayCoherence(const Scene& scene)
    : blocks_(scene.triangle_blocks), candidates_(candidates_of(scene)) {
  cells_ = static_cast<uint32_t>(std::ceil(std::sqrt(2) / std::tan(scene.head().ray_coherence)));
  for (uint32_t i = 0; i < candidates_.size(); ++i) {
    const HitPlace& place = candidates_[i].place;
    by_place_[key_of(place.instance, candidates_[i].is_whole ? kNone : place.place.bits)] = i;
  }
}

void RayCoherence::note_hit(const HitPlace& place, const Vec3& origin, const Vec3& point) {
  uint32_t bits = place.place.bits;
  if (place.place.kind() == PointerKind::triangle) {        // the first of those that stand side by side
    if (place.place.place() / 8 >= blocks_.size()) return;  // of a frame's own, which are no candidates
    const auto id_at = [&](uint32_t i) { return blocks_[i / 8].primitives[i % 8]; };
    while (bits > 0 && id_at(bits - 1) == id_at(bits)) --bits;
  }
  auto found = by_place_.find(key_of(place.instance, bits));
  if (found == by_place_.end()) found = by_place_.find(key_of(place.instance, kNone));
  if (found == by_place_.end()) return;
  constexpr double kNear = 1e-6;  // far more than a ray's origin is moved off the surface
  last_ = (last_ + 1) % arrivals_.size();
  arrivals_[last_] = {found->second, point, kNear * (max_magnitude(origin) + max_magnitude(point))};
}

uint32_t RayCoherence::find_start(const Vec3& origin) const {
  for (size_t i = 0; i < arrivals_.size(); ++i) {  // the last first
    const Arrival& arrival = arrivals_[(last_ + arrivals_.size() - i) % arrivals_.size()];
    if (arrival.candidate == kNone || !(max_magnitude(origin - arrival.point) <= arrival.tolerance)) continue;
    // What is listed is right for any ray that begins in the ball.
    const Ball& ball = candidates_[arrival.candidate].ball;
    const Vec3 way = origin - ball.center;
    if (glm::dot(way, way) <= ball.radius * ball.radius) return arrival.candidate;
  }
  return kNone;
}

const RayCoherence::List* RayCoherence::find(const Vec3& origin, const Vec3& direction, bool& is_new) {
  is_new = false;
  const uint32_t from = find_start(origin);
  if (from == kNone) return nullptr;
  const uint64_t key = key_of(from, cell_of(direction));
  auto found = lists_.find(key);
  if (found == lists_.end()) {
    if (listed_ >= kMostListed) return nullptr;
    is_new = true;
    found = lists_.emplace(key, make_list(candidates_[from], static_cast<uint32_t>(key))).first;
    constexpr size_t kOfListItself = 8;
    listed_ += found->second.size() + kOfListItself;
  }
  return found->second.empty() ? nullptr : &found->second;
}

uint32_t RayCoherence::cell_of(const Vec3& direction) const {
  const Vec3 size = glm::abs(direction);
  const auto axis = static_cast<int>(largest_axis(direction));
  const auto place = [&](int other) {
    const double along = 0.5 * (direction[other] / size[axis] + 1) * cells_;
    return along > 0 ? static_cast<uint32_t>(std::min(along, cells_ - 1.0)) : 0;
  };
  const uint32_t face = 2 * static_cast<uint32_t>(axis) + (direction[axis] < 0 ? 1 : 0);
  return (face * cells_ + place((axis + 1) % 3)) * cells_ + place((axis + 2) % 3);
}

RayCoherence::List RayCoherence::make_list(const Candidate& from, uint32_t cell) const {
  const uint32_t face = cell / (cells_ * cells_), row = cell / cells_ % cells_, column = cell % cells_;
  const auto direction = [&](double a, double b) {
    const int axis = static_cast<int>(face / 2);
    Vec3 d;
    d[axis] = face % 2 == 0 ? 1 : -1;
    d[(axis + 1) % 3] = 2 * (row + a) / cells_ - 1;
    d[(axis + 2) % 3] = 2 * (column + b) / cells_ - 1;
    return d;
  };
  const auto angle = [](const Vec3& a, const Vec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  };
  const Vec3 middle = normalized(direction(0.5, 0.5));
  double half_angle = 0;
  for (const double a : {0.0, 1.0})
    for (const double b : {0.0, 1.0}) half_angle = std::max(half_angle, angle(middle, direction(a, b)));
  List list;
  for (uint32_t i = 0; i < candidates_.size(); ++i) {
    const Ball& ball = candidates_[i].ball;
    const Vec3 way = ball.center - from.ball.center;
    const double d = glm::length(way), r = from.ball.radius + ball.radius;
    if (d > r && angle(middle, way) > half_angle + std::asin(r / d) + kMargin) continue;
    if (list.size() == kMostInList) return {};
    const double least = d > r ? (d - r) * (1 - kMargin) : 0;
    list.push_back({round_down(least), i});
  }
  std::sort(list.begin(), list.end(), [](const Listed& a, const Listed& b) {
    return a.least_distance < b.least_distance ||
           (a.least_distance == b.least_distance && a.candidate < b.candidate);
  });
  return list;
}

}  // namespace rayfarm
