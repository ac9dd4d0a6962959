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

// Box distances are computed in float as plane × inverse + bias. Every step rounds by at most 2^-24 of
// |plane × inverse| <= |t| + |origin × inverse|; there are four of them (the inverse, the bias, the product
// and the sum). The part that grows with t is covered by widening the far distance, the other one by slack in
// the bias.
constexpr float kWiden = 1.0f + 0x1p-21f;
constexpr double kSlack = 0x1p-22;
constexpr int kStackSize = 7 * kMostHierarchyLevels + 8;

/// A float that no conservative comparison with `t` may fall below.
inline float widened(double t) {
  return static_cast<float>(t) * kWiden;
}

/// A ray in one space, prepared for box and triangle tests.
struct PreparedRay {
  Vec3 origin, direction;
  // Boxes.
  std::array<float, 3> inverse, near_bias, far_bias;
  std::array<uint32_t, 3> near_plane, far_plane;  ///< where the planes stand in a node, counted in floats
  // Triangles (Woop, Benthin, Wald 2013): the ray is sheared onto its largest axis kz.
  int kx, ky, kz;
  double shear_x, shear_y, shear_z;

  PreparedRay(const Vec3& o, const Vec3& d) : origin(o), direction(d) {
    const Vec3 magnitude = glm::abs(d);
    kz =
        magnitude.x > magnitude.y ? (magnitude.x > magnitude.z ? 0 : 2) : (magnitude.y > magnitude.z ? 1 : 2);
    kx = (kz + 1) % 3;
    ky = (kz + 2) % 3;
    shear_z = 1 / d[kz];
    shear_x = d[kx] / d[kz];
    shear_y = d[ky] / d[kz];
    // A direction that is nearly parallel to a plane acts as one that meets it at 10^18 times the other
    // distances: boxes are never thinner than their margin.
    const double least = 1e-18 * magnitude[kz];
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<int>(axis);
      const double exact = 1 / std::copysign(std::max(magnitude[i], least), d[i]);
      const double bias = -o[i] * exact, slack = kSlack * std::abs(bias);
      inverse[axis] = static_cast<float>(exact);
      near_bias[axis] = static_cast<float>(bias - slack);
      far_bias[axis] = static_cast<float>(bias + slack);
      const bool forward = exact > 0;
      near_plane[axis] = static_cast<uint32_t>(8 * (axis + (forward ? 0 : 3)));
      far_plane[axis] = static_cast<uint32_t>(8 * (axis + (forward ? 3 : 0)));
    }
  }
};

template <class D>
HWY_INLINE uint32_t bits_of(D d, hn::Mask<D> mask) {
  uint8_t bits[8];
  hn::StoreMaskBits(d, mask, bits);
  return bits[0];
}

/// Bit i of the result: the ray may meet child i's box in [0, t_max]. `entry` receives the children's near
/// distances.
HWY_INLINE uint32_t test_boxes(const VolumeNode& node, const PreparedRay& ray, float t_max,
                               float* HWY_RESTRICT entry) {
  const FloatTag d;
  const float* const planes = node.planes[0][0].data();
  uint32_t mask = 0;
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    const auto near_x = hn::MulAdd(hn::Load(d, planes + ray.near_plane[0] + lane), hn::Set(d, ray.inverse[0]),
                                   hn::Set(d, ray.near_bias[0]));
    const auto near_y = hn::MulAdd(hn::Load(d, planes + ray.near_plane[1] + lane), hn::Set(d, ray.inverse[1]),
                                   hn::Set(d, ray.near_bias[1]));
    const auto near_z = hn::MulAdd(hn::Load(d, planes + ray.near_plane[2] + lane), hn::Set(d, ray.inverse[2]),
                                   hn::Set(d, ray.near_bias[2]));
    const auto far_x = hn::MulAdd(hn::Load(d, planes + ray.far_plane[0] + lane), hn::Set(d, ray.inverse[0]),
                                  hn::Set(d, ray.far_bias[0]));
    const auto far_y = hn::MulAdd(hn::Load(d, planes + ray.far_plane[1] + lane), hn::Set(d, ray.inverse[1]),
                                  hn::Set(d, ray.far_bias[1]));
    const auto far_z = hn::MulAdd(hn::Load(d, planes + ray.far_plane[2] + lane), hn::Set(d, ray.inverse[2]),
                                  hn::Set(d, ray.far_bias[2]));
    const auto near = hn::Max(hn::Max(near_x, near_y), hn::Max(near_z, hn::Zero(d)));
    const auto far =
        hn::Min(hn::Mul(hn::Min(hn::Min(far_x, far_y), far_z), hn::Set(d, kWiden)), hn::Set(d, t_max));
    hn::Store(near, d, entry + lane);
    mask |= bits_of(d, hn::Le(near, far)) << lane;
  }
  return mask;
}

