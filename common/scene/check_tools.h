#pragma once
// What the checks of a scene block have in common.
#include "common/scene/scene.h"
#include "common/scene/scene_block.h"

namespace rayfarm {

inline void require(bool holds, const char* what) {
  if (!holds) throw SceneBlockError(what);
}

/// Ranges of an array that belong to one owner each: they fit, and all of them are no longer than the array.
class OwnRanges {
 public:
  OwnRanges(size_t size, const char* what) : size_(size), left_(size), what_(what) {}
  void take(uint64_t first, uint64_t count) {
    require(first <= size_ && count <= size_ - first && count <= left_, what_);
    left_ -= count;
  }

 private:
  size_t size_, left_;
  const char* what_;
};

inline bool exists(const Scene& s, PrimitiveId id, PrimitiveKind kind) {
  const std::array<size_t, 6> counts{
      s.triangle_shading.size(), s.spheres.size(),    s.polygons.size(),
      s.quadrics.size(),         s.mesh_faces.size(), s.collections.size()};  // in the order of PrimitiveKind
  return id.kind() == kind && id.index() < counts[static_cast<size_t>(kind)];
}

}  // namespace rayfarm
