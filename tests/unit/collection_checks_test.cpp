// What is refused in the hierarchies of a scene block.
#include <cmath>

#include "common/hierarchy/traverser.h"
#include "tests/unit/damaged_scene.h"

namespace rayfarm {
namespace {

using test::expect_refusal;

TEST(CollectionChecks, TreesAreNoDeeperThanATraverserCanGoAndNoNodeHasTwoParents) {
  const CompiledScene compiled =
      compile(test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"));
  ASSERT_TRUE(compiled.scene.nodes.empty());
  // The part's one leaf below a chain of nodes, each of which leads to the next `ways` times.
  const auto encode_chain = [&](uint32_t count, size_t ways) {
    LargeVector<VolumeNode> nodes(count, make_empty_node());
    Part part = compiled.scene.parts[0];
    for (uint32_t i = 0; i < count; ++i)
      for (size_t slot = 0; slot < (i + 1 < count ? ways : 1); ++slot)
        set_child(nodes[i], slot, part.collection.bounds,
                  i + 1 < count ? make_child(ChildKind::inner, i + 1) : part.collection.root);
    part.collection.root = make_child(ChildKind::inner, 0);
    Scene scene = compiled.scene;
    scene.nodes = nodes;
    scene.parts = std::span(&part, 1);
    return encode_scene(scene);
  };
  const SceneBlock deepest = encode_chain(kMostHierarchyLevels - 1, 1);
  const Scene scene = decode_scene(deepest.bytes());
  FrameState state(scene);
  EXPECT_TRUE(closest_hit(scene, state.at(0), {{0, 0, 5}, {0, 0, -1}}).is_hit());
  EXPECT_THROW(decode_scene(encode_chain(kMostHierarchyLevels, 1).bytes()), SceneBlockError);
  EXPECT_THROW(decode_scene(encode_chain(10, 2).bytes()), SceneBlockError) << "2^10 ways to one leaf";
}

TEST(CollectionChecks, ListsAndGridsThatWouldReadOutsideAreRefused) {
  const CompiledScene compiled = test::compile_everything();
  expect_refusal<Collection>(
      compiled, &Scene::collections,
      [](Collection& c) { return c.grid = 7, c.structure == Structure::regular; }, "a collection of no grid");
  expect_refusal<Collection>(
      compiled, &Scene::collections, [](Collection& c) { return c.leaf_primitive_count = 1u << 30, true; },
      "a collection of more primitives than there are");
  expect_refusal<PrimitiveId>(
      compiled, &Scene::leaf_primitives,
      [](PrimitiveId& id) {
        return id.kind() == PrimitiveKind::collection && (id = make_primitive_id(id.kind(), 2), true);
      },
      "a collection in itself");
  expect_refusal<Collection>(
      compiled, &Scene::collections,
      [](Collection& c) {
        return c.leaf_primitive_count = 0,
               c.root.kind() != ChildKind::empty && c.structure == Structure::regular;
      },
      "a collection that reaches what is not its own");
  expect_refusal<Grid>(
      compiled, &Scene::grids, [](Grid& grid) { return grid.cells[1] = 0, true; }, "a grid without cells");
  expect_refusal<Grid>(
      compiled, &Scene::grids, [](Grid& grid) { return grid.cells[2] = 3, true; },
      "a grid of more cells than there are");
  expect_refusal<Grid>(
      compiled, &Scene::grids, [](Grid& grid) { return grid.cell.y = NAN, true; }, "a grid of no size");
  expect_refusal<uint32_t>(
      compiled, &Scene::grid_cells, [](uint32_t& end) { return end = 1000, true; },
      "a list that ends before it begins");
  expect_refusal<PrimitivePointer>(
      compiled, &Scene::primitive_pointers,
      [](PrimitivePointer& p) { return p = make_pointer(p.kind(), 1 << 20), true; }, "a pointer to nothing");
  expect_refusal<PrimitivePointer>(
      compiled, &Scene::primitive_pointers, [](PrimitivePointer& p) { return p.bits = 3u << 30, true; },
      "a pointer of no kind");
}

TEST(CollectionChecks, OctantsReachTheirOwnPrimitivesAlone) {
  const CompiledScene compiled = test::compile_everything();
  expect_refusal<Collection>(
      compiled, &Scene::collections,
      [](Collection& c) { return c.structure == Structure::octants && (c.octants = 1, true); },
      "octants that are not there");
  expect_refusal<Collection>(
      compiled, &Scene::collections,
      [](Collection& c) {
        return c.structure == Structure::regular && (c.structure = Structure::octants, c.grid = kNone, true);
      },
      "a collection without octants");
  expect_refusal<Collection>(
      compiled, &Scene::collections,
      [](Collection& c) {
        return c.structure == Structure::regular &&
               (c.structure = Structure::octants, c.grid = kNone, c.octants = 0, true);
      },
      "octants of two collections");
}

// A mailbox has room for these alone.
TEST(CollectionChecks, ListsReachTheirCollectionsPrimitivesAlone) {
  const CompiledScene compiled = test::compile_everything();
  for (const PointerKind kind : {PointerKind::triangle, PointerKind::sphere})
    expect_refusal<PrimitivePointer>(
        compiled, &Scene::primitive_pointers,
        [&](PrimitivePointer& p) {
          return p.kind() == kind && p.place() >= 8 && (p = make_pointer(kind, 0), true);
        },
        "another collection's primitive");
}

TEST(CollectionChecks, TreesOfObjectsThatAWalkWouldNotEndInAreRefused) {
  const CompiledScene compiled = test::compile_everything();
  const auto refuse_node = [&](const std::function<bool(BoundingNode&)>& damage, const char* what) {
    expect_refusal<BoundingNode>(compiled, &Scene::bounding_nodes, damage, what);
  };
  expect_refusal<Collection>(
      compiled, &Scene::collections,
      [](Collection& c) { return c.structure == Structure::object && (c.tree = kNone, true); }, "no tree");
  expect_refusal<Collection>(
      compiled, &Scene::collections, [](Collection& c) { return c.tree != kNone && (c.tree = 9, true); },
      "a tree that is not there");
  expect_refusal<BoundingTree>(
      compiled, &Scene::bounding_trees, [](BoundingTree& t) { return t.root = 99, true; }, "no root");
  expect_refusal<BoundingTree>(
      compiled, &Scene::bounding_trees, [](BoundingTree& t) { return t.root += 1, true; },
      "a root below the root");
  expect_refusal<BoundingTree>(
      compiled, &Scene::bounding_trees, [](BoundingTree& t) { return t.order = ObjectOrder(7), true; },
      "no order");
  refuse_node([](BoundingNode& n) { return n.is_group() && (n.first_child = 0, true); }, "a group in itself");
  refuse_node([](BoundingNode& n) { return n.is_group() && (n.child_count = 1u << 30, true); },
              "a group of more than there are");
  refuse_node([](BoundingNode& n) { return n.volume_count = 1u << 20, true; }, "volumes that are not there");
  refuse_node([](BoundingNode& n) { return !n.is_group() && (n.instance = 0, true); },
              "another instance in a part's tree");
  refuse_node(
      [](BoundingNode& n) {
        return n.leaves[0].count() > 0 && (n.leaves[0] = make_child(ChildKind::triangles, 0, 1u << 20), true);
      },
      "more triangles than there are");
  refuse_node(
      [](BoundingNode& n) {
        return n.leaves[0].count() > 0 && (n.leaves[0] = make_child(ChildKind::inner, 0), true);
      },
      "a node of another hierarchy");
  refuse_node([](BoundingNode& n) { return !n.is_group() && (n.leaves = {}, true); }, "an object of nothing");
  expect_refusal<BoundingVolume>(
      compiled, &Scene::bounding_volumes, [](BoundingVolume& v) { return v.kind = VolumeKind(9), true; },
      "a volume of no kind");
  expect_refusal<BoundingVolume>(
      compiled, &Scene::bounding_volumes, [](BoundingVolume& v) { return v.numbers[2] = NAN, true; },
      "a volume of no place");
}

}  // namespace
}  // namespace rayfarm
