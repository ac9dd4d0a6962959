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

/// The least magnitude that a direction's component counts with. A direction that is nearly parallel to a
/// plane acts as one that meets it, but far behind all else: boxes are never thinner than their margin.
inline double least_component(double largest) {
  return HWY_UNLIKELY(largest < 1e-3) ? 1e-18 * largest : 1e-20;
}

using WideTag = hn::CappedTag<double, 4>;
using NarrowTag = hn::Rebind<float, WideTag>;

/// What the box test needs to know of a ray, or of a packet of them: distances to near and far planes are
/// plane × inverse + bias, bounded from below and above. The fourth elements are padding.
struct BoxRay {
  HWY_ALIGN std::array<float, 4> near_inverse, near_bias, far_inverse, far_bias;
  uint32_t backward;  ///< bit i: component i of the direction is negative
};

/// What primitive tests need to know of a ray.
struct PrimitiveRay {
  HWY_ALIGN std::array<double, 4> origin, direction;  ///< the fourth elements are padding
  // Triangles (Woop, Benthin, Wald 2013): the ray is sheared onto its largest axis kz.
  uint32_t kx, ky, kz;
  double shear_x, shear_y, shear_z;

  Vec3 origin_vector() const { return {origin[0], origin[1], origin[2]}; }
  Vec3 direction_vector() const { return {direction[0], direction[1], direction[2]}; }
  HWY_INLINE void set_axes(uint32_t largest_axis) {
    kz = largest_axis;
    kx = 0x021u >> (4 * kz) & 3;  // (kz + 1) mod 3
    ky = 0x102u >> (4 * kz) & 3;  // (kz + 2) mod 3
  }
};

/// A ray in one space, prepared for box and primitive tests.
struct PreparedRay : BoxRay, PrimitiveRay {
  /// A ray in the world.
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
  HWY_INLINE explicit PreparedRay(const PrimitiveRay& ray) : PrimitiveRay(ray) { prepare(); }
  /// The same ray in the space of an instance.
  HWY_INLINE PreparedRay(const PrimitiveRay& world, const Affine& object_from_world) {
    const Vec3 o = object_from_world.point(world.origin_vector());
    const Vec3 d = object_from_world.vector(world.direction_vector());
    origin = {o.x, o.y, o.z, 0};
    direction = {d.x, d.y, d.z, 0};
    prepare();
  }

 private:
  HWY_INLINE void prepare() {
    const double x = std::abs(direction[0]), y = std::abs(direction[1]), z = std::abs(direction[2]);
    const double largest_xy = std::max(x, y), largest = std::max(largest_xy, z);
    const auto y_over_x = static_cast<uint32_t>(y > x), z_over_all = static_cast<uint32_t>(z >= largest_xy);
    set_axes(y_over_x + (2 - y_over_x) * z_over_all);  // no branch: no one could predict it
    const WideTag wide;
    const NarrowTag narrow;
    HWY_ALIGN double inverses[4];
    const auto least = hn::Set(wide, least_component(largest));
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
      backward |= bits_of(wide, hn::Lt(inverse, hn::Zero(wide))) << i;  // of the inverse: -0 is negative too
    }
    backward &= 7;
    shear_z = inverses[kz];
    shear_x = direction[kx] * shear_z;
    shear_y = direction[ky] * shear_z;
  }
};

/// The box test of a ray or packet, with its constants in registers.
class BoxTest {
 public:
  HWY_INLINE explicit BoxTest(const BoxRay& ray)
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

/// A block's vertices: [vertex][axis][lane].
template <typename Number>
using Vertices = std::array<std::array<std::array<Number, 8>, 3>, 3>;

HWY_INLINE void convert(const Vertices<float>& from, Vertices<double>& to) {
  const DoubleTag d;
  const HalfFloatTag f;
  for (size_t vertex = 0; vertex < 3; ++vertex)
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t lane = 0; lane < 8; lane += hn::Lanes(d))
        hn::Store(hn::PromoteTo(d, hn::Load(f, &from[vertex][axis][lane])), d, &to[vertex][axis][lane]);
}

