// What is written down of a scene's rays.
#include "common/hierarchy/ray_log.h"

#include "common/hierarchy/traverser.h"
#include "common/lighting/renderer.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(RayLog, HoldsTheRaysThatThePicturesCountsTellOf) {
  const CompiledScene compiled =
      compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/hierarchies/pool_room.yaml"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 20;
  settings.crop = {0, 0, 20, 20};
  settings.sampling = SamplingPattern::corners;
  const RenderedPixels without = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
  RayLog log;
  Scene scene = compiled.scene;
  scene.ray_log = &log;
  const RenderedPixels with = Renderer(scene, settings).render(0, settings.crop, [] {});
  EXPECT_EQ(with.pixels, without.pixels);
  const RayCounts& counts = with.counts;
  EXPECT_EQ(counts[RayKind::primary], 21u * 21u);
  EXPECT_EQ(log.closest.size(),
            counts[RayKind::primary] + counts[RayKind::reflected] + counts[RayKind::transmitted]);
  EXPECT_EQ(log.any.size(), counts[RayKind::shadow]);
}

TEST(RayLog, HoldsSingleRaysAndThoseOfAPacketThatAreAskedFor) {
  const CompiledScene compiled =
      compile(test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"));
  RayLog log;
  Scene scene = compiled.scene;
  scene.ray_log = &log;
  FrameState state(scene);
  const std::vector<Ray> rays{
      {Vec3(0, 0, 5), Vec3(0, 0, -1)}, {Vec3(0, 3, 5), Vec3(0, 0, -1), 7}, {Vec3(1, 0, 5), Vec3(0, 0, 1)}};
  closest_hit(scene, state.at(0), rays[1]);
  any_hit(scene, state.at(0), rays[2]);
  any_hits(scene, state.at(0), RayPacket(rays), 0b101);
  ASSERT_EQ(log.closest.size(), 1u);
  EXPECT_EQ(log.closest[0].t_max, 7);
  ASSERT_EQ(log.any.size(), 3u);
  EXPECT_EQ(log.any[1].origin, rays[0].origin);
  EXPECT_EQ(log.any[2].origin, rays[2].origin);
}

}  // namespace
}  // namespace rayfarm
