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
// and the sum). The part that grows with t is covered by widening the far distances, the other one by slack
// in the bias.
constexpr double kWiden = 1 + 0x1p-21;
constexpr double kSlack = 0x1p-21;
constexpr int kStackSize = 7 * kMostHierarchyLevels + 8;

/// A float that no conservative comparison with `t` may fall below.
inline float widened(double t) {
  return static_cast<float>(t * kWiden);
}

template <class D>
HWY_INLINE uint32_t bits_of(D d, hn::Mask<D> mask) {
  uint8_t bits[8];
  hn::StoreMaskBits(d, mask, bits);
  return bits[0];
}

using WideTag = hn::CappedTag<double, 4>;
using NarrowTag = hn::Rebind<float, WideTag>;

/// A ray in one space, prepared for box and triangle tests.
struct PreparedRay {
  HWY_ALIGN std::array<double, 4> origin, direction;  ///< the fourth element of each array is padding
  // Boxes.
  std::array<float, 4> near_inverse, near_bias, far_inverse, far_bias;
  uint32_t backward;  ///< bit i: component i of the direction is negative
  // Triangles (Woop, Benthin, Wald 2013): the ray is sheared onto its largest axis kz.
  uint32_t kx, ky, kz;
  double shear_x, shear_y, shear_z;

  /// From a ray in the world.
  HWY_INLINE explicit PreparedRay(const Ray& ray) {
    // The fourth element that is read here is the member behind the vector.
    static_assert(offsetof(Ray, direction) == 3 * sizeof(double) && sizeof(Ray) == 7 * sizeof(double));
    const auto* const numbers = reinterpret_cast<const double*>(&ray);
    const WideTag d;
    for (size_t i = 0; i < 4; i += hn::Lanes(d)) {
      hn::Store(hn::LoadU(d, numbers + i), d, &origin[i]);
      hn::Store(hn::LoadU(d, numbers + 3 + i), d, &direction[i]);
    }
    prepare();
  }
  HWY_INLINE PreparedRay(const Vec3& o, const Vec3& d)
      : origin{o.x, o.y, o.z, 0}, direction{d.x, d.y, d.z, 0} {
    prepare();
  }
  Vec3 origin_vector() const { return {origin[0], origin[1], origin[2]}; }
  Vec3 direction_vector() const { return {direction[0], direction[1], direction[2]}; }

 private:
  HWY_INLINE void prepare() {
    const double x = std::abs(direction[0]), y = std::abs(direction[1]), z = std::abs(direction[2]);
    const double largest_xy = std::max(x, y), largest = std::max(largest_xy, z);
    const auto y_over_x = static_cast<uint32_t>(y > x), z_over_all = static_cast<uint32_t>(z >= largest_xy);
    kz = y_over_x + (2 - y_over_x) * z_over_all;  // no branch: no one could predict it
    kx = 0x021u >> (4 * kz) & 3;                  // (kz + 1) mod 3
    ky = 0x102u >> (4 * kz) & 3;                  // (kz + 2) mod 3
    // A direction that is nearly parallel to a plane acts as one that meets it, but far behind all else:
    // boxes are never thinner than their margin.
    const WideTag wide;
    const NarrowTag narrow;
    HWY_ALIGN double inverses[4];
    const auto least = hn::Set(wide, HWY_UNLIKELY(largest < 1e-3) ? 1e-18 * largest : 1e-20);
    backward = 0;
    for (size_t i = 0; i < 4; i += hn::Lanes(wide)) {
      const auto component = hn::Load(wide, &direction[i]);
      const auto inverse =
          hn::Div(hn::Set(wide, 1.0), hn::CopySign(hn::Max(hn::Abs(component), least), component));
      const auto bias = hn::Neg(hn::Mul(hn::Load(wide, &origin[i]), inverse));
      const auto slack = hn::Mul(hn::Abs(bias), hn::Set(wide, kSlack));
      hn::Store(inverse, wide, inverses + i);
      hn::Store(hn::DemoteTo(narrow, inverse), narrow, &near_inverse[i]);
      hn::Store(hn::DemoteTo(narrow, hn::Mul(inverse, hn::Set(wide, kWiden))), narrow, &far_inverse[i]);
      hn::Store(hn::DemoteTo(narrow, hn::Sub(bias, slack)), narrow, &near_bias[i]);
      hn::Store(hn::DemoteTo(narrow, hn::Add(bias, hn::Add(slack, slack))), narrow, &far_bias[i]);
      backward |= bits_of(wide, hn::Lt(component, hn::Zero(wide))) << i;
    }
    shear_z = inverses[kz];
    shear_x = direction[kx] * shear_z;
    shear_y = direction[ky] * shear_z;
  }
};

