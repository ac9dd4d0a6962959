#include "common/scene/octant_checks.h"

#include <bit>
#include <cmath>

#include "common/scene/check_tools.h"

namespace rayfarm {
namespace {

/// Octants stand behind the volume that is divided, and have one parent each.
void check_tree(const Scene& s, std::span<const OctantVolume> volumes) {
  constexpr uint32_t kAllOctants = 0xff;
  require(!volumes.empty(), "the root of octants");
  std::vector<int> levels(volumes.size(), 0);
  levels[0] = 1;
  for (size_t i = 0; i < volumes.size(); ++i) {
    const OctantVolume& v = volumes[i];
    require(levels[i] > 0, "a volume that is nobody's octant");
    require(std::isfinite(v.center.x) && std::isfinite(v.center.y) && std::isfinite(v.center.z) &&
                std::isfinite(v.radius) && v.radius >= 0,
            "a volume's sphere");
    if (v.is_leaf()) {
      require(
          v.first <= s.primitive_pointers.size() && v.pointer_count <= s.primitive_pointers.size() - v.first,
          "a volume's list");
      continue;
    }
    const auto count = static_cast<uint32_t>(std::popcount(v.octants));
    require(v.octants <= kAllOctants && v.first > i && v.first <= volumes.size() &&
                count <= volumes.size() - v.first && levels[i] < kMostHierarchyLevels,
            "a volume's octants");
    for (uint32_t child = v.first; child < v.first + count; ++child) {
      require(levels[child] == 0, "a volume's octants");
      levels[child] = levels[i] + 1;
    }
  }
}

}  // namespace

void check_octant_trees(const Scene& s) {
  OwnRanges own(s.octant_volumes.size(), "the volumes of octants");
  for (const OctantTree& tree : s.octant_trees) {
    require(std::isfinite(tree.magnitude) && tree.magnitude >= 0, "the size of octants");
    own.take(tree.first_volume, tree.volume_count);
    check_tree(s, s.octant_volumes.subspan(tree.first_volume, tree.volume_count));
  }
}

}  // namespace rayfarm
