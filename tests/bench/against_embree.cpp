// Rayfarm's hierarchy against Embree's and tinybvh's, one ray at a time: the same rays through the same
// triangles and spheres, in one process and one thread, in short chunks that alternate, so that both meet the
// same noise. Only the ratios of thread CPU time mean something.
//
//   against_embree [--benchmark_...] [--simd=TARGET] SCENE...
//
// For every scene: primary, diffuse and shadow rays (ray_sets.h); then the time and memory of the build.
// tinybvh takes part if CMake was told where its header lies.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdlib>
#include <functional>

#include "embree_scene.h"
#include "tinybvh_scene.h"

namespace {

using namespace rayfarm;
using namespace rayfarm::bench;

constexpr size_t kChunk = 2048;  // rays
/// Rays on edges may be counted differently, since the others' hits are in float; more than this is a
/// mistake.
constexpr double kMostHitsDiffer = 1e-2;

/// Traces rays [begin, end) and counts hits.
using Tracer = std::function<size_t(size_t begin, size_t end)>;

void compare_rays(benchmark::State& state, size_t rays, const Tracer& ours, const Tracer& theirs) {
  struct Side {
    const Tracer& trace;
    double took_s = 0;
    size_t hits = 0;
    void run(size_t begin, size_t end) {
      const double start = thread_cpu_s();
      hits += trace(begin, end);
      took_s += thread_cpu_s() - start;
    }
  };
  Side us{ours}, them{theirs};
  size_t traced = 0, chunk = 0;
  for (auto _ : state) {
    const double before = us.took_s + them.took_s;
    for (size_t begin = 0; begin < rays; begin += kChunk, ++chunk) {
      const size_t end = std::min(rays, begin + kChunk);
      if (chunk % 2 == 0) us.run(begin, end);
      them.run(begin, end);
      if (chunk % 2 == 1) us.run(begin, end);
    }
    traced += rays;
    state.SetIterationTime(us.took_s + them.took_s - before);
  }
  state.counters["ratio"] = them.took_s / us.took_s;
  state.counters["rayfarm_Mray/s"] = 1e-6 * static_cast<double>(traced) / us.took_s;
  state.counters["other_Mray/s"] = 1e-6 * static_cast<double>(traced) / them.took_s;
  const double differing =
      std::abs(static_cast<double>(us.hits) - static_cast<double>(them.hits)) / static_cast<double>(traced);
  state.counters["hits_differ"] = differing;
  if (differing > kMostHitsDiffer) state.SkipWithError("the two do not hit the same");
}

/// Another program's hierarchy over a scene: made where it is needed first, then kept.
template <typename Hierarchy>
class Peer {
 public:
  explicit Peer(std::function<std::unique_ptr<Hierarchy>()> make) : make_(std::move(make)) {}
  Hierarchy& get() {
    if (!made_) made_ = make_();
    return *made_;
  }

