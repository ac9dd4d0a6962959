#include "common/hierarchy/traverser.h"

#include <bit>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/hierarchy/traverser.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/hierarchy/builder.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 8>;
using DoubleTag = hn::CappedTag<double, 8>;
using HalfFloatTag = hn::Rebind<float, DoubleTag>;

// Relative widening of box distances: covers the rounding of the reciprocal direction, the difference and the
// product (three roundings of 2^-24 each, and the reciprocal's).
constexpr float kWiden = 1.0f + 4.8e-7f;
constexpr float kNarrow = 1.0f - 4.8e-7f;
constexpr int kStackSize = 7 * kMostHierarchyLevels + 8;

inline float float_above(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) < v ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

/// A ray in one space, prepared for box and triangle tests.
struct PreparedRay {
  Vec3 origin, direction;
  // Boxes: the origin rounded away from the near and far planes, and the reciprocal direction.
  float near_origin[3], far_origin[3], inverse[3];
  int near_side[3];
  // Triangles (Woop, Benthin, Wald 2013): the ray is sheared onto its largest axis kz.
  int kx, ky, kz;
  double shear_x, shear_y, shear_z;
  double direction2;

  PreparedRay(const Vec3& o, const Vec3& d) : origin(o), direction(d) {
    for (int axis = 0; axis < 3; ++axis) {
      // A direction too small for a float's reciprocal acts as parallel; boxes are never thinner than their
      // margin.
      constexpr double kLeast = 1e-30;
      const double component = std::abs(d[axis]) < kLeast ? std::copysign(kLeast, d[axis]) : d[axis];
      inverse[axis] = static_cast<float>(1 / component);
      if (std::isinf(inverse[axis])) inverse[axis] = std::copysign(1e30f, inverse[axis]);
      const float up = float_above(o[axis]), down = -float_above(-o[axis]);
      const bool forward = component > 0;
      near_side[axis] = forward ? 0 : 1;
      near_origin[axis] = forward ? up : down;
      far_origin[axis] = forward ? down : up;
    }
    const Vec3 magnitude = glm::abs(d);
    kz =
        magnitude.x > magnitude.y ? (magnitude.x > magnitude.z ? 0 : 2) : (magnitude.y > magnitude.z ? 1 : 2);
    kx = (kz + 1) % 3;
    ky = (kz + 2) % 3;
    shear_x = d[kx] / d[kz];
    shear_y = d[ky] / d[kz];
    shear_z = 1 / d[kz];
    direction2 = glm::dot(d, d);
  }
};

/// Bit i of the result: the ray meets child i's box in [0, t_max]. `entry` receives the children's near
/// distances.
HWY_INLINE uint32_t test_boxes(const VolumeNode& node, const PreparedRay& ray, float t_max,
                               float* HWY_RESTRICT entry) {
  const FloatTag d;
  uint32_t mask = 0;
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    auto near = hn::Zero(d);
    auto far = hn::Set(d, t_max);
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<size_t>(axis);
      const auto inverse = hn::Set(d, ray.inverse[axis]);
      const auto side = static_cast<size_t>(ray.near_side[axis]);
      const auto near_plane = hn::Load(d, &node.planes[side][a][lane]);
      const auto far_plane = hn::Load(d, &node.planes[1 - side][a][lane]);
      near = hn::Max(near, hn::Mul(hn::Sub(near_plane, hn::Set(d, ray.near_origin[axis])), inverse));
      far = hn::Min(far, hn::Mul(hn::Sub(far_plane, hn::Set(d, ray.far_origin[axis])), inverse));
    }
    near = hn::Mul(near, hn::Set(d, kNarrow));
    far = hn::Mul(far, hn::Set(d, kWiden));
    hn::Store(near, d, entry + lane);
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Le(near, far), bits);
    mask |= static_cast<uint32_t>(bits[0]) << lane;
  }
  return mask;
}

struct Candidate {
  double t, u, v, w;
};

