#pragma once
// Up to eight rays side by side: structure of arrays, as vectors of every SIMD target load them.
#include <bit>
#include <span>

#include "common/math/ray.h"

namespace rayfarm {

/// The most rays that are traced together.
inline constexpr size_t kMostPacketRays = 8;

/// Of each ray of a packet: [axis][ray].
using VectorLanes = double[3][kMostPacketRays];

inline void set_lane(VectorLanes& lanes, size_t i, const Vec3& v) {
  lanes[0][i] = v.x;
  lanes[1][i] = v.y;
  lanes[2][i] = v.z;
}
inline Vec3 lane_of(const VectorLanes& lanes, size_t i) {
  return {lanes[0][i], lanes[1][i], lanes[2][i]};
}

/// Calls visit(lane) for each lane of `bits`, from the lowest on. Inlined, so that what it calls may be
/// compiled for one SIMD target.
template <typename Visitor>
[[gnu::always_inline]] inline void for_each_lane(uint32_t bits, Visitor visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<size_t>(std::countr_zero(bits)));
}

/// Rays are written where they are traced: a vector loaded from a copy made number by number would have to
/// wait until all its numbers have left the processor's store buffer.
struct RayPacket {
  RayPacket() {}  // leaves the lanes as they are
  explicit RayPacket(std::span<const Ray> rays) {
    for (const Ray& ray : rays) push_back(ray.origin, ray.direction, ray.t_max);
  }

  alignas(64) VectorLanes origins;
  alignas(64) VectorLanes directions;  ///< any length > 0
  alignas(64) double t_max[kMostPacketRays];
  size_t size = 0;  ///< what lies in the lanes from here on means nothing

  bool empty() const { return size == 0; }
  bool is_full() const { return size == kMostPacketRays; }
  void clear() { size = 0; }
  /// Bits of its rays.
  uint32_t all() const { return (1u << size) - 1; }
  /// There must be room.
  void push_back(const Vec3& origin, const Vec3& direction,
                 double farthest = std::numeric_limits<double>::infinity()) {
    set(size++, origin, direction, farthest);
  }
  void set(size_t i, const Vec3& origin, const Vec3& direction,
           double farthest = std::numeric_limits<double>::infinity()) {
    set_lane(origins, i, origin);
    set_lane(directions, i, direction);
    t_max[i] = farthest;
  }
  Vec3 origin(size_t i) const { return lane_of(origins, i); }
  Vec3 direction(size_t i) const { return lane_of(directions, i); }
  Ray operator[](size_t i) const { return {origin(i), direction(i), t_max[i]}; }
};

}  // namespace rayfarm