/// Bits of the lanes in which the ray meets a triangle at 0 < t <= t_max, with t and the barycentric weights
/// times a common factor. The vertices may have been converted before, for several rays.
template <typename Number>
HWY_INLINE uint32_t test_triangles(const Vertices<Number>& vertices, const PrimitiveRay& ray, double t_max,
                                   double* HWY_RESTRICT out_t, double* HWY_RESTRICT out_u,
                                   double* HWY_RESTRICT out_v, double* HWY_RESTRICT out_w) {
  const DoubleTag d;
  [[maybe_unused]] const HalfFloatTag f;
  const auto zero = hn::Zero(d);
  uint32_t mask = 0;
  for (size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
    const auto coordinate = [&](size_t vertex, size_t axis) HWY_ATTR {
      const Number* const numbers = &vertices[vertex][axis][lane];
      if constexpr (std::is_same_v<Number, float>)
        return hn::Sub(hn::PromoteTo(d, hn::Load(f, numbers)), hn::Set(d, ray.origin[axis]));
      else
        return hn::Sub(hn::Load(d, numbers), hn::Set(d, ray.origin[axis]));
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
HWY_INLINE uint32_t test_spheres(const SphereBlock& block, const PrimitiveRay& ray, double t_max,
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
  ClosestHit() = default;
  /// `hit.t` bounds the search.
  ClosestHit(const Scene& scene, Hit& hit) : scene_(&scene), hit_(&hit), t_far_(widened(hit.t)) {}
  /// Boxes behind this distance need no visit.
  float t_far() const { return t_far_; }
  static bool is_over() { return false; }

  /// False: go on. True: the search is over (never, for a closest hit).
  HWY_INLINE bool test_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (HWY_LIKELY(leaf.kind() == ChildKind::triangles)) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        test_block(i, scene_->triangle_blocks[i].vertices, ray, instance);
    } else {
      test_other_leaf(leaf, ray, instance);
    }
    return false;
  }

  /// Tests one block of triangles.
  template <typename Number>
  HWY_INLINE bool test_block(uint32_t index, const Vertices<Number>& vertices, const PrimitiveRay& ray,
                             uint32_t instance) {
    HWY_ALIGN double t[8], u[8], v[8], w[8];
    for (uint32_t mask = test_triangles(vertices, ray, hit_->t, t, u, v, w); mask; mask &= mask - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
      const PrimitiveId id = scene_->triangle_blocks[index].primitives[lane];
      if (hit_->is_beaten_by(t[lane], instance, id)) {
        const double determinant = (u[lane] + v[lane]) + w[lane];
        accept({t[lane], instance, id, 8 * index + lane, u[lane] / determinant, v[lane] / determinant,
                w[lane] / determinant});
      }
    }
    return false;
  }

  static std::optional<double> intersect_one(const Scene& scene, PrimitiveId id, const PrimitiveRay& ray,
                                             double t_max) {
    if (id.kind() == PrimitiveKind::polygon) {
      const Polygon& polygon = scene.polygons[id.index()];
      return intersect(polygon, scene.points_of(polygon), ray.origin_vector(), ray.direction_vector(), t_max);
    }
    const Quadric& quadric = scene.quadrics[id.index()];
    return intersect(quadric, scene.planes_of(quadric), ray.origin_vector(), ray.direction_vector(), t_max);
  }

 private:
  HWY_NOINLINE void test_other_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (leaf.kind() == ChildKind::spheres) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
        const SphereBlock& block = scene_->sphere_blocks[i];
        HWY_ALIGN double t[8];
        for (uint32_t mask = test_spheres(block, ray, hit_->t, t); mask; mask &= mask - 1) {
          const auto lane = static_cast<uint32_t>(std::countr_zero(mask));
          const PrimitiveId id = make_primitive_id(PrimitiveKind::sphere, block.spheres[lane]);
          if (hit_->is_beaten_by(t[lane], instance, id)) accept({t[lane], instance, id});
        }
      }
    } else if (leaf.kind() == ChildKind::mixed) {
      for (const PrimitiveId id : scene_->leaf_primitives.subspan(leaf.first, leaf.count()))
        if (const auto t = intersect_one(*scene_, id, ray, hit_->t);
            t && hit_->is_beaten_by(*t, instance, id))
          accept({*t, instance, id});
    }
  }

  void accept(const Hit& hit) {
    *hit_ = hit;
    t_far_ = widened(hit.t);
  }

  const Scene* scene_ = nullptr;
  Hit* hit_ = nullptr;
  float t_far_ = 0;
};

