#include "tests/fuzz/block_seeds.h"

#include <fmt/core.h>

#include <array>

#include "common/compile/compile.h"
#include "common/description/formats/scene_loaders.h"
#include "tests/deforming_scene.h"

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
  const std::array<BuildOptions, 7> builds{
      {{},  // whose scene has structures in structures
       {.hierarchy = Hierarchy::regular, .cells = 3, .has_mailbox = true},
       {.hierarchy = Hierarchy::adaptive, .max_primitives = 3, .octree_depth = 4, .octree_hash = 7},
       {.hierarchy = Hierarchy::adaptive,
        .max_primitives = 3,
        .octree_data = OctreeData::pointers,
        .octree_next = OctreeNext::dda,
        .octree_depth = 4},
       {.hierarchy = Hierarchy::object, .has_last_hit = true},
       {.hierarchy = Hierarchy::thesis,
        .max_primitives = 2,
        .thesis = {.volumes = ThesisVolumes::spheres},
        .ray_coherence = 20},
       {.hierarchy = Hierarchy::adaptive, .max_primitives = 2, .octree_build = OctreeBuild::tracing}}};
  for (const char* scene : {"fog", "principled"})
    seeds.push_back(
        text_of(compile(load_scene(fmt::format("{}/tests/golden/scenes/{}.yaml", RAYFARM_SOURCE, scene)))));
  for (const char* scene : {"stage", "bounds"}) {
    const SceneDescription description =
        load_scene(fmt::format("{}/tests/golden/scenes/{}.yaml", RAYFARM_SOURCE, scene));
    for (const BuildOptions& build : builds) seeds.push_back(text_of(compile(description, build)));
  }
  for (const SceneDescription& description : {test::make_bulging_tube(5, 6), test::make_scrambled(5, 6)})
    seeds.push_back(text_of(compile(description)));
  return seeds;
}

}  // namespace rayfarm::fuzz
