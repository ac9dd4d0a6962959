#pragma once
// Ray coherence (Ohta and Maekawa 1987), in the form of Shirley, Sung and Brown 1991, 2.3.2: "the builder
// module finds out the list of candidate primitives that are visible from a direction/angle pair of a
// primitive"; a ray from there looks its candidates up.
#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/hierarchy/bounding_volumes.h"
#include "common/hierarchy/hit_place.h"
#include "common/math/ray_packet.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Parts of more primitives are candidates as wholes.
inline constexpr size_t kMostPrimitivesApart = 4096;
/// With more candidates than that there are no lists.
inline constexpr size_t kMostCandidates = 1 << 16;
/// Longer lists are not kept: the usual search is faster.
inline constexpr size_t kMostInList = 64;
/// What a thread's lists hold at most, in all.
inline constexpr size_t kMostListed = 1 << 22;

/// A primitive of an instance that never moves, or such an instance as a whole, and a ball in the world about
/// it.
struct Candidate {
  Ball ball;  ///< the radius is infinite where no ball holds it
  HitPlace place;
  bool is_whole = false;
};

/// Those of a scene; none if there would be too many, or if wholes can't be searched by themselves.
std::vector<Candidate> candidates_of(const Scene& scene);

/// What a thread knows of a scene.
class RayCoherence {
 public:
  /// A candidate, and how far at least it is from where the rays of a list may begin.
  struct Listed {
    float least_distance;
    uint32_t candidate;
  };
  using List = std::vector<Listed>;  ///< the nearest first

  explicit RayCoherence(const Scene& scene);

  /// What a ray can meet of what never moves; null: it begins at nothing that was hit lately, or could meet
  /// too much, or memory is used up. `is_new` tells whether the list was made for it.
  const List* find(const Vec3& origin, const Vec3& direction, bool& is_new);
  const Candidate& operator[](uint32_t candidate) const { return candidates_[candidate]; }
  /// A ray from `origin` hit `place` at `point`; others are expected to begin there.
  void note_hit(const HitPlace& place, const Vec3& origin, const Vec3& point);

 private:
  /// Where a ray arrived.
  struct Arrival {
    uint32_t candidate = kNone;
    Vec3 point{0};
    double tolerance = 0;  ///< rays that begin so near begin there
  };
  /// The candidate that a ray begins at; kNone: at none.
  uint32_t find_start(const Vec3& origin) const;
  /// Which of the directions' cells: squares of equal size on a cube about the origin.
  uint32_t cell_of(const Vec3& direction) const;
  /// Empty if it would be too long.
  List make_list(const Candidate& from, uint32_t cell) const;

  std::span<const TriangleBlock> blocks_;
  std::vector<Candidate> candidates_;
  std::unordered_map<uint64_t, uint32_t> by_place_;    ///< candidates, by instance << 32 | bits of the place
  uint32_t cells_;                                     ///< along an edge of the cube
  std::array<Arrival, 2 * kMostPacketRays> arrivals_;  ///< of the last rays
  size_t last_ = 0;                                    ///< of them
  std::unordered_map<uint64_t, List> lists_;  ///< by candidate << 32 | cell; empty: it would be too long
  size_t listed_ = 0;                         ///< in all lists
};

}  // namespace rayfarm