 private:
  std::function<std::unique_ptr<Hierarchy>()> make_;
  std::unique_ptr<Hierarchy> made_;
};

void compare_with_embree(benchmark::State& state, const Subject& subject, const RaySet& set,
                         const EmbreeScene& embree, bool in_packets) {
  const std::vector<RTCRay> rays = embree_rays(set);
  const auto trace_ours = in_packets ? &trace_packets : &trace;
  const Pose pose = subject.frame->at(0);
  compare_rays(
      state, rays.size(),
      [&](size_t begin, size_t end) { return trace_ours(subject.scene(), pose, set, begin, end); },
      [&](size_t begin, size_t end) { return embree.trace(set, rays, begin, end); });
}

/// What keeps a scene from being traced by tinybvh; empty if nothing does.
std::string obstacle_to_tinybvh(const Scene& scene) {
  if (TinyBvhScene::version().empty())
    return "built without it (cmake -DRAYFARM_TINYBVH=FOLDER, where tiny_bvh.h lies)";
  if (!TinyBvhScene::is_available()) return "this machine has not AVX2 and FMA";
  if (scene.instances.size() != 1 || !scene.poses[0].is_identity) return "it takes one part at rest";
  const Part& part = scene.parts[scene.instances[0].part];
  return part.sphere_count + part.quadric_count > 0 ? "it takes triangles" : "";
}

std::vector<TinyBvhRay> tinybvh_rays(const RaySet& set) {
  const auto floats = [](const Vec3& v) {
    return std::array{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  std::vector<TinyBvhRay> rays;
  for (const Ray& ray : set.rays) {
    const double length = glm::length(ray.direction);
    rays.push_back(
        {floats(ray.origin), floats(ray.direction / length), static_cast<float>(ray.t_max * length)});
  }
  return rays;
}

void compare_with_tinybvh(benchmark::State& state, const Subject& subject, const RaySet& set,
                          TinyBvhScene& tinybvh) {
  tinybvh.set_rays(tinybvh_rays(set));
  const Pose pose = subject.frame->at(0);
  compare_rays(
      state, set.rays.size(),
      [&](size_t begin, size_t end) { return trace(subject.scene(), pose, set, begin, end); },
      [&](size_t begin, size_t end) {
        return set.is_any_hit ? tinybvh.trace_any(begin, end) : tinybvh.trace_closest(begin, end);
      });
}

/// CPU time of all threads, and bytes per primitive, of the volume hierarchies.
void compare_builds(benchmark::State& state, const Subject& subject) {
  double ours_s = 0, theirs_s = 0;
  double their_bytes = 0;
  for (auto _ : state) {
    const double start = cpu_s();
    const CompiledScene compiled = compile(subject.description);
    const double took_s = cpu_s() - start;
    ours_s += took_s;
    const EmbreeScene embree(compiled.scene, RTC_SCENE_FLAG_NONE);
    theirs_s += embree.build_cpu_s();
    their_bytes = static_cast<double>(embree.bytes());
    state.SetIterationTime(took_s + embree.build_cpu_s());
  }
  const Scene& scene = subject.scene();
  size_t primitives = 0;
  for (const Part& part : scene.parts) primitives += part.primitive_count();
  const double our_bytes =
      static_cast<double>(scene.nodes.size_bytes() + scene.triangle_blocks.size_bytes() +
                          scene.sphere_blocks.size_bytes() + scene.leaf_primitives.size_bytes());
  state.counters["time_ratio"] = ours_s / theirs_s;  // below 1: Rayfarm builds faster
  state.counters["rayfarm_s"] = ours_s / static_cast<double>(state.iterations());
  state.counters["embree_s"] = theirs_s / static_cast<double>(state.iterations());
  state.counters["rayfarm_bytes"] = our_bytes / static_cast<double>(primitives);
  state.counters["embree_bytes"] = their_bytes / static_cast<double>(primitives);
}

template <typename Function>
benchmark::internal::Benchmark* add(const std::string& name, Function function) {
  return benchmark::RegisterBenchmark(name.c_str(), function)->UseManualTime()->Unit(benchmark::kMillisecond);
}

void add_benchmarks(const Subject& subject) {
  const Scene& scene = subject.scene();
  const auto embree = [&](RTCSceneFlags flags) {
    return std::make_shared<Peer<EmbreeScene>>(
        [&, flags] { return std::make_unique<EmbreeScene>(scene, flags); });
  };
  const auto plain = embree(RTC_SCENE_FLAG_NONE), robust = embree(RTC_SCENE_FLAG_ROBUST);
  for (const RaySet& set : subject.sets)
    for (const auto& [mode, peer, in_packets] :
         {std::tuple{"default", plain, false}, {"robust", robust, false}, {"packets", plain, true}})
      add(fmt::format("{}/{}/{}", subject.name, set.name, mode),
          [&, peer = peer, in_packets = in_packets](benchmark::State& state) {
            compare_with_embree(state, subject, set, peer->get(), in_packets);
          });
  if (const std::string obstacle = obstacle_to_tinybvh(scene); !obstacle.empty()) {
    fmt::print(stderr, "against_embree: {}: without tinybvh: {}\n", subject.name, obstacle);
  } else {
    for (const auto& [mode, build] :
         {std::pair{"tinybvh", TinyBvhBuild::sah}, {"tinybvh_splits", TinyBvhBuild::spatial_splits}}) {
      const auto peer = std::make_shared<Peer<TinyBvhScene>>([&, build = build] {
        return std::make_unique<TinyBvhScene>(
            geometry_of(scene, scene.parts[scene.instances[0].part]).triangle_vertices, build);
      });
      for (const RaySet& set : subject.sets)
        add(fmt::format("{}/{}/{}", subject.name, set.name, mode),
            [&, peer](benchmark::State& state) { compare_with_tinybvh(state, subject, set, peer->get()); });
    }
  }
  add(subject.name + "/build", [&](benchmark::State& state) {
    compare_builds(state, subject);
  })->MinTime(5);  // a build is longer than a pass over the rays
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::vector<std::unique_ptr<Subject>> subjects;
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string argument = argv[i];
      if (argument.starts_with("--simd="))
        force_simd_target(argument.substr(7));
      else
        subjects.push_back(load_subject(argument));
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "against_embree: {}\n", e.what());
    return 1;
  }
  if (subjects.empty()) {
    fmt::print(stderr, "usage: against_embree [--benchmark_...] [--simd=TARGET] SCENE...\n");
    return 2;
  }
  if (const std::string version = TinyBvhScene::version(); !version.empty())
    benchmark::AddCustomContext("tinybvh", version);
  for (const auto& subject : subjects) add_benchmarks(*subject);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
