#include "host/experiments/hierarchies/hierarchy_runs.h"

#include <chrono>
#include <set>

#include "common/hierarchy/storage.h"
#include "common/hierarchy/traverser.h"
#include "common/lighting/renderer.h"

namespace rayfarm {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A scene as it stands at frame 0.
class StandingScene {
 public:
  explicit StandingScene(const Scene& scene) : scene_(scene), state_(scene), pose_(state_.at(0)) {}

  KindCosts count_closest(const std::vector<Ray>& rays) const {
    KindCosts costs{rays.size(), {}};
    for (const Ray& ray : rays) closest_hit_counted(scene_, pose_, ray, costs.counts);
    return costs;
  }
  KindCosts count_any(const std::vector<Ray>& rays) const {
    KindCosts costs{rays.size(), {}};
    for (const Ray& ray : rays) any_hit_counted(scene_, pose_, ray, costs.counts);
    return costs;
  }
  double time_of(const PictureRays& rays) const {
    constexpr int kRuns = 3;
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run < kRuns; ++run) {
      const Clock::time_point begin = Clock::now();
      for (const std::vector<Ray>* kind : {&rays.eye, &rays.secondary})
        for (const Ray& ray : *kind) closest_hit(scene_, pose_, ray);
      for (const Ray& ray : rays.shadow) any_hit(scene_, pose_, ray);
      least = std::min(least, seconds_since(begin));
    }
    return least;
  }

 private:
  Scene scene_;
  FrameState state_;
  Pose pose_;
};

template <typename T>
double bytes_of(std::span<const T> array) {
  return static_cast<double>(array.size_bytes());
}

/// Of what leaves hold.
double bytes_of_primitives(const Scene& s) {
  return bytes_of(s.triangle_blocks) + bytes_of(s.sphere_blocks) + bytes_of(s.leaf_primitives);
}

/// Whole primitives that a leaf refers to.
size_t count_pointers(const Scene& s, const ChildRef& leaf) {
  std::set<uint32_t> ids;
  if (leaf.kind() == ChildKind::triangles)
    for (const TriangleBlock& block : s.triangle_blocks.subspan(leaf.first, leaf.count()))
      for (const PrimitiveId id : block.primitives)
        if (id != kNoPrimitive) ids.insert(id.bits);
  if (leaf.kind() == ChildKind::spheres)
    for (const SphereBlock& block : s.sphere_blocks.subspan(leaf.first, leaf.count()))
      for (const uint32_t sphere : block.spheres)
        if (sphere != kNone) ids.insert(sphere);
  return ids.size() + (leaf.kind() == ChildKind::mixed ? leaf.count() : 0);
}

/// What there is to store, and the thesis's bytes for it.
void count_storage(const Scene& s, HierarchyRun& run) {
  const GridStorage grids = storage_of_grids(s);
  const OctreeStorage octrees = storage_of_octrees(s);
  run.cells = grids.empty_cells + grids.full_cells + octrees.nodes;
  run.empty = grids.empty_cells;
  run.pointers = grids.pointers + octrees.pointers;
  run.thesis_bytes = static_cast<double>(grids.bytes() + octrees.bytes());
  if (run.cells > 0) return;
  const auto add_leaf = [&](const ChildRef& leaf) {
    ++run.leaves;
    run.pointers += count_pointers(s, leaf);
  };
  run.interior = s.nodes.size();
  for (const VolumeNode& node : s.nodes)
    for (const ChildRef& child : node.children)
      if (child.kind() > ChildKind::inner) add_leaf(child);
  for (const Part& part : s.parts)
    if (part.collection.root.kind() > ChildKind::inner) add_leaf(part.collection.root);
  // An interior volume takes 24, a leaf 20, a pointer 4 (Table 4.4).
  run.thesis_bytes = 24.0 * static_cast<double>(run.interior) + 20.0 * static_cast<double>(run.leaves) +
                     4.0 * static_cast<double>(run.pointers);
}

}  // namespace

PictureRays record_rays(const SceneDescription& description, int side_px) {
  const CompiledScene compiled = compile(description);
  RayLog log;
  Scene scene = compiled.scene;
  scene.ray_log = &log;
  RenderSettings settings;
  settings.width_px = settings.height_px = side_px;
  settings.crop = {0, 0, side_px, side_px};
  settings.lighting = LightingModel::whitted;
  settings.sampling = SamplingPattern::corners;
  Renderer(scene, settings).render(0, settings.crop, [] {});
  const Vec3 eye(scene.eval(scene.head().view.location, 0));
  PictureRays rays;
  for (const Ray& ray : log.closest) (ray.origin == eye ? rays.eye : rays.secondary).push_back(ray);
  rays.shadow = std::move(log.any);
  return rays;
}

double bytes_of_list(const SceneDescription& description) {
  return bytes_of_primitives(compile(description, {.hierarchy = Hierarchy::brute}).scene);
}

HierarchyRun run_hierarchy(const SceneDescription& description, const BuildOptions& build,
                           const PictureRays& rays, double bytes_of_list) {
  HierarchyRun run;
  const Clock::time_point begin = Clock::now();
  const CompiledScene compiled = compile(description, build);
  run.build_s = seconds_since(begin);
  const Scene& s = compiled.scene;
  run.bytes = bytes_of(s.nodes) + bytes_of(s.grids) + bytes_of(s.grid_cells) + bytes_of(s.octrees) +
              bytes_of(s.octree_nodes) + bytes_of(s.octree_cells) + bytes_of(s.octree_hash) +
              bytes_of(s.primitive_pointers) + bytes_of_primitives(s) - bytes_of_list;
  count_storage(s, run);
  for (const Instance& instance : s.instances) {
    const Part& part = s.parts[instance.part];
    run.primitives += part.triangle_count + part.sphere_count + part.polygon_count + part.quadric_count;
  }
  const StandingScene scene(s);
  run.eye = scene.count_closest(rays.eye);
  run.secondary = scene.count_closest(rays.secondary);
  run.shadow = scene.count_any(rays.shadow);
  run.ns_per_ray = 1e9 * scene.time_of(rays) / static_cast<double>(std::max<size_t>(1, rays.size()));
  return run;
}

}  // namespace rayfarm