/// Tests leaves until anything is hit.
class AnyHit {
 public:
  static constexpr bool kNearestFirst = false;  // the sorting would cost more than it saves
  AnyHit() = default;
  AnyHit(const Scene& scene, double t_max) : scene_(&scene), t_max_(t_max), t_far_(widened(t_max)) {}
  float t_far() const { return t_far_; }
  bool is_over() const { return is_over_; }

  HWY_INLINE bool test_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    if (HWY_LIKELY(leaf.kind() == ChildKind::triangles)) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (test_block(i, scene_->triangle_blocks[i].vertices, ray, instance)) return true;
      return false;
    }
    return is_over_ = test_other_leaf(leaf, ray);
  }

  template <typename Number>
  HWY_INLINE bool test_block(uint32_t /*index*/, const Vertices<Number>& vertices, const PrimitiveRay& ray,
                             uint32_t /*instance*/) {
    HWY_ALIGN double t[8], u[8], v[8], w[8];
    return is_over_ = before_t_max(test_triangles(vertices, ray, t_max_, t, u, v, w), t);
  }

 private:
  HWY_NOINLINE bool test_other_leaf(const ChildRef& leaf, const PrimitiveRay& ray) const {
    if (leaf.kind() == ChildKind::spheres) {
      HWY_ALIGN double t[8];
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i)
        if (before_t_max(test_spheres(scene_->sphere_blocks[i], ray, t_max_, t), t)) return true;
    } else if (leaf.kind() == ChildKind::mixed) {
      for (const PrimitiveId id : scene_->leaf_primitives.subspan(leaf.first, leaf.count()))
        if (const auto found = ClosestHit::intersect_one(*scene_, id, ray, t_max_); found && *found < t_max_)
          return true;
    }
    return false;
  }
  bool before_t_max(uint32_t mask, const double* t) const {
    for (; mask; mask &= mask - 1)
      if (t[std::countr_zero(mask)] < t_max_) return true;
    return false;
  }
  const Scene* scene_ = nullptr;
  double t_max_ = 0;
  float t_far_ = 0;
  bool is_over_ = false;
};

/// One ray's walk through the hierarchy. A walker tells `walk` how far to look and which rays meet a child.
template <typename Search>
class SingleWalker {
 public:
  static constexpr bool kNearestFirst = Search::kNearestFirst;
  /// There is but one ray, so sets of rays need no bits.
  struct RaySet {};
  struct RaySets {
    RaySet operator[](size_t) const { return {}; }
  };
  static constexpr RaySet kAll{};
  SingleWalker(const PreparedRay& ray, Search& search) : ray_(ray), search_(search) {}
  const BoxRay& box_ray() const { return ray_; }
  float t_far() const { return search_.t_far(); }
  HWY_INLINE uint32_t without_missed_children(const VolumeNode&, uint32_t mask, RaySet, RaySets&) const {
    return mask;
  }
  /// True ends the walk.
  HWY_INLINE bool visit_leaf(const ChildRef& leaf, uint32_t instance, RaySet) {
    return search_.test_leaf(leaf, ray_, instance);
  }

 private:
  const PreparedRay& ray_;
  Search& search_;
};

constexpr size_t kPacketRays = kMostPacketRays;
constexpr uint32_t kAllRays = (1u << kPacketRays) - 1;

/// Rays whose directions have the same signs and that walk together: one box test serves them all, with the
/// bounds of their origins and directions; at a leaf each is tested by itself, exactly as if it had come
/// alone.
class Packet {
 public:
  using Lanes = std::array<float, kPacketRays>;