/// Bits of the lanes in which the ray meets a triangle at 0 < t <= t_max, with t and the barycentric weights.
HWY_INLINE uint32_t test_triangles(const TriangleBlock& block, const PreparedRay& ray, double t_max,
                                   double* HWY_RESTRICT out_t, double* HWY_RESTRICT out_u,
                                   double* HWY_RESTRICT out_v, double* HWY_RESTRICT out_w) {
  const DoubleTag d;
  const HalfFloatTag f;
  const auto zero = hn::Zero(d);
  uint32_t mask = 0;
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    const auto coordinate = [&](size_t vertex, int axis) HWY_ATTR {
      return hn::Sub(hn::PromoteTo(d, hn::Load(f, &block.vertices[vertex][static_cast<size_t>(axis)][lane])),
                     hn::Set(d, ray.origin[axis]));
    };
    const auto az = coordinate(0, ray.kz), bz = coordinate(1, ray.kz), cz = coordinate(2, ray.kz);
    const auto sx = hn::Set(d, ray.shear_x), sy = hn::Set(d, ray.shear_y);
    const auto ax = hn::Sub(coordinate(0, ray.kx), hn::Mul(sx, az));
    const auto ay = hn::Sub(coordinate(0, ray.ky), hn::Mul(sy, az));
    const auto bx = hn::Sub(coordinate(1, ray.kx), hn::Mul(sx, bz));
    const auto by = hn::Sub(coordinate(1, ray.ky), hn::Mul(sy, bz));
    const auto cx = hn::Sub(coordinate(2, ray.kx), hn::Mul(sx, cz));
    const auto cy = hn::Sub(coordinate(2, ray.ky), hn::Mul(sy, cz));
    // An edge's two triangles compute the same products, so no ray slips between them.
    const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto none_negative = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Ge(w, zero));
    const auto none_positive = hn::And(hn::And(hn::Le(u, zero), hn::Le(v, zero)), hn::Le(w, zero));
    const auto inside = hn::Or(none_negative, none_positive);
    if (hn::AllFalse(d, inside)) continue;
    const auto determinant = hn::Add(hn::Add(u, v), w);
    const auto scaled_t =
        hn::Mul(hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz)), hn::Set(d, ray.shear_z));
    const auto t = hn::Div(scaled_t, determinant);
    const auto in_range = hn::And(hn::Gt(t, zero), hn::Le(t, hn::Set(d, t_max)));
    const auto accepted = hn::And(hn::And(inside, in_range), hn::Ne(determinant, zero));
    if (hn::AllFalse(d, accepted)) continue;
    hn::Store(t, d, out_t + lane);
    hn::Store(hn::Div(u, determinant), d, out_u + lane);
    hn::Store(hn::Div(v, determinant), d, out_v + lane);
    hn::Store(hn::Div(w, determinant), d, out_w + lane);
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, accepted, bits);
    mask |= static_cast<uint32_t>(bits[0]) << lane;
  }
  return mask;
}

/// Bits of the lanes in which the ray meets a sphere at 0 < t <= t_max, with the smallest such t.
HWY_INLINE uint32_t test_spheres(const SphereBlock& block, const PreparedRay& ray, double t_max,
                                 double* HWY_RESTRICT out_t) {
  const DoubleTag d;
  const auto zero = hn::Zero(d);
  uint32_t mask = 0;
  const auto dx = hn::Set(d, ray.direction.x), dy = hn::Set(d, ray.direction.y),
             dz = hn::Set(d, ray.direction.z);
  const auto a = hn::Set(d, ray.direction2);
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    const auto ox = hn::Sub(hn::Set(d, ray.origin.x), hn::Load(d, &block.center[0][lane]));
    const auto oy = hn::Sub(hn::Set(d, ray.origin.y), hn::Load(d, &block.center[1][lane]));
    const auto oz = hn::Sub(hn::Set(d, ray.origin.z), hn::Load(d, &block.center[2][lane]));
    const auto r = hn::Load(d, &block.radius[lane]);
    const auto r2 = hn::Mul(r, r);
    const auto b = hn::Add(hn::Add(hn::Mul(ox, dx), hn::Mul(oy, dy)), hn::Mul(oz, dz));
    // The discriminant from the distance between centre and line, which loses no digits for far, small
    // spheres (Haines, Günther, Akenine-Möller, "Precision improvements for ray/sphere intersection", 2019).
    const auto closest = hn::Div(b, a);
    const auto px = hn::Sub(ox, hn::Mul(closest, dx));
    const auto py = hn::Sub(oy, hn::Mul(closest, dy));
    const auto pz = hn::Sub(oz, hn::Mul(closest, dz));
    const auto discriminant =
        hn::Sub(r2, hn::Add(hn::Add(hn::Mul(px, px), hn::Mul(py, py)), hn::Mul(pz, pz)));
    const auto meets = hn::Ge(discriminant, zero);
    if (hn::AllFalse(d, meets)) continue;
    const auto root = hn::Sqrt(hn::Mul(hn::Max(discriminant, zero), a));
    const auto c = hn::Sub(hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz)), r2);
    const auto approaching = hn::Lt(b, zero);
    const auto q = hn::Sub(hn::IfThenElse(approaching, root, hn::Neg(root)), b);
    const auto c_over_q = hn::Div(c, q), q_over_a = hn::Div(q, a);
    const auto first = hn::IfThenElse(approaching, c_over_q, q_over_a);
    const auto second = hn::IfThenElse(approaching, q_over_a, c_over_q);
    const auto t = hn::IfThenElse(hn::Gt(first, zero), first, second);
    const auto accepted = hn::And(meets, hn::And(hn::Gt(t, zero), hn::Le(t, hn::Set(d, t_max))));
    if (hn::AllFalse(d, accepted)) continue;
    hn::Store(t, d, out_t + lane);
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, accepted, bits);
    mask |= static_cast<uint32_t>(bits[0]) << lane;
  }
  return mask;
}

