#pragma once
// Points that are equal become one: what formats without shared vertices need.
#include <bit>

#include "common/description/scene_description.h"

namespace rayfarm {

/// The different ones among points, in the order of their first occurrence. Memory follows their number.
class PointMerger {
 public:
  /// `points` keeps them, and must outlive it.
  explicit PointMerger(LargeVector<glm::vec3>& points) : points_(points) { grow(); }

  /// Where the point stands, now at the latest. Equal to the last bit, but that 0 is -0. There may be
  /// 4 billion.
  uint32_t add(glm::vec3 p) {
    p += 0.0f;  // -0 becomes 0
    size_t slot = hash(p) & mask_;
    while (places_[slot] != kEmpty) {
      if (points_[places_[slot]] == p) return places_[slot];
      slot = (slot + 1) & mask_;
    }
    places_[slot] = static_cast<uint32_t>(points_.size());
    points_.push_back(p);
    const uint32_t place = places_[slot];
    if (2 * points_.size() > mask_) grow();
    return place;
  }

 private:
  static constexpr uint32_t kEmpty = ~0u;

  static size_t hash(const glm::vec3& p) {
    uint64_t h = 0;
    for (int k = 0; k < 3; ++k) {
      h = (h ^ std::bit_cast<uint32_t>(p[k])) * 0x9e3779b97f4a7c15;
      h ^= h >> 32;
    }
    return h;
  }
  void grow() {
    mask_ = 2 * mask_ + 1;
    places_.assign(mask_ + 1, kEmpty);
    for (size_t i = 0; i < points_.size(); ++i) {
      size_t slot = hash(points_[i]) & mask_;
      while (places_[slot] != kEmpty) slot = (slot + 1) & mask_;
      places_[slot] = static_cast<uint32_t>(i);
    }
  }

  LargeVector<glm::vec3>& points_;
  LargeVector<uint32_t> places_;  ///< an open hash table, less than half full
  size_t mask_ = 511;
};

}  // namespace rayfarm