  /// False if the rays are no packet: one alone, or of different signs. Then nothing else here holds.
  HWY_INLINE bool join(std::span<const PrimitiveRay> rays) {
    if (rays.size() < 2) return false;
    HWY_ALIGN double origins[3][kPacketRays], directions[3][kPacketRays];
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t i = 0; i < kPacketRays; ++i) {  // the last ray fills up
        const PrimitiveRay& ray = rays[std::min(i, rays.size() - 1)];
        origins[axis][i] = ray.origin[axis];
        directions[axis][i] = ray.direction[axis];
      }
    return set_bounds(origins, directions) && prepare_lanes(origins, directions);
  }
  /// Fills in what primitive tests need of the rays, beside origin and direction.
  HWY_INLINE void prepare(std::span<PrimitiveRay> rays) const {
    for (size_t i = 0; i < rays.size(); ++i) {
      rays[i].set_axes(z_over_all_ >> i & 1 ? 2 : y_over_x_ >> i & 1);
      rays[i].shear_x = shear_[0][i];
      rays[i].shear_y = shear_[1][i];
      rays[i].shear_z = shear_[2][i];
    }
  }

  const BoxRay& bounds() const { return bounds_; }

  /// The bits of the rays that may meet a child's box in [0, t_fars[ray]].
  HWY_INLINE uint32_t rays_meeting(const VolumeNode& node, size_t slot, const Lanes& t_fars) const {
    const FloatTag d;
    uint32_t result = 0;
    for (size_t lane = 0; lane < kPacketRays; lane += hn::Lanes(d)) {
      auto near = hn::Zero(d), far = hn::Load(d, &t_fars[lane]);
      for (size_t axis = 0; axis < 3; ++axis) {
        const size_t side = bounds_.backward >> axis & 1;
        near = hn::Max(
            near, hn::MulAdd(hn::Set(d, node.planes[side][axis][slot]),
                             hn::Load(d, &near_inverse_[axis][lane]), hn::Load(d, &near_bias_[axis][lane])));
        far = hn::Min(
            far, hn::MulAdd(hn::Set(d, node.planes[1 - side][axis][slot]),
                            hn::Load(d, &far_inverse_[axis][lane]), hn::Load(d, &far_bias_[axis][lane])));
      }
      result |= bits_of(d, hn::Le(near, far)) << lane;
    }
    return result;
  }

 private:
  using Tag = hn::CappedTag<double, kPacketRays>;
  using Columns = const double (*)[kPacketRays];
  static HWY_INLINE void find_range(const double* values, double& lo, double& hi) {
    const Tag d;
    auto least = hn::Load(d, values), most = least;
    for (size_t i = hn::Lanes(d); i < kPacketRays; i += hn::Lanes(d)) {
      least = hn::Min(least, hn::Load(d, values + i));
      most = hn::Max(most, hn::Load(d, values + i));
    }
    lo = hn::GetLane(hn::MinOfLanes(d, least));
    hi = hn::GetLane(hn::MaxOfLanes(d, most));
  }

  /// The box test's bounds; false if the signs of a component differ.
  HWY_INLINE bool set_bounds(Columns origins, Columns directions) {
    std::array<double, 3> lo, hi;
    double length = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      find_range(directions[axis], lo[axis], hi[axis]);
      if (lo[axis] < 0 && hi[axis] > 0) return false;
      length = std::max(length, std::max(std::abs(lo[axis]), std::abs(hi[axis])));
    }
    const double least = least_component(length);
    bounds_.backward = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      double origin_lo, origin_hi;
      find_range(origins[axis], origin_lo, origin_hi);
      const bool is_backward = std::signbit(lo[axis]);
      // The earliest that any ray can meet a plane is with the origin nearest to it and the fastest
      // component.
      const double fastest = is_backward ? lo[axis] : hi[axis], slowest = is_backward ? hi[axis] : lo[axis];
      const double near = 1 / std::copysign(std::max(std::abs(fastest), least), fastest);
      const double far = 1 / std::copysign(std::max(std::abs(slowest), least), slowest);
      const double near_bias = -(is_backward ? origin_lo : origin_hi) * near;
      const double far_bias = -(is_backward ? origin_hi : origin_lo) * far;
      bounds_.near_inverse[axis] = static_cast<float>(near);
      bounds_.far_inverse[axis] = static_cast<float>(far * kWiden);
      bounds_.near_bias[axis] = static_cast<float>(near_bias - kSlack * std::abs(near_bias));
      bounds_.far_bias[axis] = static_cast<float>(far_bias + 2 * kSlack * std::abs(far_bias));
      bounds_.backward |= static_cast<uint32_t>(is_backward) << axis;
    }
    return true;
  }

  /// What PreparedRay holds of one ray, for all of them at once, by the same operations. False if the signs
  /// of their components differ.
  HWY_INLINE bool prepare_lanes(Columns origins, Columns directions) {
    const Tag d;
    const hn::Rebind<float, Tag> narrow;
    z_over_all_ = y_over_x_ = 0;
    std::array<uint32_t, 3> backward{};
    for (size_t lane = 0; lane < kPacketRays; lane += hn::Lanes(d)) {
      const auto x = hn::Load(d, &directions[0][lane]), y = hn::Load(d, &directions[1][lane]),
                 z = hn::Load(d, &directions[2][lane]);
      const auto largest_xy = hn::Max(hn::Abs(x), hn::Abs(y));
      const auto y_over_x = hn::Gt(hn::Abs(y), hn::Abs(x)), z_over_all = hn::Ge(hn::Abs(z), largest_xy);
      const auto largest = hn::Max(largest_xy, hn::Abs(z));
      const auto least = hn::IfThenElse(hn::Lt(largest, hn::Set(d, 1e-3)),
                                        hn::Mul(hn::Set(d, 1e-18), largest), hn::Set(d, 1e-20));
      const auto prepare_axis = [&](size_t axis, hn::Vec<Tag> component) HWY_ATTR {
        const auto inverse =
            hn::Div(hn::Set(d, 1.0), hn::CopySign(hn::Max(hn::Abs(component), least), component));
        const auto bias = hn::Neg(hn::Mul(hn::Load(d, &origins[axis][lane]), inverse));
        const auto slack = hn::Mul(hn::Abs(bias), hn::Set(d, kSlack));
        hn::Store(hn::DemoteTo(narrow, inverse), narrow, &near_inverse_[axis][lane]);
        hn::Store(hn::DemoteTo(narrow, hn::Mul(inverse, hn::Set(d, kWiden))), narrow,
                  &far_inverse_[axis][lane]);
        hn::Store(hn::DemoteTo(narrow, hn::Sub(bias, slack)), narrow, &near_bias_[axis][lane]);
        hn::Store(hn::DemoteTo(narrow, hn::Add(bias, hn::Add(slack, slack))), narrow, &far_bias_[axis][lane]);
        backward[axis] |= bits_of(d, hn::Lt(inverse, hn::Zero(d))) << lane;
        return inverse;
      };
      const auto inverse_x = prepare_axis(0, x), inverse_y = prepare_axis(1, y),
                 inverse_z = prepare_axis(2, z);
      const auto by_axis = [&](hn::Vec<Tag> if_x, hn::Vec<Tag> if_y, hn::Vec<Tag> if_z) HWY_ATTR {
        return hn::IfThenElse(z_over_all, if_z, hn::IfThenElse(y_over_x, if_y, if_x));
      };
      const auto shear_z = by_axis(inverse_x, inverse_y, inverse_z);
      hn::Store(hn::Mul(by_axis(y, z, x), shear_z), d, &shear_[0][lane]);
      hn::Store(hn::Mul(by_axis(z, x, y), shear_z), d, &shear_[1][lane]);
      hn::Store(shear_z, d, &shear_[2][lane]);
      z_over_all_ |= bits_of(d, z_over_all) << lane;
      y_over_x_ |= bits_of(d, y_over_x) << lane;
    }
    for (size_t axis = 0; axis < 3; ++axis)
      if (backward[axis] != (bounds_.backward >> axis & 1 ? kAllRays : 0)) return false;  // as with 0 and -0
    return true;
  }

  BoxRay bounds_;
  HWY_ALIGN std::array<Lanes, 3> near_inverse_, near_bias_, far_inverse_, far_bias_;  ///< [axis][ray]
  HWY_ALIGN double shear_[3][kPacketRays];
  uint32_t z_over_all_, y_over_x_;  ///< bits of the rays whose largest component is z, or else y
};

