// Every hierarchy over every scene that is shipped, and over Haines's: the same pixels to the byte as the
// default's.
#include <filesystem>

#include "common/lighting/renderer.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

std::vector<std::pair<std::string, BuildOptions>> other_hierarchies() {
  return {{"sah, whole primitives", {.max_primitives = 3, .quality = BuildQuality::fast}},
          {"thesis", {.hierarchy = Hierarchy::thesis, .max_primitives = 15}},
          {"thesis to the letter",
           {.hierarchy = Hierarchy::thesis,
            .max_primitives = 25,
            .thesis = {.volumes = ThesisVolumes::spheres, .clip = ThesisClip::always}}},
          {"regular", {.hierarchy = Hierarchy::regular}},
          {"regular with a mailbox", {.hierarchy = Hierarchy::regular, .cells = 13, .has_mailbox = true}},
          {"adaptive", {.hierarchy = Hierarchy::adaptive, .max_primitives = 10, .octree_depth = 10}},
          {"adaptive by pointers and steps",
           {.hierarchy = Hierarchy::adaptive,
            .max_primitives = 25,
            .octree_data = OctreeData::pointers,
            .octree_next = OctreeNext::dda,
            .octree_depth = 8,
            .has_mailbox = true}},
          {"adaptive, made while rays are traced",
           {.hierarchy = Hierarchy::adaptive, .max_primitives = 4, .octree_build = OctreeBuild::tracing}},
          {"brute", {.hierarchy = Hierarchy::brute}},
          {"object", {.hierarchy = Hierarchy::object}},
          {"object, clustered",
           {.hierarchy = Hierarchy::object,
            .objects = {.bounds = BoundChoice::slabs, .clusters = Clusters::automatic}}}};
}

std::vector<std::byte> pixels_of(const SceneDescription& description, const BuildOptions& build, int width_px,
                                 int height_px) {
  const CompiledScene compiled = compile(description, build);
  RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  settings.crop = {0, 0, width_px, height_px};
  settings.pixel_format = PixelFormat::float32;
  settings.max_depth = 4;
  const int frame = description.frames ? (*description.frames)[0] : 1;
  return Renderer(compiled.scene, settings).render(frame, settings.crop, [] {}).pixels;
}

std::vector<std::string> scene_files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(RAYFARM_SOURCE "/scenes"))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  for (const char* name : {"balls", "gears", "mount", "rings", "teapot", "tetra"})
    files.push_back(fmt::format("{}/../shared/assets/spd/{}.nff", RAYFARM_SOURCE, name));
  std::sort(files.begin(), files.end());
  return files;
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, LooksTheSameInEveryHierarchy) {
  if (!std::filesystem::exists(GetParam())) GTEST_SKIP() << GetParam() << " is not there";
  const SceneDescription description = load_scene(GetParam());
  const bool is_large = GetParam().ends_with(".nff");  // of which every primitive is tested with every ray
  const int width_px = is_large ? 10 : 24, height_px = is_large ? 8 : 18;
  const std::vector<std::byte> expected = pixels_of(description, {}, width_px, height_px);
  EXPECT_NE(std::adjacent_find(expected.begin(), expected.end(), std::not_equal_to<>()), expected.end());
  // Where most of the time goes into placing hundreds of thousands of copies, each with a part of its own,
  // two hierarchies are enough.
  const bool has_many_copies = compile(description).scene.instances.size() > 100'000;
  for (const auto& [name, build] : other_hierarchies())
    if (!has_many_copies || name == "object" || name == "regular") {
      EXPECT_EQ(pixels_of(description, build, width_px, height_px), expected) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(, EveryScene, testing::ValuesIn(scene_files()), [](const auto& scene) {
  std::string name = std::filesystem::path(scene.param).parent_path().filename().string() + "_" +
                     std::filesystem::path(scene.param).stem().string();
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace rayfarm
