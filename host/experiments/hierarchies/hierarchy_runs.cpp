#include "host/experiments/hierarchies/hierarchy_runs.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <set>

#include "common/hierarchy/bounding_tree.h"
#include "common/hierarchy/storage.h"
#include "common/hierarchy/traverser.h"
#include "common/lighting/renderer.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

constexpr size_t kChunk = 1024;  ///< rays

/// A scene as it stands at frame 0.
class StandingScene {
 public:
  explicit StandingScene(const Scene& scene) : scene_(scene), state_(scene), pose_(state_.at(0)) {}

  /// Of closest hits, or of whether there are any.
  KindCosts count(const std::vector<Ray>& rays, bool is_any) const {
    KindCosts costs;
    costs.rays = rays.size();
    WalkCounts& c = costs.counts;
    for (const Ray& ray : rays) {
      const uint64_t empty = c.empty_cells, full = full_volumes(c);
      Hit hit;
      const bool is_hit = is_any ? any_hit_counted(scene_, pose_, ray, c)
                                 : (hit = closest_hit_counted(scene_, pose_, ray, c)).is_hit();
      costs.hits += is_hit;
      for (const uint64_t answer : {std::bit_cast<uint64_t>(hit.t), uint64_t{hit.instance},
                                    uint64_t{hit.primitive.bits}, uint64_t{is_hit}})
        costs.answers = (costs.answers ^ answer) * 0x100000001b3u;  // FNV-1a, by words
      ++costs.types[type_of_ray(c.empty_cells - empty, full_volumes(c) - full, is_hit)];
    }
    return costs;
  }
  /// Chunk by chunk the least of the passes: what else the machine does in one of them does not count.
  double time_of(const PictureRays& rays, int passes) const {
    std::vector<double> least_s;
    for (int pass = 0; pass < passes; ++pass) {
      size_t chunk = 0;
      const auto time_chunks = [&](const std::vector<Ray>& kind, auto search) {
        for (size_t begin = 0; begin < kind.size(); begin += kChunk, ++chunk) {
          const double start_s = now_s();
          for (size_t i = begin; i < std::min(kind.size(), begin + kChunk); ++i) search(kind[i]);
          if (chunk == least_s.size()) least_s.push_back(std::numeric_limits<double>::infinity());
          least_s[chunk] = std::min(least_s[chunk], now_s() - start_s);
        }
      };
      for (const std::vector<Ray>* kind : {&rays.eye, &rays.secondary})
        time_chunks(*kind, [&](const Ray& ray) { closest_hit(scene_, pose_, ray); });
      time_chunks(rays.shadow, [&](const Ray& ray) { any_hit(scene_, pose_, ray); });
    }
    return std::accumulate(least_s.begin(), least_s.end(), 0.0);
  }

 private:
  static uint64_t full_volumes(const WalkCounts& c) {
    return c.cells > 0 ? c.cells - c.empty_cells : c.leaves + c.leaf_volumes;
  }

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

void count_grid_cells(const Scene& s, HierarchyRun& run) {
  for (const Grid& grid : s.grids)
    for (size_t i = grid.first_cell; i < grid.first_cell + grid.cell_count(); ++i) {
      const auto list = s.primitive_pointers.subspan(s.grid_cells[i], s.grid_cells[i + 1] - s.grid_cells[i]);
      if (list.empty()) continue;
      ++run.cells_by_fill[static_cast<size_t>(std::bit_width(list.size()) - 1)];
      run.quadric_cells += std::all_of(list.begin(), list.end(), [&](const PrimitivePointer& pointer) {
        return pointer.kind() == PointerKind::other &&
               s.leaf_primitives[pointer.place()].kind() == PrimitiveKind::quadric;
      });
    }
}

/// What there is to store, and the thesis's bytes for it.
void count_storage(const Scene& s, const SceneFacts& facts, HierarchyRun& run) {
  const GridStorage grids = storage_of_grids(s);
  const OctreeStorage octrees = storage_of_octrees(s);
  run.cells = grids.empty_cells + grids.full_cells + octrees.nodes;
  run.empty = grids.empty_cells;
  run.pointers = grids.pointers + octrees.pointers;
  run.thesis_bytes = static_cast<double>(grids.bytes() + octrees.bytes());
  count_grid_cells(s, run);
  run.full_lists = grids.full_cells + static_cast<size_t>(std::count_if(
                                          s.octree_cells.begin(), s.octree_cells.end(),
                                          [](const OctreeCell& cell) { return cell.pointer_count > 0; }));
  if (run.cells > 0) return;
  const bool has_octants = !s.octant_trees.empty();
  if (s.head().object_tree != kNone && !has_octants) {
    const ObjectSizes sizes = sizes_of(s, s.bounding_trees[s.head().object_tree]);
    run.objects = sizes.nodes;
    run.pointers = sizes.pointers;
    run.thesis_bytes = static_cast<double>(sizes.bytes());
    return;
  }
  const auto add_leaf = [&](const ChildRef& leaf) {
    ++run.leaves;
    run.pointers += count_pointers(s, leaf);
  };
  if (!has_octants) {
    run.interior = s.nodes.size();
    for (const VolumeNode& node : s.nodes)
      for (const ChildRef& child : node.children)
        if (child.kind() > ChildKind::inner) add_leaf(child);
    for (const Part& part : s.parts)
      if (part.collection.root.kind() > ChildKind::inner) add_leaf(part.collection.root);
  }
  const OctantStorage octants = storage_of_octants(s);
  run.interior += octants.interior;
  run.leaves += octants.leaves;
  run.pointers += octants.pointers;
  run.full_lists = run.leaves;
  // The thesis's object part stands over its volumes: 88 bytes each. An interior volume takes 24, a leaf 20,
  // a pointer 4 (Table 4.4).
  const bool has_volumes = has_octants || std::any_of(s.parts.begin(), s.parts.end(), [](const Part& part) {
                             return part.collection.structure != Structure::list;
                           });
  run.thesis_bytes = (has_volumes ? 88.0 * static_cast<double>(facts.object_nodes) : 0.0) +
                     24.0 * static_cast<double>(run.interior) + 20.0 * static_cast<double>(run.leaves) +
                     4.0 * static_cast<double>(run.pointers);
}

/// The scene, and the median of the CPU time that compiling it takes.
std::pair<CompiledScene, double> build_often(const SceneDescription& description, const BuildOptions& build,
                                             int builds) {
  std::vector<double> took_s;
  const auto once = [&] {
    const double begin = cpu_s();
    CompiledScene compiled = compile(description, build);
    took_s.push_back(cpu_s() - begin);
    return compiled;
  };
  for (int i = 1; i < builds; ++i) once();
  CompiledScene compiled = once();
  std::sort(took_s.begin(), took_s.end());
  return {std::move(compiled), took_s[took_s.size() / 2]};
}

KindCosts sum(const KindCosts& a, const KindCosts& b) {
  KindCosts c = a;
  c.rays += b.rays;
  c.hits += b.hits;
  c.answers ^= b.answers;
  c.counts += b.counts;
  for (size_t i = 0; i < c.types.size(); ++i) c.types[i] += b.types[i];
  return c;
}

uint64_t volumes_of(const WalkCounts& c) {
  if (c.volumes() > 0) return c.volumes();
  if (c.elements > 0) return c.elements;
  return c.nodes + (c.cells > 0 ? c.cells : c.leaves);
}

double ratio(uint64_t a, uint64_t b) {
  return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0;
}

}  // namespace