/// The rays of a packet in one space, each with its search.
template <typename Search>
struct Bundle {
  explicit Bundle(const Scene& of) : scene(&of) {}
  const Scene* scene;
  std::array<PrimitiveRay, kPacketRays> rays;
  std::array<Search*, kPacketRays> searches;
  size_t count = 0;
};

/// A packet's walk through the hierarchy.
template <typename Search>
class PacketWalker {
 public:
  static constexpr bool kNearestFirst = Search::kNearestFirst;
  using RaySet = uint32_t;  ///< bit i: ray i
  using RaySets = std::array<RaySet, 8>;
  static constexpr RaySet kAll = kAllRays;
  PacketWalker(const Packet& packet, const Bundle<Search>& bundle) : packet_(packet), bundle_(bundle) {
    update();
  }
  const BoxRay& box_ray() const { return packet_.bounds(); }
  float t_far() const { return t_far_; }

  /// Drops the children that no ray of `among` meets, and tells for each of the others which rays do.
  HWY_INLINE uint32_t without_missed_children(const VolumeNode& node, uint32_t mask, RaySet among,
                                              RaySets& rays) const {
    for (uint32_t rest = mask; rest; rest &= rest - 1) {
      const auto slot = static_cast<size_t>(std::countr_zero(rest));
      rays[slot] = packet_.rays_meeting(node, slot, t_fars_) & among;
      if (rays[slot] == 0) mask &= ~(1u << slot);
    }
    return mask;
  }