/// The box test of one ray, with its constants in registers.
class BoxTest {
 public:
  HWY_INLINE explicit BoxTest(const PreparedRay& ray)
      : near_inverse_x_(hn::Set(d_, ray.near_inverse[0])),
        far_inverse_x_(hn::Set(d_, ray.far_inverse[0])),
        near_inverse_y_(hn::Set(d_, ray.near_inverse[1])),
        far_inverse_y_(hn::Set(d_, ray.far_inverse[1])),
        near_inverse_z_(hn::Set(d_, ray.near_inverse[2])),
        far_inverse_z_(hn::Set(d_, ray.far_inverse[2])),
        near_bias_x_(hn::Set(d_, ray.near_bias[0])),
        near_bias_y_(hn::Set(d_, ray.near_bias[1])),
        near_bias_z_(hn::Set(d_, ray.near_bias[2])),
        far_bias_x_(hn::Set(d_, ray.far_bias[0])),
        far_bias_y_(hn::Set(d_, ray.far_bias[1])),
        far_bias_z_(hn::Set(d_, ray.far_bias[2])),
        near_x_(24 * (ray.backward & 1)),
        near_y_(8 + 24 * (ray.backward >> 1 & 1)),
        near_z_(16 + 24 * (ray.backward >> 2 & 1)),
        far_x_(24u - near_x_),
        far_y_(40u - near_y_),
        far_z_(56u - near_z_) {}

  /// Bit i of the result: the ray may meet child i's box in [0, t_far]. `entry` receives the children's near
  /// distances.
  HWY_INLINE uint32_t operator()(const VolumeNode& node, float t_far, float* HWY_RESTRICT entry) const {
    const float* const planes = node.planes[0][0].data();
    uint32_t mask = 0;
    for (size_t lane = 0; lane < 8; lane += hn::Lanes(d_)) {
      const auto near_x = hn::MulAdd(hn::Load(d_, planes + near_x_ + lane), near_inverse_x_, near_bias_x_);
      const auto near_y = hn::MulAdd(hn::Load(d_, planes + near_y_ + lane), near_inverse_y_, near_bias_y_);
      const auto near_z = hn::MulAdd(hn::Load(d_, planes + near_z_ + lane), near_inverse_z_, near_bias_z_);
      const auto far_x = hn::MulAdd(hn::Load(d_, planes + far_x_ + lane), far_inverse_x_, far_bias_x_);
      const auto far_y = hn::MulAdd(hn::Load(d_, planes + far_y_ + lane), far_inverse_y_, far_bias_y_);
      const auto far_z = hn::MulAdd(hn::Load(d_, planes + far_z_ + lane), far_inverse_z_, far_bias_z_);
      const auto near = hn::Max(hn::Max(near_x, near_y), hn::Max(near_z, hn::Zero(d_)));
      const auto far = hn::Min(hn::Min(far_x, far_y), hn::Min(far_z, hn::Set(d_, t_far)));
      hn::Store(near, d_, entry + lane);
      mask |= bits_of(d_, hn::Le(near, far)) << lane;
    }
    return mask;
  }

