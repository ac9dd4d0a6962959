#pragma once
// The bodies that a ray is inside of: dielectrics, and all others where it has to know (self_hits.h). Where
// several overlap the one of the highest priority is there (Schmidt and Budge 2002, "Simple nested
// dielectrics in ray traced images"), so a liquid may reach into its glass, and no gap is left between them.
#include "common/lighting/surface.h"
#include "common/math/portable_math.h"

namespace rayfarm {

class Media {
 public:
  /// What a surface of a dielectric separates, for a ray that meets it.
  struct Crossing {
    bool is_real;        ///< false: a stronger medium is on both sides, and nothing is to be seen
    double index_ratio;  ///< behind over before
  };

  /// The dielectric that the ray is in, or kNone: air.
  uint32_t current(const Scene& scene) const {
    uint32_t best = kNone;
    for (size_t i = 0; i < count_; ++i)
      if (has_inside(scene.materials[inside_[i]]) &&
          (best == kNone || scene.materials[inside_[i]].priority > scene.materials[best].priority))
        best = inside_[i];
    return best;
  }

  /// What is left of light after this length of the medium that the ray is in.
  Color transmittance(const Scene& scene, double distance) const {
    Color left(1);
    if (const uint32_t medium = current(scene); medium != kNone)
      for (int c = 0; c < 3; ++c)
        if (const double filter = scene.materials[medium].filter[c]; filter < 1)
          left[c] = portable_pow(filter, distance);
    return left;
  }

  bool is_in_air() const { return count_ == 0; }

  /// The ray is inside of a body of the material.
  bool contains(uint32_t material) const {
    return std::find(inside_.begin(), inside_.begin() + static_cast<ptrdiff_t>(count_), material) !=
           inside_.begin() + static_cast<ptrdiff_t>(count_);
  }

  Crossing meet(const Scene& scene, uint32_t material, bool is_front) const {
    Media behind = *this;
    behind.cross(material, is_front);
    const uint32_t before = current(scene), after = behind.current(scene);
    // Leaving a medium that the ray was never seen to enter: the viewer stands inside it.
    const bool began_inside = !is_front && !contains(material);
    const double index_before = began_inside      ? scene.materials[material].index
                                : before == kNone ? 1
                                                  : scene.materials[before].index;
    const double index_after = after == kNone ? 1 : scene.materials[after].index;
    return {began_inside || before != after, index_after / index_before};
  }

  /// The ray goes through a surface of the material.
  void cross(uint32_t material, bool is_front) {
    if (is_front) {
      if (count_ < inside_.size()) inside_[count_++] = material;
      return;
    }
    for (size_t i = count_; i-- > 0;)
      if (inside_[i] == material) {
        std::copy(inside_.begin() + static_cast<ptrdiff_t>(i) + 1,
                  inside_.begin() + static_cast<ptrdiff_t>(count_),
                  inside_.begin() + static_cast<ptrdiff_t>(i));
        --count_;
        return;
      }
  }

 private:
  std::array<uint32_t, 8> inside_;  // set as far as it is used: rays are made often
  uint32_t count_ = 0;
};

}  // namespace rayfarm