  HWY_INLINE bool visit_leaf(const ChildRef& leaf, uint32_t instance, RaySet rays) {
    rays &= active_;
    if (leaf.kind() == ChildKind::triangles && std::popcount(rays) > 1) {
      for (uint32_t block = leaf.first; block < leaf.first + leaf.count(); ++block) {
        HWY_ALIGN Vertices<double> vertices;
        convert(bundle_.scene->triangle_blocks[block].vertices, vertices);
        for_each_ray(rays & active_, [&](Search& search, const PrimitiveRay& ray) HWY_ATTR {
          return search.test_block(block, vertices, ray, instance);
        });
      }
    } else {
      for_each_ray(rays, [&](Search& search, const PrimitiveRay& ray)
                             HWY_ATTR { return search.test_leaf(leaf, ray, instance); });
    }
    t_far_ = *std::max_element(t_fars_.begin(), t_fars_.end());
    return active_ == 0;
  }

  uint32_t active() const { return active_; }
  /// Takes over what the searches have found elsewhere.
  void update() {
    active_ = 0;
    for (size_t i = 0; i < kPacketRays; ++i) {
      const bool is_active = i < bundle_.count && !bundle_.searches[i]->is_over();
      t_fars_[i] = is_active ? bundle_.searches[i]->t_far() : -1;
      active_ |= static_cast<uint32_t>(is_active) << i;
    }
    t_far_ = *std::max_element(t_fars_.begin(), t_fars_.end());
  }

 private:
  /// `test(search, ray)` tells that the ray's search is over.
  template <typename Test>
  HWY_INLINE void for_each_ray(uint32_t rays, Test test) {
    for (; rays; rays &= rays - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(rays));
      const bool is_over = test(*bundle_.searches[i], bundle_.rays[i]);
      active_ &= ~(static_cast<uint32_t>(is_over) << i);
      t_fars_[i] = is_over ? -1 : bundle_.searches[i]->t_far();
    }
  }

  const Packet& packet_;
  const Bundle<Search>& bundle_;
  uint32_t active_;  ///< the bits of the rays whose searches are not over
  float t_far_;
  HWY_ALIGN Packet::Lanes t_fars_;
};

/// Walks a tree of volume nodes; if the search asks for it, nearest child first and nothing that lies behind
/// the closest hit so far. `visit_leaf(child, rays)` returns true to end the walk.
template <typename Walker, typename VisitLeaf>
HWY_INLINE bool walk(const VolumeNode* HWY_RESTRICT nodes, ChildRef root, Walker& walker,
                     VisitLeaf visit_leaf) {
  struct Entry {
    uint64_t child;  ///< a ChildRef
    float t;
    [[no_unique_address]] typename Walker::RaySet rays;
  };
  Entry stack[kStackSize];  // not initialised: clearing it would cost more than many a walk
  Entry* top = stack;
  uint64_t current = std::bit_cast<uint64_t>(root);
  typename Walker::RaySet rays = Walker::kAll;
  typename Walker::RaySets rays_of;
  const auto child_of = [](const VolumeNode& node, size_t slot)
                            HWY_ATTR { return std::bit_cast<uint64_t>(node.children[slot]); };
  while (true) {
    // Here, so that a visit to a leaf need not save and restore its registers.
    const BoxTest test_boxes(walker.box_ray());
    while (std::bit_cast<ChildRef>(current).kind() == ChildKind::inner) {
      const VolumeNode& node = nodes[std::bit_cast<ChildRef>(current).first];
      HWY_ALIGN float entry[8];
      uint32_t mask =
          walker.without_missed_children(node, test_boxes(node, walker.t_far(), entry), rays, rays_of);
      if (mask == 0) goto next;
      const auto first = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      current = child_of(node, first);
      rays = rays_of[first];
      if (mask == 0) continue;
      const auto entry_of = [&](size_t slot) HWY_ATTR {
        return Entry{child_of(node, slot), entry[slot], rays_of[slot]};
      };
      if constexpr (!Walker::kNearestFirst) {
        for (; mask; mask &= mask - 1) *top++ = entry_of(static_cast<size_t>(std::countr_zero(mask)));
        continue;
      }
      // Of two, the farther waits.
      const auto second = static_cast<size_t>(std::countr_zero(mask));
      mask &= mask - 1;
      if (mask == 0) {
        if (entry[first] <= entry[second]) {
          *top++ = entry_of(second);
        } else {
          *top++ = entry_of(first);
          current = child_of(node, second);
          rays = rays_of[second];
        }
        continue;
      }
      // More are sorted on the stack, the nearest on top.
      Entry* const base = top;
      *top++ = entry_of(first);
      const auto insert = [&](size_t slot) HWY_ATTR {
        Entry* place = top++;
        for (; place > base && place[-1].t < entry[slot]; --place) *place = place[-1];
        *place = entry_of(slot);
      };
      insert(second);
      for (; mask; mask &= mask - 1) insert(static_cast<size_t>(std::countr_zero(mask)));
      --top;
      current = top->child;
      rays = top->rays;
    }
    if (visit_leaf(std::bit_cast<ChildRef>(current), rays)) return true;
  next:
    do {
      if (top == stack) return false;
      --top;
    } while (Walker::kNearestFirst && top->t > walker.t_far());
    current = top->child;
    rays = top->rays;
  }
}

