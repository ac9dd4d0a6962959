// Packets of rays as the traverser's tests take them. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_PACKETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_PACKETS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_PACKETS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_PACKETS_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "common/hierarchy/rays-inl.h"
#include "common/math/lanes-inl.h"
#include "common/math/ray_packet.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kPacketRays = kMostPacketRays;
constexpr uint32_t kAllRays = (1u << kPacketRays) - 1;

/// Sets all lanes of `to`; those that are not `wanted` repeat the first that is. `turn(d, x, y, z)` changes
/// vectors on their way.
template <typename Turn>
HWY_INLINE void copy_wanted(const VectorLanes& from, uint32_t wanted, VectorLanes& to, Turn turn) {
  const RealTag d;
  const auto first = static_cast<size_t>(std::countr_zero(wanted));
  for (size_t lane = 0; lane < kPacketRays; lane += kLanes) {
    const Truth is_wanted = truth_of(lanes_from(wanted, lane));
    const auto load = [&](size_t axis) HWY_ATTR {
      return hn::IfThenElse(is_wanted, hn::Load(d, &from[axis][lane]), hn::Set(d, from[axis][first]));
    };
    auto x = load(0), y = load(1), z = load(2);
    turn(d, x, y, z);
    hn::Store(x, d, &to[0][lane]);
    hn::Store(y, d, &to[1][lane]);
    hn::Store(z, d, &to[2][lane]);
  }
}

HWY_INLINE void copy_wanted(const RayPacket& from, uint32_t wanted, RayPacket& to) {
  const auto as_it_is = [](auto&&...) HWY_ATTR {};
  copy_wanted(from.origins, wanted, to.origins, as_it_is);
  copy_wanted(from.directions, wanted, to.directions, as_it_is);
}

/// The same rays in the space of an instance, by the operations of Affine.
HWY_INLINE void copy_wanted_in_object(const RayPacket& world, const Affine& object_from_world,
                                      uint32_t wanted, RayPacket& to) {
  const Mat3& m = object_from_world.linear;
  const auto turn = [&m](auto d, auto& x, auto& y, auto& z) HWY_ATTR {
    const auto row = [&](int i) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0][i]), x), hn::Mul(hn::Set(d, m[1][i]), y)),
                     hn::Mul(hn::Set(d, m[2][i]), z));
    };
    const auto turned_x = row(0), turned_y = row(1), turned_z = row(2);
    x = turned_x;
    y = turned_y;
    z = turned_z;
  };
  copy_wanted(world.origins, wanted, to.origins, [&](auto d, auto& x, auto& y, auto& z) HWY_ATTR {
    turn(d, x, y, z);
    x = hn::Add(x, hn::Set(d, object_from_world.translation.x));
    y = hn::Add(y, hn::Set(d, object_from_world.translation.y));
    z = hn::Add(z, hn::Set(d, object_from_world.translation.z));
  });
  copy_wanted(world.directions, wanted, to.directions, turn);
}

/// Whether those of `wanted` make a packet: several rays whose directions have the same signs (-0 is negative
/// too). To be asked before anything is prepared: rays that go alone are prepared alone.
HWY_INLINE bool are_packet(const RayPacket& rays, uint32_t wanted) {
  if ((wanted & (wanted - 1)) == 0) return false;
  const RealTag d;
  const hn::RebindToSigned<decltype(d)> bits;
  for (const auto& components : rays.directions) {
    uint32_t negative = 0;
    for (size_t lane = 0; lane < kPacketRays; lane += hn::Lanes(d)) {
      const auto values = hn::BitCast(bits, hn::Load(d, components + lane));
      negative |= bits_of(bits, hn::Lt(values, hn::Zero(bits))) << lane;
    }
    negative &= wanted;
    if (negative != 0 && negative != wanted) return false;
  }
  return true;
}

/// Rays whose directions have the same signs and that walk together: one box test serves them all, with the
/// bounds of their origins and directions; at a leaf each is tested by itself, exactly as if it had come
/// alone.
class Packet {
 public:
  using Lanes = std::array<float, kPacketRays>;

