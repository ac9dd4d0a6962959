// What a new frame costs before its first ray: the poses of moving objects, the links to those that come and
// go, and the refit of the boxes over them (thesis, Table 4.6: "Obj/Vol Update"); of meshes that change their
// shape their vertices, and their volumes refitted or built anew.
#include <benchmark/benchmark.h>

#include <random>

#include "common/compile/compile.h"
#include "common/hierarchy/frame_state.h"
#include "common/lighting/frame_lights.h"
#include "tests/deforming_scene.h"

namespace {

using namespace rayfarm;

/// Spheres of a shared object, each on its own straight way; or each where it is, there in every other frame.
CompiledScene make_swarm(int64_t objects, bool comes_and_goes = false) {
  SceneDescription scene;
  scene.files = {"swarm"};
  scene.materials.emplace_back();
  ObjectDescription ball, root;
  ball.primitives.push_back({SphereShape{}, 0, {}});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-50, 50);
  for (int64_t i = 0; i < objects; ++i) {
    TransformStep step;
    step.kind = TransformKind::translate;
    step.curve.frames = {0, 100};
    for (int key = 0; key < 2; ++key)
      step.curve.values.emplace_back(place(random), place(random), place(random), 0);
    if (!comes_and_goes) {
      root.children.push_back({1, {step}, {}, {}});
      continue;
    }
    step.curve = constant_curve(step.curve.values[0]);
    Curve visible{Interpolation::step, {}, {}};
    for (int frame = 0; frame <= 100; ++frame) {
      visible.frames.push_back(frame);
      visible.values.emplace_back((frame + i) % 2, 0, 0, 0);
    }
    root.children.push_back({1, {step}, {}, visible});
  }
  scene.objects = {root, ball};
  scene.frames = {0, 100};
  return compile(scene);
}

void refit_frame(benchmark::State& state) {
  const CompiledScene compiled = make_swarm(state.range(0));
  FrameState pose(compiled.scene);
  double frame = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(pose.at(frame));
    frame = frame < 100 ? frame + 1 : 0;
  }
}
BENCHMARK(refit_frame)->Arg(10)->Arg(1000)->Arg(100000)->Unit(benchmark::kMicrosecond);

void links_frame(benchmark::State& state) {
  const CompiledScene compiled = make_swarm(state.range(0), true);
  const std::vector<LightPower> powers = light_powers(compiled.scene);
  FrameState pose(compiled.scene);
  double frame = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(pose.at(frame));
    benchmark::DoNotOptimize(make_frame_lights(compiled.scene, powers, frame));
    frame = frame < 100 ? frame + 1 : 0;
  }
}
BENCHMARK(links_frame)->Arg(10)->Arg(1000)->Arg(100000)->Unit(benchmark::kMicrosecond);

/// A bending tube of so many vertices, and twice as many triangles.
CompiledScene make_skinned(int64_t vertices) {
  return compile(test::make_bending_tube(static_cast<uint32_t>(vertices / 100), 100));
}

void skin_vertices(benchmark::State& state) {
  const CompiledScene compiled = make_skinned(state.range(0));
  DeformedVertices vertices;
  double frame = 0;
  for (auto _ : state) {
    deform(compiled.scene, frame, vertices);
    benchmark::DoNotOptimize(vertices.positions.data());
    frame = frame < 10 ? frame + 0.5 : 0;
  }
}
BENCHMARK(skin_vertices)->Arg(1000)->Arg(100000)->Unit(benchmark::kMillisecond);

/// With the vertices.
void refit_shape(benchmark::State& state) {
  const CompiledScene compiled = make_skinned(state.range(0));
  DeformedParts parts(compiled.scene);
  double frame = 0;
  for (auto _ : state) {
    parts.set(frame);
    frame = frame < 10 ? frame + 0.5 : 0;
  }
  state.counters["bytes"] = static_cast<double>(deformed_bytes(compiled.scene));
  state.counters["builds"] = static_cast<double>(parts.builds());
}
BENCHMARK(refit_shape)->Arg(1000)->Arg(100000)->Unit(benchmark::kMillisecond);

/// Without.
void build_shape(benchmark::State& state) {
  const CompiledScene compiled = make_skinned(state.range(0));
  DeformedVertices vertices;
  deform(compiled.scene, 5, vertices);
  for (auto _ : state) {
    LargeVector<VolumeNode> nodes;
    LargeVector<TriangleBlock> blocks;
    DeformingPart shape = compiled.scene.deforming_parts[0];
    benchmark::DoNotOptimize(build_deformed_part(compiled.scene, vertices, {}, shape, {nodes, blocks}));
  }
}
BENCHMARK(build_shape)->Arg(1000)->Arg(100000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