/// Bits of the lanes in which the ray meets a triangle at 0 < t <= t_max, with t and the barycentric weights
/// times a common factor.
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
    hn::Store(u, d, out_u + lane);
    hn::Store(v, d, out_v + lane);
    hn::Store(w, d, out_w + lane);
    mask |= bits_of(d, accepted) << lane;
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
  const auto a = hn::Set(d, glm::dot(ray.direction, ray.direction));
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
    mask |= bits_of(d, accepted) << lane;
  }
  return mask;
}

/// Tests leaves and keeps the closest hit.
class ClosestHit {
 public:
  ClosestHit(const Scene& scene, Hit& hit) : scene_(scene), hit_(hit), t_far_(widened(hit.t)) {}
  /// Boxes behind this distance need no visit.
  float t_far() const { return t_far_; }

  /// False: go on. True: the search is over (never, for a closest hit).
  HWY_INLINE bool test_leaf(const ChildRef& leaf, const PreparedRay& ray, uint32_t instance) {
    if (HWY_LIKELY(leaf.kind() == ChildKind::triangles))
      test_triangle_leaf(leaf, ray, instance);
    else
      test_other_leaf(leaf, ray, instance);
    return false;
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
  HWY_INLINE void test_triangle_leaf(const ChildRef& leaf, const PreparedRay& ray, uint32_t instance) {
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
      const TriangleBlock& block = scene_.triangle_blocks[i];
      HWY_ALIGN double t[8], u[8], v[8], w[8];
      for (uint32_t mask = test_triangles(block, ray, hit_.t, t, u, v, w); mask; mask &= mask - 1) {
        const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
        const PrimitiveId id = make_primitive_id(PrimitiveKind::triangle, block.triangles[lane]);
        if (hit_.is_beaten_by(t[lane], instance, id)) {
          const double determinant = (u[lane] + v[lane]) + w[lane];
          accept({t[lane], instance, id, 8 * i + lane, u[lane] / determinant, v[lane] / determinant,
                  w[lane] / determinant});
        }
      }
    }
  }

  HWY_NOINLINE void test_other_leaf(const ChildRef& leaf, const PreparedRay& ray, uint32_t instance) {
    if (leaf.kind() == ChildKind::spheres) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
        const SphereBlock& block = scene_.sphere_blocks[i];
        HWY_ALIGN double t[8];
        for (uint32_t mask = test_spheres(block, ray, hit_.t, t); mask; mask &= mask - 1) {
          const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
          const PrimitiveId id = make_primitive_id(PrimitiveKind::sphere, block.spheres[lane]);
          if (hit_.is_beaten_by(t[lane], instance, id)) accept({t[lane], instance, id, 0, 0, 0, 0});
        }
      }
    } else if (leaf.kind() == ChildKind::mixed) {
      for (const PrimitiveId id : scene_.leaf_primitives.subspan(leaf.first, leaf.count()))
        if (const auto t = intersect_one(scene_, id, ray, hit_.t); t && hit_.is_beaten_by(*t, instance, id))
          accept({*t, instance, id, 0, 0, 0, 0});
    }
  }

  void accept(const Hit& hit) {
    hit_ = hit;
    t_far_ = widened(hit.t);
  }

  const Scene& scene_;
  Hit& hit_;
  float t_far_;
};

/// Tests leaves until anything is hit.
class AnyHit {
 public:
  AnyHit(const Scene& scene, double t_max) : scene_(scene), t_max_(t_max), t_far_(widened(t_max)) {}
  float t_far() const { return t_far_; }

  HWY_INLINE bool test_leaf(const ChildRef& leaf, const PreparedRay& ray, uint32_t /*instance*/) const {
    if (HWY_LIKELY(leaf.kind() == ChildKind::triangles)) {
      HWY_ALIGN double t[8], u[8], v[8], w[8];
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (before_t_max(test_triangles(scene_.triangle_blocks[i], ray, t_max_, t, u, v, w), t)) return true;
      return false;
    }
    return test_other_leaf(leaf, ray);
  }

