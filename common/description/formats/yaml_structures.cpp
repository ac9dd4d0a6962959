#include "common/description/formats/yaml_structures.h"

#include <algorithm>

#include "common/scene/hierarchy_records.h"

namespace rayfarm {
namespace {

const std::vector<std::string>& hierarchy_names() {  // in the order of Hierarchy
  static const std::vector<std::string> names{"sah", "thesis", "regular", "adaptive", "brute", "object"};
  return names;
}

uint32_t whole_number(const YamlValue& value, int least, int most) {
  return static_cast<uint32_t>(value.whole_number_in(least, most));
}

/// `of_all`: `best` is a word, too, and `none` is not.
BoundChoice read_one_bound(const YamlValue& value, bool of_all) {
  if (of_all) return static_cast<BoundChoice>(value.choice({"sphere", "box", "cylinder", "slabs", "best"}));
  const size_t kind = value.choice({"sphere", "box", "cylinder", "slabs", "none"});
  return kind == 4 ? BoundChoice::none : static_cast<BoundChoice>(kind);
}

void read_octree(YamlMap& options, BuildOptions& build) {
  if (auto v = options.find("max_primitives")) build.max_primitives = whole_number(*v, 1, 1000);
  if (auto v = options.find("depth")) build.octree_depth = whole_number(*v, 1, int{kMostOctreeDepth});
  if (auto v = options.find("data"))
    build.octree_data = static_cast<OctreeData>(v->choice({"hash", "pointers"}));
  if (build.octree_data == OctreeData::hash)
    if (auto v = options.find("hash")) build.octree_hash = whole_number(*v, 1, int{kMostHashPlaces});
  if (auto v = options.find("next"))
    build.octree_next = static_cast<OctreeNext>(v->choice({"root", "walk", "dda"}));
  if (auto v = options.find("mailbox")) build.has_mailbox = v->boolean();
}

}  // namespace

std::vector<BoundChoice> read_bound(const YamlValue& value) {
  if (!value.is_sequence()) return {read_one_bound(value, false)};
  std::vector<BoundChoice> bounds;
  for (const YamlValue& item : value.items()) bounds.push_back(read_one_bound(item, false));
  if (bounds.empty() || bounds.size() > kVolumeKinds)
    value.fail("a list of bounding volumes has one to four of them; `bound: none` is none");
  if (bounds.size() > 1 && std::find(bounds.begin(), bounds.end(), BoundChoice::none) != bounds.end())
    value.fail("`none` stands alone: `bound: none`");
  return bounds;
}

StructureDescription read_structure(const YamlValue& value) {
  StructureDescription structure;
  structure.place = value.place();
  BuildOptions& build = structure.build;
  if (!value.is_map()) {
    build.hierarchy = static_cast<Hierarchy>(value.choice(hierarchy_names()));
    return structure;
  }
  const auto entries = value.entries();
  if (entries.size() != 1)
    value.fail("a structure is one name, perhaps with its options: `structure: {regular: {cells: 20}}`");
  build.hierarchy = static_cast<Hierarchy>(entries[0].first.choice(hierarchy_names()));
  YamlMap options(entries[0].second);
  switch (build.hierarchy) {
    case Hierarchy::sah:
      if (auto v = options.find("build"))
        build.quality = static_cast<BuildQuality>(v->choice({"fast", "balanced", "high"}));
      [[fallthrough]];
    case Hierarchy::thesis:
      if (auto v = options.find("max_primitives")) build.max_primitives = whole_number(*v, 1, 1000);
      break;
    case Hierarchy::regular:
      if (auto v = options.find("cells")) build.cells = whole_number(*v, 1, static_cast<int>(kMostCells));
      if (auto v = options.find("mailbox")) build.has_mailbox = v->boolean();
      break;
    case Hierarchy::adaptive:
      read_octree(options, build);
      break;
    case Hierarchy::brute:
      break;
    case Hierarchy::object:
      if (auto v = options.find("bounds")) build.objects.bounds = read_one_bound(*v, true);
      if (auto v = options.find("clusters"))
        build.objects.clusters = static_cast<Clusters>(v->choice({"groups", "none", "automatic"}));
      if (auto v = options.find("order"))
        build.objects.order = static_cast<ObjectOrder>(v->choice({"sorted", "all"}));
      break;
  }
  options.finish();
  return structure;
}

}  // namespace rayfarm
