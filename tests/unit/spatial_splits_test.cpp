// Spatial splits (Stich, Friedrich, Dietrich 2009): what they keep, what they cost, and that no picture can
// tell them from whole primitives.
#include "common/hierarchy/spatial_splits.h"

#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "common/scene/references.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

constexpr std::array kQualities{BuildQuality::fast, BuildQuality::balanced, BuildQuality::high};

/// Prisms askew through a cube, of six long thin triangles each, among small triangles.
SceneDescription make_beams(uint32_t seed, int beams, int specks) {
  std::mt19937 random(seed);
  SceneDescription scene;
  scene.files = {"beams"};
  scene.materials.emplace_back("default");
  MeshShape mesh;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const Vec3& p : {a, b, c}) mesh.positions.emplace_back(p);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  };
  for (int i = 0; i < beams; ++i) {
    const Vec3 a = test::random_point(random, 1), along = test::random_point(random, 1);
    const Vec3 u = 0.01 * normalized(glm::cross(along, test::random_point(random, 1)));
    const Vec3 v = 0.01 * normalized(glm::cross(along, u));
    const std::array<Vec3, 3> corners{a + u, a - u + v, a - u - v};
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 &p = corners[k], &q = corners[(k + 1) % 3];
      add(p, q, p + along);
      add(q, q + along, p + along);
    }
  }
  for (int i = 0; i < specks; ++i) {
    const Vec3 center = test::random_point(random, 1);
    add(center + test::random_point(random, 0.02), center + test::random_point(random, 0.02),
        center + test::random_point(random, 0.02));
  }
  scene.objects.push_back({"beams", {{mesh, 0, {}}}, {}, {}});
  return scene;
}

bool says_that_high_gains_nothing(const CompiledScene& compiled) {
  const auto& lines = compiled.notes.lines();
  return std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
           return line.find("a high build gains nothing here") != std::string::npos;
         }) == 1;
}

Ray random_ray(std::mt19937& random) {
  Vec3 direction = test::random_point(random, 1);
  if (random() % 4 == 0) direction[static_cast<int>(random() % 3)] = 0;
  return {test::random_point(random, 1.5), normalized(direction)};
}

/// Each build answers as brute force does.
void compare_builds(const SceneDescription& description, int rays) {
  std::vector<CompiledScene> builds;
  for (const BuildQuality quality : kQualities) builds.push_back(compile(description, {.quality = quality}));
  ASSERT_LT(count_references(builds[0].scene), count_references(builds[1].scene)) << "nothing is divided";
  std::vector<std::unique_ptr<FrameState>> states;
  for (const CompiledScene& build : builds) states.push_back(std::make_unique<FrameState>(build.scene));
  std::mt19937 random(31);
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    const Ray ray = random_ray(random);
    const Hit slow = closest_hit_brute_force(builds[0].scene, states[0]->at(0), ray);
    hits += slow.is_hit();
    for (size_t k = 0; k < builds.size(); ++k) {
      const Pose pose = states[k]->at(0);
      const Hit hit = closest_hit(builds[k].scene, pose, ray);
      ASSERT_EQ(hit.is_hit(), slow.is_hit()) << "ray " << i << ", build " << k;
      EXPECT_EQ(any_hit(builds[k].scene, pose, ray), slow.is_hit());
      if (!hit.is_hit()) continue;
      ASSERT_EQ(hit.t, slow.t) << "ray " << i << ", build " << k;
      ASSERT_EQ(hit.primitive, slow.primitive);
      ASSERT_EQ(hit.instance, slow.instance);
    }
  }
  EXPECT_GT(hits, rays / 50);
}

TEST(SpatialSplits, EveryBuildAnswersAsBruteForce) {
  compare_builds(make_beams(1, 60, 500), 2000);
  SceneDescription mixed = test::make_mixed_scene(3, 1, 300);  // spheres, quadrics and polygons, too
  mixed.objects[0].primitives.push_back(make_beams(1, 60, 500).objects[0].primitives[0]);
  mixed.objects[0].primitives.push_back({ConeShape{Vec3(-1), Vec3(1, 0.9, 0.8), 0.02, 0.01}, 0, {}});
  mixed.objects[0].primitives.push_back({SphereShape{Vec3(0), 0.9}, 0, {}});
  compare_builds(mixed, 2000);
}

TEST(SpatialSplits, PartsThatMoveAreDividedInTheirOwnSpace) {
  SceneDescription scene = make_beams(2, 40, 100);
  scene.objects.push_back({"two", {}, {}, {}});
  scene.root = 1;
  for (const double degrees : {0.0, 40.0}) {
    ChildDescription child{0, {}, {}};
    Curve turn = constant_curve(Vec4(degrees, 0, 0, 0));
    turn.frames.push_back(10);
    turn.values.push_back(Vec4(degrees + 90, 0, 0, 0));
    child.transform.push_back({TransformKind::rotate, turn, Vec3(0, 1, 0), {}});
    scene.objects[1].children.push_back(child);
  }
  compare_builds(scene, 500);
}

