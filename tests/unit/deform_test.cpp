// Meshes that change their shape: where vertices go, and that a frame's part is what a part compiled for it
// would be.
#include "common/hierarchy/deformed_parts.h"
#include "common/hierarchy/traverser.h"
#include "common/lighting/renderer.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/scene/array_offsets.h"
#include "tests/deforming_scene.h"
#include "tests/unit/simd_targets.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

constexpr double kFloat = 1e-6;  // vertices are stored in float

void expect_near_to(const Vec3& a, const Vec3& b, double tolerance) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "axis " << k;
}

Vec3 turned_about_z(const Vec3& p, double degrees) {
  const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
  return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

std::vector<std::byte> frame_of(const Scene& scene, int frame, LightingModel model = LightingModel::whitted,
                                double shutter = 0, uint32_t samples = 1) {
  RenderSettings settings = test::picture_settings(48, 36, model);
  settings.samples = samples;
  settings.shutter = shutter;
  limit_by_depth(settings, 3);
  return Renderer(scene, settings).render(frame, settings.crop, [] {}).pixels;
}

/// The same scene with the meshes as `frame` has them, which never change.
SceneDescription frozen(const SceneDescription& description, const Scene& scene, double frame) {
  DeformedVertices vertices;
  deform(scene, frame, vertices);
  SceneDescription still = description;
  size_t first = 0;
  for (ObjectDescription& object : still.objects)
    for (PrimitiveDescription& primitive : object.primitives) {
      auto* const mesh = std::get_if<MeshShape>(&primitive.shape);
      if (!mesh) continue;
      for (size_t i = 0; i < mesh->positions.size(); ++i) {
        mesh->positions[i] = vertices.positions[first + i];
        if (!mesh->normals.empty()) mesh->normals[i] = vertices.normals[first + i];
      }
      first += mesh->positions.size();
      mesh->deformation = nullptr;
    }
  return still;
}

TEST(Deform, AnArmBendsAsItsJointsSay) {
  const SceneDescription description = test::make_bending_tube(9, 8);
  const CompiledScene compiled = compile(description);
  const auto& mesh = std::get<MeshShape>(description.objects[1].primitives[0].shape);
  for (const double frame : {0.0, 4.5, 10.0}) {
    DeformedVertices vertices;
    deform(compiled.scene, frame, vertices);
    ASSERT_EQ(vertices.positions.size(), mesh.positions.size());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      // p' = (1 - w) p + w (j + R (p - j)), with the joint j = (0, 1, 0) and R the turn by 9° a frame.
      const Vec3 p(mesh.positions[i]), joint(0, 1, 0);
      const double w = test::share_of_second(p.y);
      const Vec3 bent = (1 - w) * p + w * (joint + turned_about_z(p - joint, 9 * frame));
      expect_near_to(Vec3(vertices.positions[i]), bent, kFloat);
      // Where one bone alone moves a vertex its normal turns with it.
      if (w == 0 || w == 1)
        expect_near_to(Vec3(vertices.normals[i]), turned_about_z(Vec3(mesh.normals[i]), w * 9 * frame),
                       kFloat);
      EXPECT_NEAR(glm::length(Vec3(vertices.normals[i])), 1, kFloat);
    }
  }
}

