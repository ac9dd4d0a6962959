// Structures that scenes choose object by object, and collections in collections.
#include "common/hierarchy/traverser.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

/// Thirty balls, each in a group of five; {} stands for what a group's node has besides.
SceneDescription load_balls(const std::string& outer, const std::string& inner,
                            const std::string& innermost) {
  std::mt19937 random(3);
  const auto balls = [&](const std::string& indent) {
    std::string text;
    for (int i = 0; i < 10; ++i) {
      const Vec3 c = test::random_point(random, 1);
      text += fmt::format("{}- {{sphere: {{center: [{}, {}, {}], radius: 0.2}}}}\n", indent, c.x, c.y, c.z);
    }
    return text + indent + "- {polygon: {points: [[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]}}\n";
  };
  return test::load_yaml(test::view_text() + "scene:\n  - " + outer + "group:\n" + balls("      ") +
                         "      - " + inner + "group:\n" + balls("          ") + "          - " + innermost +
                         "group:\n" + balls("              "));
}

void expect_brute_force(const CompiledScene& compiled) {
  FrameState state(compiled.scene);
  std::mt19937 random(4);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    Ray ray{test::random_point(random, 2), normalized(test::random_point(random, 1))};
    const Hit slow = closest_hit_brute_force(compiled.scene, state.at(0), ray),
              fast = closest_hit(compiled.scene, state.at(0), ray);
    ASSERT_EQ(fast.t, slow.t);
    ASSERT_EQ(fast.primitive, slow.primitive);
    ASSERT_EQ(any_hit(compiled.scene, state.at(0), ray), slow.is_hit());
    hits += slow.is_hit() ? 1 : 0;
    if (!slow.is_hit()) continue;
    ray.t_max = slow.t;
    ASSERT_FALSE(any_hit(compiled.scene, state.at(0), ray));
  }
  EXPECT_GT(hits, 50);
}

// Shirley, Sung and Brown, 2.3: collections nest, "a grid in an octree in a list".
TEST(Structures, CollectionsNestInAnyOrder) {
  const std::vector<std::string> names{"sah",
                                       "thesis",
                                       "{regular: {cells: 4}}",
                                       "{adaptive: {max_primitives: 3, mailbox: true}}",
                                       "{thesis: {volumes: spheres, clip: always, max_primitives: 3}}",
                                       "brute",
                                       "{object: {bounds: sphere}}"};
  for (const std::string& outer : names)
    for (const std::string& inner : names)
      for (const std::string& innermost : names) {
        if (outer == inner || inner == innermost) continue;
        SCOPED_TRACE(outer + " " + inner + " " + innermost);
        const CompiledScene compiled =
            compile(load_balls("structure: " + outer + "\n    ", "structure: " + inner + "\n        ",
                               "structure: " + innermost + "\n            "));
        ASSERT_EQ(compiled.scene.parts.size(), 1u);
        EXPECT_EQ(compiled.scene.collections.size(), 3u);  // the root has a list of its own, of one
        EXPECT_EQ(compiled.scene.parts[0].sphere_count, 30u);
        expect_brute_force(compiled);
      }
}

TEST(Structures, AnObjectWithoutOneIsAsWhatItIsIn) {
  const CompiledScene compiled =
      compile(load_balls("name: a\n    ", "structure: regular\n        ", "name: b\n            "));
  ASSERT_EQ(compiled.scene.collections.size(), 1u);
  EXPECT_EQ(compiled.scene.collections[0].sphere_block_count, 3u);  // 20 of 30
  expect_brute_force(compiled);
}

/// What moves takes along all that is in it and has no transform of its own.
TEST(Structures, OfAnObjectThatMovesHoldAllThatIsInIt) {
  const CompiledScene compiled =
      compile(load_balls("structure: regular\n    transform: {translate: {0: [0, 0, 0], 4: [0, 0, 1]}}\n    ",
                         "name: a\n        ", "structure: brute\n            "));
  ASSERT_EQ(compiled.scene.parts.size(), 1u);
  EXPECT_EQ(compiled.scene.parts[0].collection.structure, Structure::regular);
  ASSERT_EQ(compiled.scene.collections.size(), 1u);
  expect_brute_force(compiled);
}

TEST(Structures, WhatArrangesNothingIsSaid) {
  const CompiledScene compiled = compile(test::load_yaml(
      test::view_text() +
      "objects: {ball: [{sphere: {center: [0, 0, 0], radius: 1}}]}\n"
      "scene:\n  - {use: ball}\n  - {use: ball, structure: regular, transform: {translate: [3, 0, 0]}}\n"));
  const std::vector<std::string> lines = compiled.notes.lines();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("arranges nothing"), lines[0].npos) << lines[0];
}

TEST(Structures, MistakesAreToldWithTheirPlaces) {
  const auto error_of = [](const std::string& structure) {
    try {
      test::load_yaml(test::view_text() + "scene:\n  - {structure: " + structure +
                      ", sphere: {center: [0, 0, 0], radius: 1}}\n");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error_of("octree").find("octree"), std::string::npos);
  EXPECT_NE(error_of("{regular: {cells: 0}}").find("cells"), std::string::npos);
  EXPECT_NE(error_of("{brute: {cells: 3}}").find("cells"), std::string::npos);
  EXPECT_NE(error_of("{sah: {}, thesis: {}}").find("one name"), std::string::npos);
  EXPECT_NE(error_of("{adaptive: {data: pointers, hash: 10}}").find("hash"), std::string::npos);
  EXPECT_NE(error_of("{adaptive: {next: up}}").find("next"), std::string::npos);
  EXPECT_NE(error_of("{adaptive: {depth: 21}}").find("depth"), std::string::npos);
  EXPECT_NE(error_of("{brute: {mailbox: true}}").find("mailbox"), std::string::npos);
  EXPECT_NE(error_of("{thesis: {volumes: balls}}").find("volumes"), std::string::npos);
  EXPECT_NE(error_of("{thesis: {clip: never}}").find("clip"), std::string::npos);
  EXPECT_NE(error_of("{thesis: {center: 3}}").find("center"), std::string::npos);
  EXPECT_NE(error_of("{thesis: {mailbox: true}}").find("mailbox"), std::string::npos);
  EXPECT_NE(error_of("{sah: {volumes: spheres}}").find("volumes"), std::string::npos);
  EXPECT_EQ(error_of("{thesis: {volumes: spheres, clip: always, center: volume, mailbox: true}}"), "");
  EXPECT_EQ(error_of("{adaptive: {max_primitives: 25, data: pointers, next: walk}}"), "");
  EXPECT_EQ(error_of("{adaptive: {depth: 7, hash: 10, next: dda, mailbox: false}}"), "");
  EXPECT_EQ(error_of("{regular: {mailbox: true}}"), "");
  EXPECT_EQ(error_of("{thesis: {max_primitives: 25}}"), "");
}

}  // namespace
}  // namespace rayfarm
