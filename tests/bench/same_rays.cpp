// The rays of the experiment `hierarchies`, asked of Rayfarm's default hierarchy and of Embree, one at a time
// on one thread, in chunks that alternate. Writes a CSV file that the experiment reads.
//
//   same_rays OUT.csv SIDE_PX NAME=SCENE...
//
// SIDE_PX: of the square picture whose rays are recorded. Scenes that Embree can't take are left out, and
// said so.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include "embree_scene.h"
#include "host/experiments/hierarchies/hierarchy_runs.h"

namespace {

using namespace rayfarm;
using namespace rayfarm::bench;

constexpr size_t kChunk = 2048;
constexpr int kPasses = 5;

/// Embree's hits are in float: rays that begin on a surface would meet it again. Both are asked of rays that
/// begin a little later.
std::vector<Ray> lifted(const std::vector<Ray>& rays) {
  constexpr double kShare = 3e-5;  // of the origin's coordinates
  std::vector<Ray> result;
  for (Ray ray : rays) {
    const double t = kShare * std::max(1.0, max_magnitude(ray.origin)) / glm::length(ray.direction);
    if (t >= ray.t_max) continue;
    ray.origin += t * ray.direction;
    ray.t_max -= t;
    result.push_back(ray);
  }
  return result;
}

struct Times {
  double ours_s = 0, theirs_s = 0;
};

/// The least of some passes, chunk by chunk.
Times compare(const Scene& scene, const Pose& pose, const RaySet& set, const EmbreeScene& embree) {
  const std::vector<RTCRay> rays = embree_rays(set);
  Times times;
  size_t our_hits = 0, their_hits = 0;
  for (size_t begin = 0; begin < rays.size(); begin += kChunk) {
    const size_t end = std::min(rays.size(), begin + kChunk);
    double ours_s = std::numeric_limits<double>::infinity(), theirs_s = ours_s;
    for (int pass = 0; pass < kPasses; ++pass) {
      const double start = thread_cpu_s();
      const size_t ours = trace(scene, pose, set, begin, end);
      const double between = thread_cpu_s();
      const size_t theirs = embree.trace(set, rays, begin, end);
      ours_s = std::min(ours_s, between - start);
      theirs_s = std::min(theirs_s, thread_cpu_s() - between);
      if (pass == 0) our_hits += ours, their_hits += theirs;
    }
    times.ours_s += ours_s;
    times.theirs_s += theirs_s;
  }
  const double differing = std::abs(static_cast<double>(our_hits) - static_cast<double>(their_hits));
  if (differing > 0.02 * static_cast<double>(rays.size()) + 1)
    throw std::runtime_error(fmt::format("{} rays hit here, {} in Embree", our_hits, their_hits));
  return times;
}

std::string row_of(const std::string& name, const std::string& path, int side_px) {
  const SceneDescription description = load_scene(path);
  PictureRays rays = record_rays(description, side_px);
  rays.secondary = lifted(rays.secondary);
  rays.shadow = lifted(rays.shadow);
  const CompiledScene compiled = compile(description);
  FrameState state(compiled.scene);
  const Pose pose = state.at(0);
  const EmbreeScene embree(compiled.scene, RTC_SCENE_FLAG_NONE);
  Times sum;
  for (const auto& [kind, is_any] :
       {std::pair{&rays.eye, false}, std::pair{&rays.secondary, false}, std::pair{&rays.shadow, true}}) {
    const Times times = compare(compiled.scene, pose, {"", is_any, *kind, {}}, embree);
    sum.ours_s += times.ours_s;
    sum.theirs_s += times.theirs_s;
  }
  const double ns = 1e9 / static_cast<double>(std::max<size_t>(1, rays.size()));
  return fmt::format("{},{},{:.2f},{:.2f}\n", name, rays.size(), sum.ours_s * ns, sum.theirs_s * ns);
}

}  // namespace

int main(int argc, char** argv) {
  const int side_px = argc > 3 ? std::atoi(argv[2]) : 0;
  if (side_px < 1) {
    fmt::print(stderr, "usage: same_rays OUT.csv SIDE_PX NAME=SCENE...\n");
    return 2;
  }
  std::string text = "scene,rays,rayfarm_ns,embree_ns\n";
  for (int i = 3; i < argc; ++i) {
    const std::string argument = argv[i];
    const size_t equals = argument.find('=');
    if (equals == std::string::npos) {
      fmt::print(stderr, "same_rays: '{}' is not NAME=SCENE\n", argument);
      return 2;
    }
    try {
      text += row_of(argument.substr(0, equals), argument.substr(equals + 1), side_px);
    } catch (const std::exception& e) {
      fmt::print(stderr, "same_rays: without {}: {}\n", argument.substr(0, equals), e.what());
    }
  }
  std::ofstream out(argv[1]);
  out << text;
  if (!out.flush()) {
    fmt::print(stderr, "same_rays: {} can't be written\n", argv[1]);
    return 1;
  }
  return 0;
}