 private:
  using V = hn::Vec<FloatTag>;
  FloatTag d_;
  V near_inverse_x_, far_inverse_x_, near_inverse_y_, far_inverse_y_, near_inverse_z_, far_inverse_z_;
  V near_bias_x_, near_bias_y_, near_bias_z_, far_bias_x_, far_bias_y_, far_bias_z_;
  size_t near_x_, near_y_, near_z_, far_x_, far_y_,
      far_z_;  ///< where the planes stand in a node, counted in floats
};

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
    const auto coordinate = [&](size_t vertex, size_t axis) HWY_ATTR {
      return hn::Sub(hn::PromoteTo(d, hn::Load(f, &block.vertices[vertex][axis][lane])),
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
  const auto dx = hn::Set(d, ray.direction[0]), dy = hn::Set(d, ray.direction[1]),
             dz = hn::Set(d, ray.direction[2]);
  const auto a = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    const auto ox = hn::Sub(hn::Set(d, ray.origin[0]), hn::Load(d, &block.center[0][lane]));
    const auto oy = hn::Sub(hn::Set(d, ray.origin[1]), hn::Load(d, &block.center[1][lane]));
    const auto oz = hn::Sub(hn::Set(d, ray.origin[2]), hn::Load(d, &block.center[2][lane]));
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
  static constexpr bool kNearestFirst = true;
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
      return intersect(polygon, scene.points_of(polygon), ray.origin_vector(), ray.direction_vector(), t_max);
    }
    const Quadric& quadric = scene.quadrics[id.index()];
    return intersect(quadric, scene.planes_of(quadric), ray.origin_vector(), ray.direction_vector(), t_max);
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
  static constexpr bool kNearestFirst = false;  // the sorting would cost more than it saves
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

/// Walks a tree of volume nodes; if the search asks for it, nearest child first and nothing that lies behind
/// the closest hit so far. `visit_leaf(child)` returns true to end the search.
template <typename Search, typename VisitLeaf>
HWY_INLINE bool walk(const VolumeNode* HWY_RESTRICT nodes, ChildRef root, const PreparedRay& ray,
                     Search& search, VisitLeaf visit_leaf) {
  struct Entry {
    uint64_t child;  ///< a ChildRef
    float t;
  };
  Entry stack[kStackSize];  // not initialised: clearing it would cost more than many a walk
  Entry* top = stack;
  uint64_t current = std::bit_cast<uint64_t>(root);
  const auto child_of = [](const VolumeNode& node, size_t slot)
                            HWY_ATTR { return std::bit_cast<uint64_t>(node.children[slot]); };
  while (true) {
    const BoxTest test_boxes(ray);  // here, so that a visit to a leaf need not save and restore its registers
    while (std::bit_cast<ChildRef>(current).kind() == ChildKind::inner) {
      const VolumeNode& node = nodes[std::bit_cast<ChildRef>(current).first];
      HWY_ALIGN float entry[8];
      uint32_t mask = test_boxes(node, search.t_far(), entry);
      if (mask == 0) goto next;
      const auto first = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      current = child_of(node, first);
      if (mask == 0) continue;
      if constexpr (!Search::kNearestFirst) {
        for (; mask; mask &= mask - 1)
          *top++ = {child_of(node, static_cast<size_t>(std::countr_zero(mask))), 0};
        continue;
      }
      // Of two, the farther waits.
      const auto second = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      if (mask == 0) {
        const uint64_t other = child_of(node, second);
        if (entry[first] <= entry[second]) {
          *top++ = {other, entry[second]};
        } else {
          *top++ = {current, entry[first]};
          current = other;
        }
        continue;
      }
      // More are sorted on the stack, the nearest on top.
      Entry* const base = top;
      *top++ = {current, entry[first]};
      const auto insert = [&](size_t slot) HWY_ATTR {
        Entry* place = top++;
        for (; place > base && place[-1].t < entry[slot]; --place) *place = place[-1];
        *place = {child_of(node, slot), entry[slot]};
      };
      insert(second);
      for (; mask; mask &= mask - 1) insert(static_cast<size_t>(std::countr_zero(mask)));
      current = (--top)->child;
    }
    if (visit_leaf(std::bit_cast<ChildRef>(current))) return true;
  next:
    do {
      if (top == stack) return false;
      --top;
    } while (Search::kNearestFirst && top->t > search.t_far());
    current = top->child;
  }
}

template <typename Search>
HWY_INLINE bool walk_part(const Scene& scene, uint32_t instance, const PreparedRay& ray, Search& search) {
  const Part& part = scene.parts[scene.instances[instance].part];
  return walk(
      scene.nodes.data(), part.root, ray,
      search, [&](const ChildRef& leaf) HWY_ATTR __attribute__((always_inline)) {
        return search.test_leaf(leaf, ray, instance);
      });
}

/// Walks the parts of a leaf of the object part.
template <typename Search>
HWY_NOINLINE bool walk_instances(const Scene& scene, const Pose& pose, const PreparedRay& world_ray,
                                 const ChildRef& leaf, Search& search) {
  for (const uint32_t instance : scene.leaf_instances.subspan(leaf.first, leaf.count())) {
    const InstancePose& place = pose.instances[instance];
    const bool is_over =
        place.is_identity
            ? walk_part(scene, instance, world_ray, search)
            : walk_part(scene, instance,
                        PreparedRay(place.object_from_world.point(world_ray.origin_vector()),
                                    place.object_from_world.vector(world_ray.direction_vector())),
                        search);
    if (is_over) return true;
  }
  return false;
}

template <typename Search>
HWY_INLINE bool walk_scene(const Scene& scene, const Pose& pose, const Ray& ray, Search& search) {
  const PreparedRay prepared(ray);
  const ChildRef root = scene.head().object_root;
  if (root.kind() == ChildKind::empty) return false;
  if (root.kind() == ChildKind::instances) return walk_instances(scene, pose, prepared, root, search);
  return walk(pose.nodes.data(), root, prepared, search, [&](const ChildRef& leaf) HWY_ATTR {
    return walk_instances(scene, pose, prepared, leaf, search);
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
                                  ? PreparedRay(ray)
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