/// Tests leaves and keeps the closest hit.
class ClosestHit {
 public:
  ClosestHit(const Scene& scene, Hit& hit) : scene_(scene), hit_(hit) {}
  double t_max() const { return hit_.t; }

  /// False: go on. True: the search is over (never, for a closest hit).
  bool test_leaf(const ChildRef& leaf, const PreparedRay& ray, uint32_t instance) {
    switch (leaf.kind()) {
      case ChildKind::triangles:
        for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
          const TriangleBlock& block = scene_.triangle_blocks[i];
          HWY_ALIGN double t[8], u[8], v[8], w[8];
          for (uint32_t mask = test_triangles(block, ray, hit_.t, t, u, v, w); mask; mask &= mask - 1) {
            const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
            const PrimitiveId id = make_primitive_id(PrimitiveKind::triangle, block.triangles[lane]);
            if (hit_.is_beaten_by(t[lane], instance, id))
              hit_ = {t[lane], instance, id, 8 * i + lane, u[lane], v[lane], w[lane]};
          }
        }
        return false;
      case ChildKind::spheres:
        for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
          const SphereBlock& block = scene_.sphere_blocks[i];
          HWY_ALIGN double t[8];
          for (uint32_t mask = test_spheres(block, ray, hit_.t, t); mask; mask &= mask - 1) {
            const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
            accept(t[lane], instance, make_primitive_id(PrimitiveKind::sphere, block.spheres[lane]));
          }
        }
        return false;
      case ChildKind::mixed:
        for (const PrimitiveId id : scene_.leaf_primitives.subspan(leaf.first, leaf.count()))
          if (const auto t = intersect_one(scene_, id, ray, hit_.t)) accept(*t, instance, id);
        return false;
      default:
        return false;
    }
  }

  static std::optional<double> intersect_one(const Scene& scene, PrimitiveId id, const PreparedRay& ray,
                                             double t_max) {
    if (id.kind() == PrimitiveKind::polygon) {
      const Polygon& polygon = scene.polygons[id.index()];
      return intersect(polygon, scene.points_of(polygon), ray.origin, ray.direction, t_max);
    }
    const Quadric& quadric = scene.quadrics[id.index()];
    return intersect(quadric, scene.planes_of(quadric), ray.origin, ray.direction, t_max);
  }

 private:
  void accept(double t, uint32_t instance, PrimitiveId id) {
    if (hit_.is_beaten_by(t, instance, id)) hit_ = {t, instance, id, 0, 0, 0, 0};
  }
  const Scene& scene_;
  Hit& hit_;
};

/// Tests leaves until anything is hit.
class AnyHit {
 public:
  AnyHit(const Scene& scene, double t_max) : scene_(scene), t_max_(t_max) {}
  double t_max() const { return t_max_; }

  bool test_leaf(const ChildRef& leaf, const PreparedRay& ray, uint32_t /*instance*/) {
    HWY_ALIGN double t[8], u[8], v[8], w[8];
    switch (leaf.kind()) {
      case ChildKind::triangles:
        for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
          if (before_t_max(test_triangles(scene_.triangle_blocks[i], ray, t_max_, t, u, v, w), t))
            return true;
        return false;
      case ChildKind::spheres:
        for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
          if (before_t_max(test_spheres(scene_.sphere_blocks[i], ray, t_max_, t), t)) return true;
        return false;
      case ChildKind::mixed:
        for (const PrimitiveId id : scene_.leaf_primitives.subspan(leaf.first, leaf.count()))
          if (const auto found = ClosestHit::intersect_one(scene_, id, ray, t_max_); found && *found < t_max_)
            return true;
        return false;
      default:
        return false;
    }
  }

 private:
  bool before_t_max(uint32_t mask, const double* t) const {
    for (; mask; mask &= mask - 1)
      if (t[std::countr_zero(mask)] < t_max_) return true;
    return false;
  }
  const Scene& scene_;
  double t_max_;
};

