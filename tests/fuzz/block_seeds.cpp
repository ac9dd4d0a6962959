#include "tests/fuzz/block_seeds.h"

#include <fmt/core.h>

#include <array>

#include "common/compile/compile.h"
#include "common/description/formats/scene_loaders.h"

namespace rayfarm::fuzz {
namespace {

std::string text_of(const CompiledScene& compiled) {
  const auto bytes = compiled.block.bytes();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::vector<std::string> block_seeds() {
  std::vector<std::string> seeds;
  for (const char* name : {"primitives", "animation", "materials", "tiles", "glasses", "gloss"}) {
    const CompiledScene compiled =
        compile(load_scene(std::string(RAYFARM_SOURCE "/scenes/") + name + ".yaml"));
    if (compiled.block.size < 1 << 18) seeds.push_back(text_of(compiled));
  }
  const std::array<BuildOptions, 5> builds{
      {{},  // whose scene has structures in structures
       {.hierarchy = Hierarchy::regular, .cells = 3, .has_mailbox = true},
       {.hierarchy = Hierarchy::adaptive, .max_primitives = 3, .octree_depth = 4, .octree_hash = 7},
       {.hierarchy = Hierarchy::adaptive,
        .max_primitives = 3,
        .octree_data = OctreeData::pointers,
        .octree_next = OctreeNext::dda,
        .octree_depth = 4},
       {.hierarchy = Hierarchy::object}}};
  for (const char* scene : {"stage", "bounds"}) {
    const SceneDescription description =
        load_scene(fmt::format("{}/tests/golden/scenes/{}.yaml", RAYFARM_SOURCE, scene));
    for (const BuildOptions& build : builds) seeds.push_back(text_of(compile(description, build)));
  }
  return seeds;
}

}  // namespace rayfarm::fuzz