TEST(SpatialSplits, ReferencesStayWithinTheBudgetAndRaysVisitLess) {
  // Stich et al., section 3: fewer boxes overlap; section 4.2: the budget bounds what is referred to twice.
  const SceneDescription description = make_beams(3, 300, 3000);
  std::vector<size_t> references;
  std::vector<uint64_t> visits;
  for (const BuildQuality quality : kQualities) {
    const CompiledScene compiled = compile(description, {.quality = quality});
    FrameState state(compiled.scene);
    references.push_back(count_references(compiled.scene));
    EXPECT_FALSE(says_that_high_gains_nothing(compiled));
    WalkCounts counts;
    std::mt19937 random(5);
    for (int i = 0; i < 1000; ++i)
      closest_hit_counted(compiled.scene, state.at(0), random_ray(random), counts);
    visits.push_back(counts.nodes + counts.leaves);
  }
  const double primitives = 6 * 300 + 3000;
  EXPECT_EQ(static_cast<double>(references[0]), primitives);
  EXPECT_GT(static_cast<double>(references[1]), 1.1 * primitives);
  EXPECT_LE(static_cast<double>(references[1]), 1.3 * primitives);
  EXPECT_GT(references[2], references[1]);
  EXPECT_LE(static_cast<double>(references[2]), 2 * primitives);
  EXPECT_LT(10 * visits[1], 8 * visits[0]);
  EXPECT_LT(visits[2], visits[1]);
}

TEST(SpatialSplits, SmoothMeshesAreBuiltAsIfThereWereNone) {
  SceneDescription scene;
  scene.files = {"hills"};
  scene.materials.emplace_back("default");
  MeshShape mesh;
  constexpr uint32_t kSide = 60;
  for (uint32_t i = 0; i <= kSide; ++i)
    for (uint32_t j = 0; j <= kSide; ++j)
      mesh.positions.emplace_back(i, 3 * std::sin(0.2 * i) * std::cos(0.15 * j), j);
  for (uint32_t i = 0; i < kSide; ++i)
    for (uint32_t j = 0; j < kSide; ++j) {
      const uint32_t a = i * (kSide + 1) + j, b = a + kSide + 1;
      mesh.triangles.emplace_back(a, b, a + 1);
      mesh.triangles.emplace_back(a + 1, b, b + 1);
    }
  scene.objects.push_back({"hills", {{mesh, 0, {}}}, {}, {}});
  const CompiledScene fast = compile(scene, {.quality = BuildQuality::fast});
  for (const BuildQuality quality : {BuildQuality::balanced, BuildQuality::high}) {
    const CompiledScene compiled = compile(scene, {.quality = quality});
    EXPECT_EQ(says_that_high_gains_nothing(compiled), quality == BuildQuality::high);
    ASSERT_EQ(compiled.block.bytes().size(), fast.block.bytes().size());
    EXPECT_TRUE(
        std::equal(compiled.block.bytes().begin(), compiled.block.bytes().end(), fast.block.bytes().begin()));
  }
}

TEST(SpatialSplits, TheThesisRuleSaysThatItTakesNone) {
  const CompiledScene compiled =
      compile(make_beams(4, 5, 5), {.hierarchy = Hierarchy::thesis, .quality = BuildQuality::high});
  ASSERT_FALSE(compiled.notes.lines().empty());
  EXPECT_NE(compiled.notes.lines().back().find("changes nothing here"), std::string::npos);
}

/// Triangles as a builder sees them.
class Triangles : public PrimitiveSource {
 public:
  explicit Triangles(int count) {
    std::mt19937 random(6);
    for (int i = 0; i < 3 * count; ++i) corners_.push_back(test::random_point(random, 1));
  }
  size_t size() const override { return corners_.size() / 3; }
  Box bounds(uint32_t i) const override {
    Box box;
    for (const Vec3& p : corners(i)) box.grow(p);
    return box;
  }
  Box clipped(uint32_t i, const Box& cell) const override { return clipped_bounds(corners(i), cell); }
  std::span<const Vec3> corners(uint32_t i) const { return std::span(corners_).subspan(3 * i, 3); }

 private:
  std::vector<Vec3> corners_;
};

TEST(SpatialSplits, NoPointOfATriangleIsLostAtAPlane) {
  const Triangles source(100);
  std::vector<PrimitiveReference> whole;
  for (uint32_t i = 0; i < source.size(); ++i) whole.push_back(make_reference(i, source.bounds(i)));
  const SpatialSplits splits(source, BuildQuality::high, whole);
  EXPECT_EQ(splits.budget(), whole.size());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit;
  for (int axis = 0; axis < 3; ++axis)
    for (const size_t most_added : {size_t{0}, size_t{10}, whole.size()}) {
      std::vector<PrimitiveReference> parted = whole;
      parted.resize(whole.size() + most_added);
      const auto sides =
          splits.divide(parted.data(), whole.size(), {.axis = axis, .position = 0.1f}, most_added);
      const size_t count = sides.left + sides.right;
      EXPECT_GE(count, whole.size());
      EXPECT_LE(count, whole.size() + most_added);
      parted.resize(count);
      for (uint32_t i = 0; i < source.size(); ++i)
        for (int n = 0; n < 20; ++n) {
          const auto corners = source.corners(i);
          const double u = unit(random), v = unit(random) * (1 - u);
          const Vec3 p = u * corners[0] + v * corners[1] + (1 - u - v) * corners[2];
          EXPECT_TRUE(std::any_of(parted.begin(), parted.end(), [&](const PrimitiveReference& r) {
            if (r.primitive != i) return false;
            const Box box = r.box();
            return glm::all(glm::lessThanEqual(box.lo - 1e-12, p)) &&
                   glm::all(glm::lessThanEqual(p, box.hi + 1e-12));
          }));
        }
    }
}

}  // namespace
}  // namespace rayfarm
