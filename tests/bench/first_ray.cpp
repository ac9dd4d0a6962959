// From a scene's name to its first ray, in a process that does nothing else: time of reading and of building,
// and the most memory; then Embree's build of the same geometry.
//
//   first_ray SCENE      prints one line of JSON: seconds of the clock and of all threads' CPU time, bytes a
//   primitive
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <functional>

#include "common/scene/camera.h"
#include "embree_scene.h"

namespace {

using namespace rayfarm;
using namespace rayfarm::bench;

struct Took {
  double s, cpu_s;
};

Took time_of(const std::function<void()>& work) {
  const double begin_cpu = cpu_s();
  const auto begin = std::chrono::steady_clock::now();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
          cpu_s() - begin_cpu};
}

/// The most memory that the process had so far.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: first_ray SCENE\n");
    return 2;
  }
  try {
    const double before_bytes = peak_bytes();
    SceneDescription description;
    CompiledScene compiled;
    bool is_hit = false;
    const Took load = time_of([&] { description = load_scene(argv[1]); });
    const Took build = time_of([&] { compiled = compile(description); });
    const Took first_ray = time_of([&] {
      FrameState frame(compiled.scene);
      is_hit = closest_hit(compiled.scene, frame.at(0), make_camera(compiled.scene, 0, 1, 1).ray(0.5, 0.5))
                   .is_hit();
    });
    const double most_bytes = peak_bytes() - before_bytes;
    size_t primitives = 0;
    for (const Part& part : compiled.scene.parts) primitives += part.primitive_count();
    const EmbreeScene embree(compiled.scene, RTC_SCENE_FLAG_NONE);
    fmt::print(
        R"({{"primitives": {}, "load_s": {}, "load_cpu_s": {}, "build_s": {}, "build_cpu_s": {}, "first_ray_s": {}, )"
        R"("is_hit": {}, "peak_bytes_each": {}, "embree_build_s": {}, "embree_build_cpu_s": {}}})"
        "\n",
        primitives, load.s, load.cpu_s, build.s, build.cpu_s, first_ray.s, is_hit,
        most_bytes / static_cast<double>(primitives), embree.build_s(), embree.build_cpu_s());
  } catch (const std::exception& e) {
    fmt::print(stderr, "first_ray: {}\n", e.what());
    return 1;
  }
  return 0;
}
