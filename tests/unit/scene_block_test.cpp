#include "common/scene/scene_block.h"

#include <cstring>

#include "common/scene/settings_codec.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

SceneBlock copy_of(std::span<const std::byte> bytes) {
  SceneBlock block;
  block.size = bytes.size();
  block.data.reset(static_cast<std::byte*>(std::aligned_alloc(64, (bytes.size() + 63) / 64 * 64)));
  std::memcpy(block.data.get(), bytes.data(), bytes.size());
  return block;
}

TEST(SceneBlock, ThereAndBackIsIdentical) {
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/animation.yaml"));
  const SceneBlock moved = copy_of(compiled.block.bytes());
  const SceneBlock again = encode_scene(decode_scene(moved.bytes()));
  ASSERT_EQ(again.size, compiled.block.size);
  EXPECT_EQ(std::memcmp(again.data.get(), compiled.block.data.get(), again.size), 0);
}

TEST(SceneBlock, CompilingTwiceGivesTheSameBytes) {
  const SceneDescription scene = test::make_mixed_scene(1, 1, 200);
  const CompiledScene a = compile(scene), b = compile(scene);
  ASSERT_EQ(a.block.size, b.block.size);
  EXPECT_EQ(std::memcmp(a.block.data.get(), b.block.data.get(), a.block.size), 0);
}

TEST(SceneBlock, DamagedBytesEndInAnErrorOrInAValidScene) {
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/animation.yaml"));
  std::mt19937 random(3);
  int errors = 0;
  for (int i = 0; i < 3000; ++i) {
    SceneBlock damaged = copy_of(compiled.block.bytes());
    for (int k = 0; k < 4; ++k)
      damaged.data.get()[random() % damaged.size] = static_cast<std::byte>(random());
    try {
      decode_scene(damaged.bytes());
    } catch (const SceneBlockError&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 300);
  for (size_t size = 0; size < compiled.block.size; size += 977)
    EXPECT_THROW(decode_scene(copy_of(compiled.block.bytes().first(size)).bytes()), SceneBlockError);
}

TEST(Settings, ThereAndBack) {
  RenderSettings settings;
  settings.samples = 17;
  settings.min_weight = 0.125;
  settings.crop = {1, 2, 30, 40};
  settings.sampling = SamplingPattern::corners;
  const RenderSettings back = decode_settings(encode_settings(settings));
  EXPECT_EQ(back.samples, 17u);
  EXPECT_EQ(back.min_weight, 0.125);
  EXPECT_EQ(back.crop, settings.crop);
  EXPECT_EQ(back.sampling, SamplingPattern::corners);
  EXPECT_THROW(decode_settings(std::vector<std::byte>(3)), std::exception);
}

}  // namespace
}  // namespace rayfarm