size_t type_of_ray(uint64_t empty_volumes, uint64_t full_volumes, bool is_hit) {
  const uint64_t in_vain = full_volumes - (is_hit && full_volumes > 0 ? 1 : 0);
  if (in_vain > 0) return 2;
  return is_hit && empty_volumes == 0 ? 0 : 1;
}

KindCosts HierarchyRun::all() const {
  return sum(sum(eye, secondary), shadow);
}

double HierarchyRun::volumes_per_ray() const {
  const KindCosts costs = all();
  return ratio(volumes_of(costs.counts), costs.rays);
}

double HierarchyRun::primitives_per_ray() const {
  const KindCosts costs = all();
  return ratio(costs.counts.primitives(), costs.rays);
}

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
  PictureRays rays;
  rays.counts = Renderer(scene, settings).render(0, settings.crop, [] {}).counts;
  const Vec3 eye(scene.eval(scene.head().view.location, 0));
  for (const Ray& ray : log.closest) (ray.origin == eye ? rays.eye : rays.secondary).push_back(ray);
  rays.shadow = std::move(log.any);
  return rays;
}

PictureRays every_nth(const PictureRays& rays, size_t n) {
  const auto thin_out = [&](const std::vector<Ray>& all) {
    std::vector<Ray> some;
    for (size_t i = 0; i < all.size(); i += n) some.push_back(all[i]);
    return some;
  };
  return {thin_out(rays.eye), thin_out(rays.secondary), thin_out(rays.shadow), rays.counts};
}

SceneFacts look_at_scene(const SceneDescription& description, int builds) {
  const auto [list, cpu_s] = build_often(description, {.hierarchy = Hierarchy::brute}, builds);
  SceneFacts facts{bytes_of_primitives(list.scene), cpu_s, 0, 0};
  const CompiledScene objects = compile(description, {.hierarchy = Hierarchy::object});
  const Scene& s = objects.scene;
  if (s.head().object_tree == kNone) return facts;
  const ObjectSizes sizes = sizes_of(s, s.bounding_trees[s.head().object_tree]);
  facts.object_nodes = sizes.nodes;
  facts.object_pointers = sizes.pointers;
  return facts;
}

HierarchyRun run_hierarchy(const SceneDescription& description, const BuildOptions& build,
                           const PictureRays& rays, const SceneFacts& facts, const Effort& effort) {
  HierarchyRun run;
  const auto [compiled, cpu_s] = build_often(description, build, effort.builds);
  run.build_cpu_s = std::max(0.0, cpu_s - facts.list_cpu_s);
  const Scene& s = compiled.scene;
  run.bytes = bytes_of(s.nodes) + bytes_of(s.grids) + bytes_of(s.grid_cells) + bytes_of(s.octrees) +
              bytes_of(s.octree_nodes) + bytes_of(s.octant_trees) + bytes_of(s.octant_volumes) +
              bytes_of(s.octree_cells) + bytes_of(s.octree_hash) + bytes_of(s.primitive_pointers) +
              bytes_of(s.bounding_nodes) + bytes_of(s.bounding_volumes) + bytes_of_primitives(s) -
              facts.list_bytes;
  count_storage(s, facts, run);
  for (const Instance& instance : s.instances) run.primitives += s.parts[instance.part].primitive_count();
  const StandingScene scene(s);
  run.eye = scene.count(rays.eye, false);
  run.secondary = scene.count(rays.secondary, false);
  run.shadow = scene.count(rays.shadow, true);
  run.ns_per_ray =
      1e9 * scene.time_of(rays, effort.passes) / static_cast<double>(std::max<size_t>(1, rays.size()));
  return run;
}

}  // namespace rayfarm
