// What it gives to remember what rays before have hit (--last-hit, --ray-coherence): Mray/s of whole pictures
// in Whitted's model on one thread, the best of five runs in turn, and counts of their rays traced one by
// one, each hit with a shadow ray to every lamp that has a place.
//
//   remembered SCENE... [--hierarchy NAME] [--last-hit, --ray-coherence: are tried anyway]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "common/compile/compile.h"
#include "common/hierarchy/ray_log.h"
#include "common/hierarchy/storage.h"
#include "common/hierarchy/walk_counts.h"
#include "common/lighting/renderer.h"
#include "host/commands/hierarchy_options.h"

namespace {

using namespace rayfarm;

constexpr int kSide = 256;
constexpr int kRuns = 5;
constexpr std::array<double, 3> kHalfAngles{5, 15, 45};

RenderSettings settings() {
  RenderSettings s;
  s.width_px = s.height_px = kSide;
  s.crop = {0, 0, kSide, kSide};
  s.lighting = LightingModel::whitted;
  return s;
}

double seconds_of_picture(const Scene& scene) {
  Renderer renderer(scene, settings());
  const auto begin = std::chrono::steady_clock::now();
  renderer.render(0, settings().crop, [] {});
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Of the closest rays of a picture, in their order, and of shadow rays from what they hit.
void count(const Scene& scene, const std::vector<Ray>& rays, WalkCounts& closest, WalkCounts& shadow,
           size_t& shadow_rays) {
  FrameState state(scene);
  const Pose pose = state.at(0);
  for (const Ray& ray : rays) {
    const Hit hit = closest_hit_counted(scene, pose, ray, closest);
    if (!hit.is_hit()) continue;
    for (const Light& light : scene.lights) {
      const Vec3 origin = ray.origin + hit.t * (1 - 1e-9) * ray.direction,
                 way = pose[light].position - origin;
      if (light.kind > LightKind::spot) continue;
      any_hit_counted(scene, pose, {origin, way, 1}, shadow);
      ++shadow_rays;
    }
  }
}

struct Variant {
  std::string name;
  CompiledScene compiled;
  double best_s = std::numeric_limits<double>::infinity();
};

void measure(const std::string& path, const BuildOptions& build) {
  const SceneDescription description = load_scene(path);
  std::vector<Variant> variants;
  const auto add = [&](const std::string& name, bool has_last_hit, double half_angle) {
    BuildOptions options = build;
    options.has_last_hit = has_last_hit;
    options.ray_coherence = half_angle;
    variants.push_back({name, compile(description, options)});
  };
  add("neither", false, 0);
  add("last hit", true, 0);
  for (const double half_angle : kHalfAngles) add(fmt::format("coherence {}", half_angle), false, half_angle);
  RayLog log;
  Scene logged = variants[0].compiled.scene;
  logged.ray_log = &log;
  seconds_of_picture(logged);
  for (int run = 0; run < kRuns; ++run)
    for (Variant& v : variants) v.best_s = std::min(v.best_s, seconds_of_picture(v.compiled.scene));
  fmt::print("{} {}: {} rays\n", path, kHierarchyWords[static_cast<size_t>(build.hierarchy)],
             log.closest.size() + log.any.size());
  fmt::print(
      "  {:<14} {:>7} {:>6} | {:>9} {:>9} | a closest ray: {:>7} {:>8} {:>10} {:>8} {:>7} | a shadow "
      "ray: {:>7} {:>8} {:>10}\n",
      "", "Mray/s", "ratio", "last hit", "of shadow", "tests", "coherent", "candidates", "lists", "nodes",
      "tests", "coherent", "candidates");
  for (const Variant& v : variants) {
    WalkCounts closest, shadow;
    size_t shadow_rays = 0;
    count(v.compiled.scene, log.closest, closest, shadow, shadow_rays);
    const auto of_closest = [&](uint64_t n) {
      return static_cast<double>(n) / static_cast<double>(log.closest.size());
    };
    const auto of_shadow = [&](uint64_t n) {
      return static_cast<double>(n) / static_cast<double>(std::max<size_t>(1, shadow_rays));
    };
    fmt::print(
        "  {:<14} {:>7.2f} {:>6.2f} | {:>9.2f} {:>9.2f} |                {:>7.2f} {:>8.2f} {:>10.2f} "
        "{:>8} {:>7.2f} |               {:>7.2f} {:>8.2f} {:>10.2f}\n",
        v.name, static_cast<double>(log.closest.size() + log.any.size()) / v.best_s * 1e-6,
        variants[0].best_s / v.best_s, of_closest(closest.last_hits), of_shadow(shadow.last_hits),
        of_closest(closest.primitives()), of_closest(closest.coherent_rays), of_closest(closest.candidates),
        closest.lists + shadow.lists, of_closest(closest.nodes + closest.cells),
        of_shadow(shadow.primitives()), of_shadow(shadow.coherent_rays), of_shadow(shadow.candidates));
    std::fflush(stdout);
  }
  if (!logged.octrees.empty())
    fmt::print("  nodes of octrees {}, after these rays\n",
               storage_of_octrees(variants[0].compiled.scene).nodes);
}

}  // namespace

int main(int argc, char** argv) {
  BuildOptions build;
  std::vector<std::string> scenes;
  CLI::App app("Measures what it gives to remember what rays before have hit.");
  Options options(&app);
  app.add_option("SCENE", scenes, "one or more")->required();
  add_hierarchy_options(options, build);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  }
  try {
    for (const std::string& scene : scenes) measure(scene, build);
  } catch (const std::exception& e) {
    fmt::print(stderr, "remembered: {}\n", e.what());
    return 1;
  }
  return 0;
}