TEST(Deform, NormalsGoWithTheInverseTransposeOfTheBlendedMatrix) {
  // One joint shears: x' = x + 2 y. A plane x + y = const has the normal (1, 1, 0); in the new coordinates x
  // = x' - 2 y', so it is x' - y' = const, with the normal (1, -1, 0).
  MeshShape mesh;
  mesh.smoothing = Smoothing::phong;
  mesh.positions = {{0, 0, 0}, {1, -1, 0}, {0, 0, 1}};
  mesh.normals.assign(3, glm::vec3(1, 1, 0));
  mesh.triangles = mesh.triangle_normals = {{0, 1, 2}};
  const auto skin = std::make_shared<DeformationDescription>();
  skin->skeleton = 0;
  skin->joints = {{0, {}}};
  skin->influences = 1;
  skin->joint_of = {0, 0, 0};
  skin->weights = {0.7f, 2, 1e-3f};  // one joint alone counts whole, whatever its weight
  mesh.deformation = skin;
  SceneDescription description = test::make_scene_of({mesh});
  TransformStep shear;
  shear.kind = TransformKind::matrix;
  shear.curve = {Interpolation::linear, {0, 1}, {Vec4(0), Vec4(0)}};
  shear.matrix.linear[1] = Vec3(2, 1, 0);
  description.skeletons.push_back({{{kNone, {shear}}}, {}});
  const CompiledScene compiled = compile(description);
  DeformedVertices vertices;
  deform(compiled.scene, 0, vertices);
  expect_near_to(Vec3(vertices.positions[1]), Vec3(-1, -1, 0), 0);
  for (const glm::vec3& n : vertices.normals) expect_near_to(Vec3(n), normalized(Vec3(1, -1, 0)), kFloat);
  // Flattened by a matrix without an inverse, z' = 0, all planes but those across z are edge-on: x + z =
  // const has the normal (1, 0, 1), of which (0, 0, 1) is left.
  auto& mesh_again = std::get<MeshShape>(description.objects[1].primitives[0].shape);
  mesh_again.normals.assign(3, glm::vec3(1, 0, 1));
  description.skeletons[0].bones[0].transform[0].matrix.linear = Mat3(1, 0, 0, 0, 1, 0, 0, 0, 0);
  const CompiledScene flat = compile(description);
  deform(flat.scene, 0, vertices);
  for (const glm::vec3& n : vertices.normals) expect_near_to(Vec3(n), Vec3(0, 0, 1), kFloat);
}

