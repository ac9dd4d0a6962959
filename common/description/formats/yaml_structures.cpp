#include "common/description/formats/yaml_structures.h"

#include "common/scene/hierarchy_records.h"

namespace rayfarm {
namespace {

const std::vector<std::string>& hierarchy_names() {  // in the order of Hierarchy
  static const std::vector<std::string> names{"sah", "thesis", "regular", "brute"};
  return names;
}

uint32_t whole_number(const YamlValue& value, int least, int most) {
  return static_cast<uint32_t>(value.whole_number_in(least, most));
}

}  // namespace

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
      break;
    case Hierarchy::brute:
      break;
  }
  options.finish();
  return structure;
}

}  // namespace rayfarm
