#include "common/description/formats/yaml_structures.h"

#include <algorithm>

#include "common/scene/hierarchy_records.h"

namespace rayfarm {
namespace {

/// The value of which this is the word.
template <typename Value, size_t count>
Value read_word(const YamlValue& value, const std::array<const char*, count>& words) {
  return static_cast<Value>(value.choice({words.begin(), words.end()}));
}

uint32_t whole_number(const YamlValue& value, int least, int most) {
  return static_cast<uint32_t>(value.whole_number_in(least, most));
}

BoundChoice read_one_bound(const YamlValue& value) {
  const auto bound = read_word<BoundChoice>(value, kOneBoundWords);
  return bound == BoundChoice::best ? BoundChoice::none : bound;
}

void read_octree(YamlMap& options, BuildOptions& build) {
  if (auto v = options.find("max_primitives")) build.max_primitives = whole_number(*v, 1, 1000);
  if (auto v = options.find("depth")) build.octree_depth = whole_number(*v, 1, int{kMostOctreeDepth});
  if (auto v = options.find("data")) build.octree_data = read_word<OctreeData>(*v, kOctreeDataWords);
  if (build.octree_data == OctreeData::hash)
    if (auto v = options.find("hash")) build.octree_hash = whole_number(*v, 1, int{kMostHashPlaces});
  if (auto v = options.find("next")) build.octree_next = read_word<OctreeNext>(*v, kOctreeNextWords);
  if (auto v = options.find("build")) build.octree_build = read_word<OctreeBuild>(*v, kOctreeBuildWords);
  if (auto v = options.find("mailbox")) build.has_mailbox = v->boolean();
}

void read_thesis(YamlMap& options, BuildOptions& build) {
  if (auto v = options.find("max_primitives")) build.max_primitives = whole_number(*v, 1, 1000);
  ThesisOptions& thesis = build.thesis;
  if (auto v = options.find("volumes")) thesis.volumes = read_word<ThesisVolumes>(*v, kThesisVolumesWords);
  if (auto v = options.find("clip")) thesis.clip = read_word<ThesisClip>(*v, kThesisClipWords);
  if (auto v = options.find("center")) thesis.center = read_word<ThesisCenter>(*v, kThesisCenterWords);
  if (thesis.volumes == ThesisVolumes::spheres)
    if (auto v = options.find("mailbox")) build.has_mailbox = v->boolean();
}

}  // namespace

std::vector<BoundChoice> read_bound(const YamlValue& value) {
  if (!value.is_sequence()) return {read_one_bound(value)};
  std::vector<BoundChoice> bounds;
  for (const YamlValue& item : value.items()) bounds.push_back(read_one_bound(item));
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
    build.hierarchy = read_word<Hierarchy>(value, kHierarchyWords);
    return structure;
  }
  const auto entries = value.entries();
  if (entries.size() != 1)
    value.fail("a structure is one name, perhaps with its options: `structure: {regular: {cells: 20}}`");
  build.hierarchy = read_word<Hierarchy>(entries[0].first, kHierarchyWords);
  YamlMap options(entries[0].second);
  switch (build.hierarchy) {
    case Hierarchy::sah:
      if (auto v = options.find("build")) build.quality = read_word<BuildQuality>(*v, kBuildQualityWords);
      if (auto v = options.find("max_primitives")) build.max_primitives = whole_number(*v, 1, 1000);
      break;
    case Hierarchy::thesis:
      read_thesis(options, build);
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
      if (auto v = options.find("bounds")) build.objects.bounds = read_word<BoundChoice>(*v, kBoundWords);
      if (auto v = options.find("clusters")) build.objects.clusters = read_word<Clusters>(*v, kClustersWords);
      if (auto v = options.find("order")) build.objects.order = read_word<ObjectOrder>(*v, kObjectOrderWords);
      break;
  }
  options.finish();
  return structure;
}

}  // namespace rayfarm
