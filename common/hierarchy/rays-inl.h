// Rays as the traverser's tests take them, and the test of boxes. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_RAYS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_RAYS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_RAYS_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstddef>

#include "common/hierarchy/traverser.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 8>;
using DoubleTag = hn::CappedTag<double, 8>;

// Box distances are computed in float as plane × inverse + bias. Every step rounds by at most 2^-24 of
// |plane × inverse| <= |t| + |origin × inverse|; there are four of them (the inverse, the bias, the product
// and the sum). The part that grows with t is covered by widening the far distances, the other one by slack
// in the bias.
constexpr double kWiden = 1 + 0x1p-21;
constexpr double kSlack = 0x1p-21;

/// Floats as integers, whose larger and smaller are found in a quarter of the time. Their order is the
/// floats' among those that are not negative, and negative ones come before these: all that a box test asks,
/// for its near distances are at least 0, and it only matters of a far one below 0 that it is.
using IntegerTag = hn::RebindToSigned<FloatTag>;
HWY_INLINE hn::Vec<IntegerTag> as_integers(hn::Vec<FloatTag> distances) {
  return hn::BitCast(IntegerTag(), distances);
}

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
constexpr double kLeastComponent = 1e-20;
constexpr double kShort = 1e-3,
                 kLeastOfShort = 1e-18;  // relative, where the largest component is below kShort
inline double least_component(double largest) {
  return HWY_UNLIKELY(largest < kShort) ? kLeastOfShort * largest : kLeastComponent;
}

using WideTag = hn::CappedTag<double, 4>;

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

  HWY_INLINE void set(const Vec3& o, const Vec3& d) {
    origin = {o.x, o.y, o.z, 0};
    direction = {d.x, d.y, d.z, 0};
  }
  /// The same ray in the space of an instance.
  HWY_INLINE void set_in_object(const PrimitiveRay& world, const Affine& object_from_world) {
    set(object_from_world.point(world.origin_vector()), object_from_world.vector(world.direction_vector()));
  }
  Vec3 origin_vector() const { return {origin[0], origin[1], origin[2]}; }
  Vec3 direction_vector() const { return {direction[0], direction[1], direction[2]}; }
  HWY_INLINE void set_axes(uint32_t largest_axis) {
    kz = largest_axis;
    kx = 0x021u >> (4 * kz) & 3;  // (kz + 1) mod 3
    ky = 0x102u >> (4 * kz) & 3;  // (kz + 2) mod 3
  }
};

/// What boxes need of one axis, for as many rays or axes as a vector has lanes. Returns the inverse
/// direction.
template <class D>
HWY_INLINE hn::Vec<D> prepare_axis(D d, hn::Vec<D> origin, hn::Vec<D> direction, hn::Vec<D> least,
                                   float* HWY_RESTRICT near_inverse, float* HWY_RESTRICT near_bias,
                                   float* HWY_RESTRICT far_inverse, float* HWY_RESTRICT far_bias) {
  const hn::Rebind<float, D> narrow;
  const auto inverse = hn::Div(hn::Set(d, 1.0), hn::CopySign(hn::Max(hn::Abs(direction), least), direction));
  const auto bias = hn::Neg(hn::Mul(origin, inverse));
  const auto slack = hn::Mul(hn::Abs(bias), hn::Set(d, kSlack));
  hn::Store(hn::DemoteTo(narrow, inverse), narrow, near_inverse);
  hn::Store(hn::DemoteTo(narrow, hn::Sub(bias, slack)), narrow, near_bias);
  hn::Store(hn::DemoteTo(narrow, hn::Mul(inverse, hn::Set(d, kWiden))), narrow, far_inverse);
  hn::Store(hn::DemoteTo(narrow, hn::Add(bias, hn::Add(slack, slack))), narrow, far_bias);
  return inverse;
}

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
  /// A ray of a packet.
  HWY_INLINE PreparedRay(const RayPacket& rays, size_t i) {
    set(rays.origin(i), rays.direction(i));
    prepare();
  }
  HWY_INLINE explicit PreparedRay(const PrimitiveRay& ray) : PrimitiveRay(ray) { prepare(); }
  /// The same ray in the space of an instance.
  HWY_INLINE PreparedRay(const PrimitiveRay& world, const Affine& object_from_world) {
    set_in_object(world, object_from_world);
    prepare();
  }

 private:
  HWY_INLINE void prepare() {
    const double x = std::abs(direction[0]), y = std::abs(direction[1]), z = std::abs(direction[2]);
    const double largest_xy = std::max(x, y), largest = std::max(largest_xy, z);
    const auto y_over_x = static_cast<uint32_t>(y > x), z_over_all = static_cast<uint32_t>(z >= largest_xy);
    set_axes(y_over_x + (2 - y_over_x) * z_over_all);  // no branch: no one could predict it
    const WideTag wide;
    HWY_ALIGN double inverses[4];
    const auto least = hn::Set(wide, least_component(largest));
    backward = 0;
    for (size_t i = 0; i < 4; i += hn::Lanes(wide)) {
      const auto inverse =
          prepare_axis(wide, hn::Load(wide, &origin[i]), hn::Load(wide, &direction[i]), least,
                       &near_inverse[i], &near_bias[i], &far_inverse[i], &far_bias[i]);
      hn::Store(inverse, wide, inverses + i);
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
    uint32_t missed = 0;
    for (size_t lane = 0; lane < 8; lane += hn::Lanes(d_)) {
      const auto distance = [&](size_t side, V inverse, V bias) HWY_ATTR {
        return as_integers(hn::MulAdd(hn::Load(d_, planes + side + lane), inverse, bias));
      };
      const auto near_x = distance(near_x_, near_inverse_x_, near_bias_x_);
      const auto near_y = distance(near_y_, near_inverse_y_, near_bias_y_);
      const auto near_z = distance(near_z_, near_inverse_z_, near_bias_z_);
      const auto far_x = distance(far_x_, far_inverse_x_, far_bias_x_);
      const auto far_y = distance(far_y_, far_inverse_y_, far_bias_y_);
      const auto far_z = distance(far_z_, far_inverse_z_, far_bias_z_);
      const auto near = hn::Max(hn::Max(near_x, near_y), hn::Max(near_z, hn::Zero(IntegerTag())));
      const auto far = hn::Min(hn::Min(far_x, far_y), hn::Min(far_z, as_integers(hn::Set(d_, t_far))));
      hn::Store(hn::BitCast(d_, near), d_, entry + lane);
      missed |= bits_of(IntegerTag(), hn::Gt(near, far)) << lane;
    }
    return 0xff & ~missed;
  }

 private:
  using V = hn::Vec<FloatTag>;
  FloatTag d_;
  V near_inverse_x_, far_inverse_x_, near_inverse_y_, far_inverse_y_, near_inverse_z_, far_inverse_z_;
  V near_bias_x_, near_bias_y_, near_bias_z_, far_bias_x_, far_bias_y_, far_bias_z_;
  /// Where the planes stand in a node, counted in floats.
  size_t near_x_, near_y_, near_z_, far_x_, far_y_, far_z_;
};

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