/// Walks a tree of volume nodes: nearest child first, and nothing that lies behind the closest hit so far.
/// `visit_leaf(child)` returns true to end the search.
template <typename Search, typename VisitLeaf>
HWY_INLINE bool walk(std::span<const VolumeNode> nodes, ChildRef root, const PreparedRay& ray, Search& search,
                     VisitLeaf visit_leaf) {
  struct Entry {
    ChildRef child;
    float t;
  };
  if (root.kind() == ChildKind::empty) return false;
  if (root.kind() != ChildKind::inner) return visit_leaf(root);
  Entry stack[kStackSize];
  int top = 0;
  ChildRef current = root;
  while (true) {
    const VolumeNode& node = nodes[current.first];
    HWY_ALIGN float entry[8];
    uint32_t mask = test_boxes(node, ray, float_above(search.t_max()), entry);
    // Insert the children that are met into the stack, farthest first.
    const int base = top;
    for (; mask; mask &= mask - 1) {
      const auto lane = static_cast<size_t>(std::countr_zero(mask));
      int place = top++;
      for (; place > base && stack[place - 1].t < entry[lane]; --place) stack[place] = stack[place - 1];
      stack[place] = {node.children[lane], entry[lane]};
    }
    // Take the nearest; leaves are tested at once, and what now lies behind the closest hit is dropped.
    while (true) {
      if (top == 0) return false;
      const Entry next = stack[--top];
      if (static_cast<double>(next.t) > search.t_max()) continue;
      if (next.child.kind() == ChildKind::inner) {
        current = next.child;
        break;
      }
      if (visit_leaf(next.child)) return true;
    }
  }
}

template <typename Search>
bool walk_instance(const Scene& scene, const Pose& pose, const Ray& world_ray, const PreparedRay& prepared,
                   uint32_t instance, Search& search) {
  const Part& part = scene.parts[scene.instances[instance].part];
  const InstancePose& place = pose.instances[instance];
  const auto search_part = [&](const PreparedRay& ray) HWY_ATTR {
    return walk(scene.nodes, part.root, ray, search,
                [&](const ChildRef& leaf) HWY_ATTR { return search.test_leaf(leaf, ray, instance); });
  };
  if (place.is_identity) return search_part(prepared);
  return search_part(PreparedRay(place.object_from_world.point(world_ray.origin),
                                 place.object_from_world.vector(world_ray.direction)));
}

template <typename Search>
HWY_INLINE bool walk_scene(const Scene& scene, const Pose& pose, const Ray& ray, Search& search) {
  const PreparedRay prepared(ray.origin, ray.direction);
  return walk(pose.nodes, scene.head().object_root, prepared, search, [&](const ChildRef& leaf) HWY_ATTR {
    for (const uint32_t instance : scene.leaf_instances.subspan(leaf.first, leaf.count()))
      if (walk_instance(scene, pose, ray, prepared, instance, search)) return true;
    return false;
  });
}

Hit find_closest(const Scene& scene, const Pose& pose, const Ray& ray) {
  Hit hit;
  hit.t = ray.t_max;
  ClosestHit search(scene, hit);
  walk_scene(scene, pose, ray, search);
  return hit;
}

bool find_any(const Scene& scene, const Pose& pose, const Ray& ray) {
  AnyHit search(scene, ray.t_max);
  return walk_scene(scene, pose, ray, search);
}

Hit find_closest_brute_force(const Scene& scene, const Pose& pose, const Ray& ray) {
  Hit hit;
  hit.t = ray.t_max;
  ClosestHit search(scene, hit);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Part& part = scene.parts[scene.instances[i].part];
    const Affine& inverse = pose.instances[i].object_from_world;
    const PreparedRay local = pose.instances[i].is_identity
                                  ? PreparedRay(ray.origin, ray.direction)
                                  : PreparedRay(inverse.point(ray.origin), inverse.vector(ray.direction));
    search.test_leaf(make_child(ChildKind::triangles, part.first_triangle_block, part.triangle_block_count),
                     local, i);
    search.test_leaf(make_child(ChildKind::spheres, part.first_sphere_block, part.sphere_block_count), local,
                     i);
    search.test_leaf(make_child(ChildKind::mixed, part.first_leaf_primitive, part.leaf_primitive_count),
                     local, i);
  }
  return hit;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(find_closest);
HWY_EXPORT(find_any);
HWY_EXPORT(find_closest_brute_force);

Hit closest_hit(const Scene& scene, const Pose& pose, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_closest)(scene, pose, ray);
}

bool any_hit(const Scene& scene, const Pose& pose, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_any)(scene, pose, ray);
}

Hit closest_hit_brute_force(const Scene& scene, const Pose& pose, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_closest_brute_force)(scene, pose, ray);
}

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const auto target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

void force_simd_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  if (!name.empty())
    for (const auto target : hwy::SupportedAndGeneratedTargets())
      if (name == hwy::TargetName(target)) {
        hwy::SetSupportedTargetsForTest(target);
        break;
      }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace rayfarm
#endif