TEST(Deform, TargetsComeBeforeTheSkin) {
  // The target lifts the vertex by 1 along y, the bone turns by 90° about z: (x, y) to (-(y + 1), x).
  MeshShape mesh;
  mesh.positions = {{1, 0, 0}, {2, 0, 0}, {1, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  const auto deformation = std::make_shared<DeformationDescription>();
  deformation->skeleton = 0;
  deformation->joints = {{0, {}}};
  deformation->influences = 1;
  deformation->joint_of = {0, 0, 0};
  deformation->weights = {1, 1, 1};
  deformation->targets = {{{Interpolation::linear, {0, 4}, {Vec4(0), Vec4(1)}}, {{1, {0, 0.5f, 0}, {}}}},
                          {constant_curve(Vec4(0.5)), {{1, {0, 1, 0}, {}}, {0, {0, 2, 0}, {}}}}};
  mesh.deformation = deformation;
  SceneDescription description = test::make_scene_of({mesh});
  description.skeletons.push_back({{{kNone, {test::bend(90, 4)}}}, {}});
  const CompiledScene compiled = compile(description);
  DeformedVertices vertices;
  deform(compiled.scene, 4, vertices);
  expect_near_to(Vec3(vertices.positions[0]), Vec3(-1, 1, 0), kFloat);
  expect_near_to(Vec3(vertices.positions[1]), Vec3(-1, 2, 0), kFloat);
  expect_near_to(Vec3(vertices.positions[2]), Vec3(0, 1, 1), kFloat);
}

TEST(Deform, FramesFindWhatBruteForceFindsOnEveryTarget) {
  for (const SceneDescription& description :
       {test::make_bulging_tube(20, 12), test::make_scrambled(20, 12)}) {
    const CompiledScene compiled = compile(description);
    FrameState state(compiled.scene);
    test::on_every_target([&] {
      for (const int frame : {0, 5, 10}) {
        const Pose pose = state.at(frame);
        std::mt19937 random(11);
        int hits = 0;
        for (int n = 0; n < 60; ++n) {
          std::vector<Ray> rays;
          const Vec3 eye(0.5, 1, 6);
          const Vec3 to = test::random_point(random, 1.2) + Vec3(-0.5, 1, 0);
          for (size_t i = 0; i < kMostPacketRays; ++i)
            rays.push_back({eye, to + test::random_point(random, 0.1) - eye});
          std::array<Hit, kMostPacketRays> packet;
          closest_hits(compiled.scene, pose, RayPacket(rays), packet.data());
          const uint32_t any = any_hits(compiled.scene, pose, RayPacket(rays));
          for (size_t i = 0; i < rays.size(); ++i) {
            const Hit slow = closest_hit_brute_force(compiled.scene, pose, rays[i]),
                      fast = closest_hit(compiled.scene, pose, rays[i]);
            for (const Hit& hit : {fast, packet[i]}) {
              ASSERT_EQ(hit.t, slow.t);
              ASSERT_EQ(hit.instance, slow.instance);
              ASSERT_EQ(hit.primitive.bits, slow.primitive.bits);
            }
            ASSERT_EQ(any >> i & 1, slow.is_hit() ? 1u : 0u);
            hits += slow.is_hit() && pose[slow.instance].is_deformed ? 1 : 0;
          }
        }
        EXPECT_GT(hits, 60) << frame;
      }
    });
  }
}

TEST(Deform, PicturesAreThoseOfMeshesCompiledForTheFrame) {
  for (const bool is_scrambled : {false, true}) {
    const SceneDescription description =
        is_scrambled ? test::make_scrambled(20, 12) : test::make_bulging_tube(20, 12);
    const CompiledScene compiled = compile(description);
    std::vector<std::byte> last;
    for (const int frame : {0, 7, 10}) {
      const CompiledScene still = compile(frozen(description, compiled.scene, frame));
      EXPECT_TRUE(still.scene.deforming_parts.empty());
      for (const LightingModel model : {LightingModel::whitted, LightingModel::path}) {
        const std::vector<std::byte> picture = frame_of(compiled.scene, frame, model);
        EXPECT_EQ(picture, frame_of(still.scene, frame, model)) << frame;
        if (model != LightingModel::path) continue;
        EXPECT_NE(picture, last);
        last = picture;
      }
    }
  }
}

TEST(Deform, GouraudAndCenterNormalsFollow) {
  for (const Smoothing smoothing : {Smoothing::gouraud, Smoothing::center, Smoothing::flat}) {
    SceneDescription description = test::make_bulging_tube(12, 8);
    std::get<MeshShape>(description.objects[1].primitives[0].shape).smoothing = smoothing;
    const CompiledScene compiled = compile(description);
    const CompiledScene still = compile(frozen(description, compiled.scene, 6));
    EXPECT_EQ(frame_of(compiled.scene, 6), frame_of(still.scene, 6));
  }
}

TEST(Deform, TreesAreRebuiltWhereRefittingMadeThemBad) {
  const CompiledScene bent = compile(test::make_bulging_tube(40, 16)),
                      scrambled = compile(test::make_scrambled(40, 16));
  DeformedParts bent_parts(bent.scene), scrambled_parts(scrambled.scene);
  for (const double frame : {0.0, 2.0, 10.0, 1.0}) {
    bent_parts.set(frame);
    scrambled_parts.set(frame);
  }
  EXPECT_EQ(bent_parts.builds(), 0u);
  EXPECT_GT(scrambled_parts.builds(), 0u);
  // Whatever it was refitted or built for before, a frame's picture is the same.
  RenderSettings settings = test::picture_settings(48, 36, LightingModel::whitted);
  Renderer wandering(scrambled.scene, settings);
  for (const int frame : {0, 10, 3, 9, 0, 3})
    EXPECT_EQ(wandering.render(frame, settings.crop, [] {}).pixels, frame_of(scrambled.scene, frame))
        << frame;
}

TEST(Deform, PartsThatStayGoodMoveTogetherWithThoseBuiltAnew) {
  SceneDescription description = test::make_scrambled(40, 16);
  SceneDescription tube = test::make_bulging_tube(10, 8);
  for (int i = 0; i < 2; ++i) {  // before and behind the scrambled one
    description.objects.push_back(tube.objects[1]);
    description.objects[0].children.push_back(
        {static_cast<uint32_t>(description.objects.size() - 1),
         {test::still_step(TransformKind::translate, Vec3(i == 0 ? -1.5 : 1.5, 0, 0))},
         {},
         {}});
  }
  std::swap(description.objects[1], description.objects[2]);
  description.skeletons = tube.skeletons;
  const CompiledScene compiled = compile(description);
  ASSERT_EQ(compiled.scene.deforming_parts.size(), 3u);
  DeformedParts parts(compiled.scene);
  parts.set(10);
  EXPECT_EQ(parts.builds(), 1u);
  EXPECT_EQ(frame_of(compiled.scene, 10),
            frame_of(compile(frozen(description, compiled.scene, 10)).scene, 10));
}

TEST(Deform, CopiesStandWhereTheirObjectsPutThem) {
  SceneDescription description = test::make_bulging_tube(12, 8);
  TransformStep glide;
  glide.curve = {Interpolation::linear, {0, 10}, {Vec4(1, 0, 0, 0), Vec4(1.5, 0.5, -1, 0)}};
  description.objects[0].children.push_back(
      {1, {test::still_step(TransformKind::scale, Vec3(0.5, 0.7, -0.6)), glide}, {}, {}});
  description.objects[0].children.push_back({1,
                                             {test::still_step(TransformKind::translate, Vec3(-1.2, 0, 0))},
                                             {},
                                             Curve{Interpolation::step, {0, 5}, {Vec4(0), Vec4(1)}}});
  const CompiledScene compiled = compile(description);
  EXPECT_EQ(compiled.scene.deforming_parts.size(), 1u) << "copies share what they are";
  EXPECT_EQ(compiled.scene.instances.size(), 4u);
  for (const int frame : {3, 8})
    EXPECT_EQ(
        frame_of(compiled.scene, frame, LightingModel::path),
        frame_of(compile(frozen(description, compiled.scene, frame)).scene, frame, LightingModel::path));
}

TEST(Deform, EveryHierarchyAndEveryWayToTraceShowsTheSame) {
  const SceneDescription description = test::make_bulging_tube(12, 8);
  const std::vector<std::byte> usual = frame_of(compile(description).scene, 6);
  for (const Hierarchy hierarchy :
       {Hierarchy::thesis, Hierarchy::regular, Hierarchy::adaptive, Hierarchy::object, Hierarchy::brute}) {
    const CompiledScene compiled = compile(description, {.hierarchy = hierarchy});
    EXPECT_EQ(frame_of(compiled.scene, 6), usual);
    EXPECT_NE(test::notes_of(compiled).find("whatever hierarchy was asked for"), std::string::npos);
  }
  EXPECT_EQ(frame_of(compile(description, {.has_last_hit = true, .ray_coherence = 5}).scene, 6), usual);
  RenderSettings settings = test::picture_settings(48, 36, LightingModel::whitted);
  limit_by_depth(settings, 3);
  settings.item_buffer = ItemBuffer::bound;
  settings.light_cells = 8;
  const CompiledScene compiled = compile(description);
  EXPECT_EQ(Renderer(compiled.scene, settings).render(6, settings.crop, [] {}).pixels, usual);
}

TEST(Deform, LastHitsOfOtherFramesDoNoHarm) {
  const CompiledScene compiled = compile(test::make_scrambled(40, 16), {.has_last_hit = true}),
                      plain = compile(test::make_scrambled(40, 16));
  RenderSettings settings = test::picture_settings(48, 36, LightingModel::whitted);
  Renderer remembering(compiled.scene, settings);
  for (const int frame : {0, 10, 0})
    EXPECT_EQ(remembering.render(frame, settings.crop, [] {}).pixels, frame_of(plain.scene, frame));
}

TEST(Deform, ZonesLieOnTheFramesShape) {
  const SceneDescription description = test::make_bulging_tube(12, 8);
  const CompiledScene compiled = compile(description),
                      still = compile(frozen(description, compiled.scene, 6));
  RenderSettings settings = test::picture_settings(8, 6, LightingModel::radiosity);
  settings.zones.size = 0.3;
  const ZoneScene zones(compiled.scene, settings, 6), same(still.scene, settings, 6);
  ASSERT_EQ(zones.map().cell_count(), same.map().cell_count());
  std::vector<double> areas, same_areas;
  for (const auto& [map, list] : {std::pair(&zones.map(), &areas), std::pair(&same.map(), &same_areas)}) {
    for (const ZoneGrid& grid : map->grids())
      for (uint32_t cell = 0; grid.primitive != kNoPrimitive && cell < grid.cell_count; ++cell)
        list->push_back(map->area(grid, cell));
    std::sort(list->begin(), list->end());
  }
  EXPECT_EQ(areas, same_areas);
}

TEST(Deform, TheShutterSeesTheMotion) {
  constexpr int kTimes = 64;
  const SceneDescription description = test::make_bending_tube(12, 8);
  const CompiledScene compiled = compile(description);
  // Its picture is the mean of still ones of the moments, but for noise: far less than it differs from a
  // sharp one.
  const auto pixels_of = [](const std::vector<std::byte>& bytes) {
    std::vector<float> pixels(bytes.size() / sizeof(float));
    std::memcpy(pixels.data(), bytes.data(), bytes.size());
    return pixels;
  };
  const std::vector<float> blurred = pixels_of(frame_of(compiled.scene, 4, LightingModel::whitted, 2, 1024));
  std::vector<double> mean(blurred.size());
  for (int i = 0; i < kTimes; ++i) {
    const CompiledScene still = compile(frozen(description, compiled.scene, 4 + 2 * (i + 0.5) / kTimes));
    const std::vector<float> picture = pixels_of(frame_of(still.scene, 4, LightingModel::whitted, 0, 16));
    for (size_t k = 0; k < mean.size(); ++k) mean[k] += picture[k] / kTimes;
  }
  double difference = 0, contrast = 0;
  const std::vector<float> sharp = pixels_of(frame_of(compiled.scene, 4, LightingModel::whitted, 0, 16));
  for (size_t k = 0; k < mean.size(); ++k) {
    difference += std::abs(mean[k] - blurred[k]);
    contrast += std::abs(mean[k] - sharp[k]);
  }
  EXPECT_LT(difference, 0.15 * contrast);
}

TEST(Deform, AFrameHoldsOnlyWhatChanges) {
  SceneDescription description = test::make_bending_tube(50, 40);
  MeshShape large = test::make_tube(200, 100);
  description.objects[0].primitives.push_back({std::move(large), 0, {}});
  const CompiledScene compiled = compile(description);
  FrameState state(compiled.scene);
  const Pose pose = state.at(3);
  for (uint32_t i = 0; i < compiled.scene.instances.size(); ++i) {
    const Scene& shapes = pose.shape_of(i, compiled.scene);
    EXPECT_EQ(&shapes == &compiled.scene, compiled.scene.instances[i].part != 0);
  }
  // Of 3920 triangles: 40 bytes each are those of a full block's lane.
  EXPECT_LT(deformed_bytes(compiled.scene), 3920 * 120u);
  EXPECT_GT(deformed_bytes(compiled.scene), 3920 * 40u);
  EXPECT_LT(deformed_bytes(compiled.scene), compiled.block.size / 8);
}

TEST(Deform, SkinsThatNeverMoveAreStill) {
  SceneDescription description = test::make_bending_tube(9, 8);
  description.skeletons[0].bones[1].transform[0].curve = constant_curve(Vec4(90, 0, 0, 0));
  const CompiledScene compiled = compile(description);
  EXPECT_TRUE(compiled.scene.deforming_parts.empty());
  EXPECT_TRUE(compiled.scene.moving_instances.empty());
  SceneDescription moving = test::make_bending_tube(9, 8);
  EXPECT_EQ(frame_of(compiled.scene, 0), frame_of(compile(moving).scene, 10));
}

TEST(Deform, VerticesThatAreNowhereAreAnError) {
  SceneDescription description = test::make_bending_tube(9, 8);
  description.skeletons[0].bones[0].transform = {test::still_step(TransformKind::scale, Vec3(1e39))};
  EXPECT_THROW(compile(description), InputError);
  description.skeletons[0].bones[0].transform[0].curve = {
      Interpolation::linear, {0, 10}, {Vec4(1), Vec4(1e39, 1, 1, 0)}};
  const CompiledScene compiled = compile(description);
  FrameState state(compiled.scene);
  EXPECT_NO_THROW(state.at(0));
  EXPECT_THROW(state.at(10), std::domain_error);
  EXPECT_NO_THROW(state.at(1));
}

TEST(Deform, LampsThatChangeTheirShapeShineByChance) {
  SceneDescription description = test::make_bending_tube(9, 8);
  description.materials[1] = MaterialDescription("glow");
  description.materials[1].kind = MaterialKind::luminaire;
  description.materials[1].emission = Color(3);
  const CompiledScene compiled = compile(description);
  EXPECT_EQ(compiled.scene.head().first_luminaire, compiled.scene.lights.size());
  EXPECT_NE(test::notes_of(compiled).find("shines but is no lamp"), std::string::npos);
  EXPECT_NE(frame_of(compiled.scene, 0, LightingModel::path),
            frame_of(compiled.scene, 9, LightingModel::path));
}

}  // namespace
}  // namespace rayfarm