 private:
  HWY_NOINLINE bool test_other_leaf(const ChildRef& leaf, const PreparedRay& ray) const {
    if (leaf.kind() == ChildKind::spheres) {
      HWY_ALIGN double t[8];
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (before_t_max(test_spheres(scene_.sphere_blocks[i], ray, t_max_, t), t)) return true;
    } else if (leaf.kind() == ChildKind::mixed) {
      for (const PrimitiveId id : scene_.leaf_primitives.subspan(leaf.first, leaf.count()))
        if (const auto found = ClosestHit::intersect_one(scene_, id, ray, t_max_); found && *found < t_max_)
          return true;
    }
    return false;
  }
  bool before_t_max(uint32_t mask, const double* t) const {
    for (; mask; mask &= mask - 1)
      if (t[std::countr_zero(mask)] < t_max_) return true;
    return false;
  }
  const Scene& scene_;
  double t_max_;
  float t_far_;
};

/// Walks a tree of volume nodes: nearest child first, and nothing that lies behind the closest hit so far.
/// `visit_leaf(child)` returns true to end the search.
template <typename Search, typename VisitLeaf>
HWY_INLINE bool walk(const VolumeNode* HWY_RESTRICT nodes, ChildRef root, const PreparedRay& ray,
                     Search& search, VisitLeaf visit_leaf) {
  struct Entry {  // without initialisers, which would clear the whole stack for every ray
    uint32_t first, meta;
    float t;
    ChildRef child() const { return {first, meta}; }
  };
  const auto entry_of = [](ChildRef child, float t) HWY_ATTR { return Entry{child.first, child.meta, t}; };
  Entry stack[kStackSize];
  Entry* top = stack;
  ChildRef current = root;
  while (true) {
    while (current.kind() == ChildKind::inner) {
      const VolumeNode& node = nodes[current.first];
      HWY_ALIGN float entry[8];
      uint32_t mask = test_boxes(node, ray, search.t_far(), entry);
      if (mask == 0) goto next;
      const auto first = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      current = node.children[first];
      if (mask == 0) continue;
      // Of two, the farther waits.
      const auto second = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      if (mask == 0) {
        const bool in_order = entry[first] <= entry[second];
        const size_t later = in_order ? second : first;
        *top++ = entry_of(node.children[later], entry[later]);
        current = node.children[in_order ? first : second];
        continue;
      }
      // More are sorted on the stack, the nearest on top.
      Entry* const base = top;
      *top++ = entry_of(current, entry[first]);
      const auto insert = [&](size_t slot) HWY_ATTR {
        Entry* place = top++;
        for (; place > base && place[-1].t < entry[slot]; --place) *place = place[-1];
        *place = entry_of(node.children[slot], entry[slot]);
      };
      insert(second);
      for (; mask; mask &= mask - 1) insert(static_cast<size_t>(std::countr_zero(mask)));
      current = (--top)->child();
    }
    if (visit_leaf(current)) return true;
  next:
    do {
      if (top == stack) return false;
      --top;
    } while (top->t > search.t_far());
    current = top->child();
  }
}

template <typename Search>
bool walk_instance(const Scene& scene, const Pose& pose, const Ray& world_ray, const PreparedRay& prepared,
                   uint32_t instance, Search& search) {
  const Part& part = scene.parts[scene.instances[instance].part];
  const InstancePose& place = pose.instances[instance];
  const auto search_part = [&](const PreparedRay& ray) HWY_ATTR {
    return walk(scene.nodes.data(), part.root, ray, search,
                [&](const ChildRef& leaf) HWY_ATTR { return search.test_leaf(leaf, ray, instance); });
  };
  if (place.is_identity) return search_part(prepared);
  return search_part(PreparedRay(place.object_from_world.point(world_ray.origin),
                                 place.object_from_world.vector(world_ray.direction)));
}

template <typename Search>
HWY_INLINE bool walk_scene(const Scene& scene, const Pose& pose, const Ray& ray, Search& search) {
  const PreparedRay prepared(ray.origin, ray.direction);
  return walk(pose.nodes.data(), scene.head().object_root, prepared, search,
              [&](const ChildRef& leaf) HWY_ATTR {
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
