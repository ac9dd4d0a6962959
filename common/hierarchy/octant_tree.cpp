#include "common/hierarchy/octant_tree.h"

#include "common/hierarchy/cells.h"
#include "common/hierarchy/octants.h"

namespace rayfarm {
namespace {

/// The number in Table 4.1 of one of Octants, and the other way round.
uint32_t renumbered(uint32_t octant) {
  return (octant & 1 ? 0u : 4u) | (octant & 2 ? 0u : 2u) | (octant & 4 ? 0u : 1u);
}

class Builder {
 public:
  Builder(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers, const Box& whole,
          const BuildOptions& options, SceneArrays<GrowingArray>& arrays)
      : pointers_(pointers),
        options_(options),
        arrays_(arrays),
        margin_(max_component(with_margin(whole).hi - whole.hi)),
        divider_(source, options, whole, margin_) {
    tree_.magnitude = whole.magnitude();
    tree_.first_volume = static_cast<uint32_t>(arrays.octant_volumes.size());
  }

  uint32_t build(LargeVector<PrimitiveReference> references) {
    arrays_.octant_volumes.push_back({});
    fill(tree_.first_volume, {std::move(references)});
    tree_.volume_count = static_cast<uint32_t>(arrays_.octant_volumes.size()) - tree_.first_volume;
    arrays_.octant_trees.push_back(tree_);
    return static_cast<uint32_t>(arrays_.octant_trees.size() - 1);
  }

 private:
  void fill(uint32_t index, VolumeData data) {
    throw_if_stopped(options_.stop);
    OctantVolume volume;
    volume.center = divider_.center_of(data);
    for (const PrimitiveReference& r : data.references) {
      const Box box = r.box();
      const Vec3 farthest = glm::max(glm::abs(box.lo - volume.center), glm::abs(box.hi - volume.center));
      volume.radius = std::max(volume.radius, glm::length(farthest) + margin_);
    }
    Octants octants;
    if (divider_.is_to_be_divided(data) && divider_.clip(data, volume.center, octants)) {
      LargeVector<PrimitiveReference>().swap(data.references);
      divide(index, volume, octants);
    } else {
      list(volume, data.references);
      arrays_.octant_volumes[index] = volume;
    }
  }

  void divide(uint32_t index, OctantVolume& volume, Octants& octants) {
    uint32_t next = static_cast<uint32_t>(arrays_.octant_volumes.size());
    volume.first = next - tree_.first_volume;
    for (uint32_t number = 0; number < 8; ++number) {
      if (octants[renumbered(number)].references.empty()) continue;
      volume.octants |= 1u << number;
      arrays_.octant_volumes.push_back({});
    }
    check_count(arrays_.octant_volumes.size(), "volumes", "--max-primitives");
    arrays_.octant_volumes[index] = volume;
    for (uint32_t number = 0; number < 8; ++number)
      if (volume.octants >> number & 1) fill(next++, std::move(octants[renumbered(number)]));
  }

  void list(OctantVolume& volume, std::span<const PrimitiveReference> references) {
    if (options_.progress) options_.progress->done += references.size();
    check_count(arrays_.primitive_pointers.size() + references.size(), "pointers from volumes to primitives",
                "--max-primitives");
    volume.first = static_cast<uint32_t>(arrays_.primitive_pointers.size());
    volume.pointer_count = static_cast<uint32_t>(references.size());
    for (const PrimitiveReference& r : references)
      arrays_.primitive_pointers.push_back(pointers_[r.primitive]);
  }

  std::span<const PrimitivePointer> pointers_;
  const BuildOptions& options_;
  SceneArrays<GrowingArray>& arrays_;
  OctantTree tree_;
  double margin_;  ///< of octants and spheres
  OctantDivider divider_;
};

}  // namespace

uint32_t build_octant_tree(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
                           const BuildOptions& options, SceneArrays<GrowingArray>& arrays) {
  LargeVector<PrimitiveReference> references = make_references(source, options);
  if (options.progress) options.progress->total += references.size();
  return Builder(source, pointers, thick_bounds(source), options, arrays).build(std::move(references));
}

OctantOrder::OctantOrder(const Vec3& center, const Vec3& origin, const Vec3& direction) {
  std::array<uint32_t, 4> changes{};
  for (size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    const uint32_t bit = 4u >> i;
    const bool is_below = origin[axis] < center[axis];
    if (is_below) octants[0] |= bit;
    if (!(is_below ? direction[axis] > 0 : direction[axis] < 0)) continue;
    const double t = (center[axis] - origin[axis]) / direction[axis];
    size_t place = count++;
    for (; place > 1 && entries[place - 1] > t; --place) {
      entries[place] = entries[place - 1];
      changes[place] = changes[place - 1];
    }
    entries[place] = t;
    changes[place] = bit;
  }
  for (size_t i = 1; i < count; ++i) octants[i] = octants[i - 1] ^ changes[i];
}

}  // namespace rayfarm
