#include "common/lighting/zones/shared_corners.h"

#include <unordered_map>

#include "common/sampling/random.h"

namespace rayfarm {
namespace {

/// Corners so near to each other, in parts of the scene's size, are one.
constexpr double kCornerGrid = 0x1p-24;

/// What tells corners apart. Rounding is askew, so that places that scenes prefer are not on its edges.
struct CornerKey {
  std::array<int64_t, 3> p{};
  std::array<int32_t, 3> normal{};
  uint32_t material = 0;
  bool operator==(const CornerKey&) const = default;
};
struct CornerHash {
  size_t operator()(const CornerKey& key) const {
    uint64_t h = key.material;
    for (size_t i = 0; i < 3; ++i)
      h = mix_bits(mix_bits(h ^ static_cast<uint64_t>(key.p[i])) ^ static_cast<uint32_t>(key.normal[i]));
    return h;
  }
};

}  // namespace

void SharedCorners::find() {
  shared_.assign(map_.corner_count(), kNone);
  Box bounds;
  for (uint32_t i = 0; i < map_.scene().instances.size(); ++i)
    if (!map_.pose()[i].is_hidden) bounds.grow(map_.pose()[i].bounds);
  const double step = kCornerGrid * std::max(max_component(bounds.extent()), bounds.magnitude() * 1e-8);
  std::unordered_map<CornerKey, uint32_t, CornerHash> numbers;
  for_each_corner([&](const ZoneGrid& grid, uint32_t, double area, uint32_t corner) {
    uint32_t& shared = shared_[corner];
    if (shared == kNone) {
      const InstancePose& place = map_.pose()[grid.instance];
      const ZoneMap::Corner at = map_.corner(grid, corner - grid.first_corner);
      const Vec3 p = place.is_identity ? at.p : place.world_from_object.point(at.p);
      const Vec3 normal =
          place.is_identity ? at.normal : normalized(place.object_from_world.normal_by_inverse(at.normal));
      CornerKey key;
      key.material = grid.material;
      for (int i = 0; i < 3; ++i) {
        key.p[static_cast<size_t>(i)] = static_cast<int64_t>(std::floor(p[i] / step + 0.381966));
        key.normal[static_cast<size_t>(i)] = static_cast<int32_t>(std::floor(normal[i] * 1000 + 0.381966));
      }
      shared = numbers.emplace(key, static_cast<uint32_t>(areas_.size())).first->second;
      if (shared == areas_.size()) areas_.push_back(0);
    }
    areas_[shared] += area;
  });
}

}  // namespace rayfarm
