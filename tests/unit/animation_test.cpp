#include "common/scene/animation.h"

#include "common/hierarchy/traverser.h"
#include "common/lighting/moments.h"
#include "common/scene/camera.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(Curve, LinearAndConstantOutside) {
  const std::vector<double> frames{10, 20};
  const std::vector<Vec4> values{Vec4(0, 1, 0, 0), Vec4(10, 3, 0, 0)};
  EXPECT_EQ(eval_curve(Interpolation::linear, frames, values, 15), Vec4(5, 2, 0, 0));
  EXPECT_EQ(eval_curve(Interpolation::linear, frames, values, 0), values[0]);
  EXPECT_EQ(eval_curve(Interpolation::linear, frames, values, 99), values[1]);
}

TEST(Curve, SphericalKeepsTheLengthAndTheSpeed) {
  const std::vector<double> frames{0, 90};
  const std::vector<Vec4> values{Vec4(2, 0, 0, 0), Vec4(0, 0, 5, 0)};
  for (int degrees = 0; degrees <= 90; degrees += 15) {
    const Vec4 v = eval_curve(Interpolation::spherical, frames, values, degrees);
    if (degrees > 0 && degrees < 90) {
      EXPECT_NEAR(v.x, std::cos(degrees * M_PI / 180), 1e-12);
      EXPECT_NEAR(v.z, std::sin(degrees * M_PI / 180), 1e-12);
    }
  }
}

TEST(Curve, RotationsTakeTheShorterArc) {
  const auto quaternion = [](double degrees) {
    return Vec4(0, std::sin(degrees * M_PI / 360), 0, std::cos(degrees * M_PI / 360));
  };
  const std::vector<double> frames{0, 1};
  const std::vector<Vec4> values{quaternion(0), -quaternion(80)};  // q and -q are the same rotation
  const Affine half = eval_transform(
      TransformKind::orient, eval_curve(Interpolation::spherical_rotation, frames, values, 0.5), {}, {});
  const Vec3 p = half.point(Vec3(1, 0, 0));
  EXPECT_NEAR(p.x, std::cos(40 * M_PI / 180), 1e-12);
  EXPECT_NEAR(p.z, -std::sin(40 * M_PI / 180), 1e-12);
}

TEST(Curve, CubicsAreHermites) {
  // x(t) = t³ - 2t + 1 at frames 0, 2 and 5 with its own slopes is itself; so is any cubic.
  const auto x = [](double t) { return t * t * t - 2 * t + 1; };
  const auto slope = [](double t) { return 3 * t * t - 2; };
  const std::vector<double> frames{0, 2, 5};
  std::vector<Vec4> values;
  for (const double t : frames)
    for (const double v : {slope(t), x(t), slope(t)}) values.emplace_back(v, 0, 0, 0);
  for (double t = 0; t <= 5; t += 0.25)
    EXPECT_NEAR(eval_curve(Interpolation::cubic, frames, values, t).x, x(t), 1e-12) << t;
  EXPECT_EQ(eval_curve(Interpolation::cubic, frames, values, -1).x, x(0));
  EXPECT_EQ(eval_curve(Interpolation::cubic, frames, values, 6).x, x(5));
  // A slope that it leaves with is not the one that it arrives with.
  values[3].x = 100;
  EXPECT_NEAR(eval_curve(Interpolation::cubic, frames, values, 3).x, x(3), 1e-12);
  EXPECT_NE(eval_curve(Interpolation::cubic, frames, values, 1).x, x(1));
  for (Vec4& v : values) v = Vec4(v.x, 1, 2, 3);
  EXPECT_NEAR(glm::length(eval_curve(Interpolation::cubic_rotation, frames, values, 3.3)), 1, 1e-12);
}

TEST(Animation, RefitFindsWhatBruteForceFindsInEveryFrame) {
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/animation.yaml"));
  ASSERT_FALSE(compiled.scene.moving_instances.empty());
  FrameState frame_pose(compiled.scene);
  for (const int frame : {1, 7, 24}) {
    const Pose pose = frame_pose.at(frame);
    const Camera camera = make_camera(compiled.scene, frame, 60, 45);
    int hits = 0;
    for (int y = 0; y < 45; ++y)
      for (int x = 0; x < 60; ++x) {
        const Ray ray = camera.ray(x + 0.5, y + 0.5);
        const Hit fast = closest_hit(compiled.scene, pose, ray),
                  slow = closest_hit_brute_force(compiled.scene, pose, ray);
        ASSERT_EQ(fast.t, slow.t);
        ASSERT_EQ(fast.instance, slow.instance);
        hits += fast.is_hit() && fast.instance > 0 ? 1 : 0;
      }
    EXPECT_GT(hits, 50);
  }
}

TEST(Animation, FrameStateHoldsOnlyWhatMoves) {
  std::string text = test::view_text() +
                     "frames: [0, 4]\nobjects: {ball: {sphere: {center: [0, 0, 0], radius: 0.1}}}\nscene:\n";
  for (int i = 0; i < 40; ++i)
    text += fmt::format(
        "  - {{use: ball, transform: {{translate: {}}}}}\n",
        i % 10 == 3 ? fmt::format("{{0: [{0}, 0, 0], 4: [{0}, 2, 0]}}", i) : fmt::format("[{}, 0, 0]", i));
  const CompiledScene compiled = compile(test::load_yaml(text));
  const Scene& scene = compiled.scene;
  ASSERT_EQ(scene.instances.size(), 40u);
  ASSERT_EQ(scene.moving_instances.size(), 4u);
  EXPECT_EQ(scene.moving_nodes.size(), 1u);
  FrameState state(scene);
  const Pose pose = state.at(2);
  EXPECT_NE(pose.moving_nodes(), scene.moving_nodes.data());
  for (uint32_t i = 0; i < 40; ++i) {
    EXPECT_EQ(&pose[i] == &scene.poses[i], i % 10 != 3) << "what never moves is read in the block";
    EXPECT_EQ(pose[i].world_from_object.translation, Vec3(i, i % 10 == 3 ? 1 : 0, 0));
  }
}

TEST(Camera, FieldOfViewSpansTheWidthAndPixelsAreSquare) {
  const CompiledScene compiled = compile(
      test::load_yaml("view: {location: [0, 0, 0], direction: [0, 0, -2], field_of_view: 90}\nscene: []\n"));
  const Camera camera = make_camera(compiled.scene, 0, 200, 100);
  const Vec3 left = camera.ray(0, 50).direction, top = camera.ray(100, 0).direction;
  EXPECT_NEAR(left.x / left.z, 1, 1e-12);  // 45° to the left: x = z, both negative
  EXPECT_NEAR(top.y / -top.z, 0.5, 1e-12);
  EXPECT_THROW(
      make_camera(
          compile(test::load_yaml("view: {location: [0, 0, 0], direction: [0, 1, 0]}\nscene: []\n")).scene, 0,
          4, 4),
      std::domain_error);
}

TEST(Moments, SamplesAtTheEndOfTheShutterHaveOne) {
  const double last = std::nextafter(1.0, 0.0);
  for (const uint32_t samples : {1u, 3u, 1u << 20})
    for (const size_t moments : {size_t{1}, size_t{64}}) {
      EXPECT_EQ(moment_index(moments, 0, samples), 0u);
      EXPECT_EQ(moment_index(moments, samples - 1 + last, samples), moments - 1);
    }
}

}  // namespace
}  // namespace rayfarm