/// Walks an instance's part. The walker is in the part's space.
template <typename Walker>
HWY_INLINE bool walk_part(const Scene& scene, uint32_t instance, Walker& walker) {
  const Part& part = scene.parts[scene.instances[instance].part];
  return walk(
      scene.nodes.data(), part.root, walker,
      [&](const ChildRef& leaf, typename Walker::RaySet rays) HWY_ATTR
      __attribute__((always_inline)) { return walker.visit_leaf(leaf, instance, rays); });
}

template <typename Search>
HWY_NOINLINE bool walk_instances(const Scene& scene, const Pose& pose, const ChildRef& leaf,
                                 const PreparedRay& world, Search& search) {
  for (const uint32_t instance : scene.leaf_instances.subspan(leaf.first, leaf.count())) {
    const InstancePose& place = pose.instances[instance];
    if (place.is_identity) {
      SingleWalker walker(world, search);
      if (walk_part(scene, instance, walker)) return true;
    } else {
      const PreparedRay local(world, place.object_from_world);
      SingleWalker walker(local, search);
      if (walk_part(scene, instance, walker)) return true;
    }
  }
  return false;
}

/// Walks the object part: `visit_instances(leaf, rays)` is called for its leaves.
template <typename Walker, typename VisitInstances>
HWY_INLINE bool walk_scene(const Scene& scene, const Pose& pose, Walker& walker,
                           VisitInstances visit_instances) {
  const ChildRef root = scene.head().object_root;
  if (root.kind() == ChildKind::empty) return false;
  if (root.kind() == ChildKind::instances) return visit_instances(root, Walker::kAll);
  return walk(pose.nodes.data(), root, walker, visit_instances);
}

template <typename Search>
HWY_INLINE bool search_for_one(const Scene& scene, const Pose& pose, const PreparedRay& ray, Search& search) {
  SingleWalker walker(ray, search);
  return walk_scene(scene, pose, walker, [&](const ChildRef& leaf, auto /*rays*/) HWY_ATTR {
    return walk_instances(scene, pose, leaf, ray, search);
  });
}

/// Walks the parts of a leaf of the object part with those rays of a bundle that meet it.
template <typename Search>
HWY_NOINLINE void walk_instances(const Scene& scene, const Pose& pose, const ChildRef& leaf,
                                 const Bundle<Search>& world, const Packet& world_packet, uint32_t rays) {
  for (const uint32_t instance : scene.leaf_instances.subspan(leaf.first, leaf.count())) {
    const InstancePose& place = pose.instances[instance];
    if (place.is_identity) {
      PacketWalker<Search> walker(world_packet, world);
      walk_part(scene, instance, walker);
      continue;
    }
    Bundle<Search> local(scene);
    for (uint32_t rest = rays; rest; rest &= rest - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(rest));
      if (world.searches[i]->is_over()) continue;
      const Vec3 o = place.object_from_world.point(world.rays[i].origin_vector());
      const Vec3 d = place.object_from_world.vector(world.rays[i].direction_vector());
      local.rays[local.count].origin = {o.x, o.y, o.z, 0};
      local.rays[local.count].direction = {d.x, d.y, d.z, 0};
      local.searches[local.count++] = world.searches[i];
    }
    Packet packet;
    if (packet.join(std::span(local.rays).first(local.count))) {
      packet.prepare(std::span(local.rays).first(local.count));
      PacketWalker<Search> walker(packet, local);
      walk_part(scene, instance, walker);
      continue;
    }
    for (size_t i = 0; i < local.count; ++i) {
      const PreparedRay ray(local.rays[i]);
      SingleWalker walker(ray, *local.searches[i]);
      walk_part(scene, instance, walker);
    }
  }
}