  /// Prepares rays, all lanes of them, for box and primitive tests, and those of `wanted` for primitive tests
  /// of their own. Those must make a packet, and the other lanes repeat one of them.
  HWY_INLINE void join(const RayPacket& rays, uint32_t wanted, PrimitiveRay* HWY_RESTRICT prepared) {
    prepare_lanes(rays);
    for (uint32_t rest = wanted; rest; rest &= rest - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(rest));
      prepared[i].set(rays.origin(i), rays.direction(i));
      prepared[i].set_axes(z_over_all_ >> i & 1 ? 2 : y_over_x_ >> i & 1);
      prepared[i].shear_x = shear_[0][i];
      prepared[i].shear_y = shear_[1][i];
      prepared[i].shear_z = shear_[2][i];
    }
    for (size_t axis = 0; axis < 3; ++axis) set_bounds(rays, axis);
  }

  const BoxRay& bounds() const { return bounds_; }

  /// The bits of the rays that may meet a child's box in [0, t_fars[ray]].
  HWY_INLINE uint32_t rays_meeting(const VolumeNode& node, size_t slot, const Lanes& t_fars) const {
    const FloatTag d;
    uint32_t missed = 0;
    for (size_t lane = 0; lane < kPacketRays; lane += hn::Lanes(d)) {
      auto near = hn::Zero(IntegerTag()), far = as_integers(hn::Load(d, &t_fars[lane]));
      for (size_t axis = 0; axis < 3; ++axis) {
        const size_t side = bounds_.backward >> axis & 1;
        near = hn::Max(near, as_integers(hn::MulAdd(hn::Set(d, node.planes[side][axis][slot]),
                                                    hn::Load(d, &near_inverse_[axis][lane]),
                                                    hn::Load(d, &near_bias_[axis][lane]))));
        far = hn::Min(far, as_integers(hn::MulAdd(hn::Set(d, node.planes[1 - side][axis][slot]),
                                                  hn::Load(d, &far_inverse_[axis][lane]),
                                                  hn::Load(d, &far_bias_[axis][lane]))));
      }
      missed |= bits_of(IntegerTag(), hn::Gt(near, far)) << lane;
    }
    return kAllRays & ~missed;
  }

 private:
  static HWY_INLINE void find_range(const double* values, double& lo, double& hi) {
    const RealTag d;
    auto least = hn::Load(d, values), most = least;
    for (size_t i = hn::Lanes(d); i < kPacketRays; i += hn::Lanes(d)) {
      least = hn::Min(least, hn::Load(d, values + i));
      most = hn::Max(most, hn::Load(d, values + i));
    }
    lo = hn::GetLane(hn::MinOfLanes(d, least));
    hi = hn::GetLane(hn::MaxOfLanes(d, most));
  }

  /// The box test's bounds along one axis.
  HWY_INLINE void set_bounds(const RayPacket& rays, size_t axis) {
    double origin_lo, origin_hi, inverse_lo, inverse_hi;
    find_range(rays.origins[axis], origin_lo, origin_hi);
    find_range(inverse_[axis], inverse_lo, inverse_hi);
    const bool is_backward = backward_[axis] != 0;
    // The earliest that any ray can meet a plane is with the origin nearest to it and the fastest component.
    const double near = is_backward ? inverse_hi : inverse_lo, far = is_backward ? inverse_lo : inverse_hi;
    const double near_bias = -(is_backward ? origin_lo : origin_hi) * near;
    const double far_bias = -(is_backward ? origin_hi : origin_lo) * far;
    bounds_.near_inverse[axis] = static_cast<float>(near);
    bounds_.far_inverse[axis] = static_cast<float>(far * kWiden);
    bounds_.near_bias[axis] = static_cast<float>(near_bias - kSlack * std::abs(near_bias));
    bounds_.far_bias[axis] = static_cast<float>(far_bias + 2 * kSlack * std::abs(far_bias));
    if (axis == 0) bounds_.backward = 0;
    bounds_.backward |= static_cast<uint32_t>(is_backward) << axis;
  }

  /// What PreparedRay holds of one ray, for all of them at once, by the same operations.
  HWY_INLINE void prepare_lanes(const RayPacket& rays) {
    const RealTag d;
    z_over_all_ = y_over_x_ = 0;
    backward_ = {};
    for (size_t lane = 0; lane < kPacketRays; lane += hn::Lanes(d)) {
      const auto x = hn::Load(d, &rays.directions[0][lane]), y = hn::Load(d, &rays.directions[1][lane]),
                 z = hn::Load(d, &rays.directions[2][lane]);
      const auto largest_xy = hn::Max(hn::Abs(x), hn::Abs(y));
      const auto y_over_x = hn::Gt(hn::Abs(y), hn::Abs(x)), z_over_all = hn::Ge(hn::Abs(z), largest_xy);
      const auto largest = hn::Max(largest_xy, hn::Abs(z));
      const auto least =
          hn::IfThenElse(hn::Lt(largest, hn::Set(d, kShort)), hn::Mul(hn::Set(d, kLeastOfShort), largest),
                         hn::Set(d, kLeastComponent));
      const auto inverse_of = [&](size_t axis, Real component) HWY_ATTR {
        const auto inverse = prepare_axis(d, hn::Load(d, &rays.origins[axis][lane]), component, least,
                                          &near_inverse_[axis][lane], &near_bias_[axis][lane],
                                          &far_inverse_[axis][lane], &far_bias_[axis][lane]);
        hn::Store(inverse, d, &inverse_[axis][lane]);
        backward_[axis] |= bits_of(d, hn::Lt(inverse, hn::Zero(d))) << lane;
        return inverse;
      };
      const auto inverse_x = inverse_of(0, x), inverse_y = inverse_of(1, y), inverse_z = inverse_of(2, z);
      const auto by_axis = [&](Real if_x, Real if_y, Real if_z) HWY_ATTR {
        return hn::IfThenElse(z_over_all, if_z, hn::IfThenElse(y_over_x, if_y, if_x));
      };
      const auto shear_z = by_axis(inverse_x, inverse_y, inverse_z);
      hn::Store(hn::Mul(by_axis(y, z, x), shear_z), d, &shear_[0][lane]);
      hn::Store(hn::Mul(by_axis(z, x, y), shear_z), d, &shear_[1][lane]);
      hn::Store(shear_z, d, &shear_[2][lane]);
      z_over_all_ |= bits_of(d, z_over_all) << lane;
      y_over_x_ |= bits_of(d, y_over_x) << lane;
    }
  }

  BoxRay bounds_;
  HWY_ALIGN std::array<Lanes, 3> near_inverse_, near_bias_, far_inverse_, far_bias_;  ///< [axis][ray]
  HWY_ALIGN VectorLanes shear_, inverse_;
  std::array<uint32_t, 3> backward_;  ///< [axis]: bits of the rays whose component is negative
  uint32_t z_over_all_, y_over_x_;    ///< bits of the rays whose largest component is z, or else y
};

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