template <typename Search>
HWY_INLINE void search_for_packet(const Scene& scene, const Pose& pose, std::span<const Ray> rays,
                                  Search* searches) {
  Bundle<Search> bundle(scene);
  bundle.count = rays.size();
  for (size_t i = 0; i < rays.size(); ++i) {
    const Vec3 &o = rays[i].origin, &d = rays[i].direction;
    bundle.rays[i].origin = {o.x, o.y, o.z, 0};
    bundle.rays[i].direction = {d.x, d.y, d.z, 0};
    bundle.searches[i] = &searches[i];
  }
  Packet packet;
  if (!packet.join(std::span(bundle.rays).first(rays.size()))) {
    for (size_t i = 0; i < rays.size(); ++i) search_for_one(scene, pose, PreparedRay(rays[i]), searches[i]);
    return;
  }
  packet.prepare(std::span(bundle.rays).first(rays.size()));
  PacketWalker<Search> walker(packet, bundle);
  walk_scene(scene, pose, walker, [&](const ChildRef& leaf, uint32_t leaf_rays) HWY_ATTR {
    walk_instances(scene, pose, leaf, bundle, packet, leaf_rays & walker.active());
    walker.update();
    return walker.active() == 0;
  });
}

Hit find_closest(const Scene& scene, const Pose& pose, const Ray& ray) {
  Hit hit;
  hit.t = ray.t_max;
  ClosestHit search(scene, hit);
  search_for_one(scene, pose, PreparedRay(ray), search);
  return hit;
}

bool find_any(const Scene& scene, const Pose& pose, const Ray& ray) {
  AnyHit search(scene, ray.t_max);
  return search_for_one(scene, pose, PreparedRay(ray), search);
}

void find_closest_of_packet(const Scene& scene, const Pose& pose, std::span<const Ray> rays, Hit* hits) {
  std::array<ClosestHit, kPacketRays> searches;
  for (size_t i = 0; i < rays.size(); ++i) {
    hits[i] = {};
    hits[i].t = rays[i].t_max;
    searches[i] = ClosestHit(scene, hits[i]);
  }
  search_for_packet(scene, pose, rays, searches.data());
}

uint32_t find_any_of_packet(const Scene& scene, const Pose& pose, std::span<const Ray> rays) {
  std::array<AnyHit, kPacketRays> searches;
  for (size_t i = 0; i < rays.size(); ++i) searches[i] = AnyHit(scene, rays[i].t_max);
  search_for_packet(scene, pose, rays, searches.data());
  uint32_t hits = 0;
  for (size_t i = 0; i < rays.size(); ++i) hits |= static_cast<uint32_t>(searches[i].is_over()) << i;
  return hits;
}

Hit find_closest_brute_force(const Scene& scene, const Pose& pose, const Ray& ray) {
  Hit hit;
  hit.t = ray.t_max;
  ClosestHit search(scene, hit);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Part& part = scene.parts[scene.instances[i].part];
    const Affine& inverse = pose.instances[i].object_from_world;
    const PreparedRay world(ray);
    const PreparedRay local = pose.instances[i].is_identity ? world : PreparedRay(world, inverse);
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
HWY_EXPORT(find_closest_of_packet);
HWY_EXPORT(find_any_of_packet);
HWY_EXPORT(find_closest_brute_force);

Hit closest_hit(const Scene& scene, const Pose& pose, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_closest)(scene, pose, ray);
}

bool any_hit(const Scene& scene, const Pose& pose, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_any)(scene, pose, ray);
}

void closest_hits(const Scene& scene, const Pose& pose, std::span<const Ray> rays, Hit* hits) {
  HWY_DYNAMIC_DISPATCH(find_closest_of_packet)(scene, pose, rays, hits);
}

uint32_t any_hits(const Scene& scene, const Pose& pose, std::span<const Ray> rays) {
  return HWY_DYNAMIC_DISPATCH(find_any_of_packet)(scene, pose, rays);
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
