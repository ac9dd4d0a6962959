#include "host/experiments/bounding-volumes/bounding_runs.h"

#include "common/hierarchy/ray_log.h"
#include "common/hierarchy/traverser.h"
#include "common/image/image_file.h"
#include "common/lighting/renderer.h"
#include "host/experiments/bounding-volumes/weghorst_tables.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

/// The least of several runs.
template <typename Work>
double least_s(int runs, Work work) {
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) {
    const double begin = thread_cpu_s();
    work();
    least = std::min(least, thread_cpu_s() - begin);
  }
  return least;
}

BuildOptions build_of(size_t combination) {
  BuildOptions build{.hierarchy = Hierarchy::object};
  build.objects.bounds = weghorst::has_selected(combination) ? BoundChoice::best : BoundChoice::sphere;
  build.objects.clusters = weghorst::has_clusters(combination) ? Clusters::groups : Clusters::none;
  return build;
}

/// The rays of a picture. Those of the eye go through the corners of its pixels, row by row.
struct Rays {
  std::vector<Ray> eye, secondary, shadow;
  int columns = 0;
};

RenderedPixels render(const Scene& scene, const RenderSettings& settings, int frame) {
  return Renderer(scene, settings).render(frame, settings.crop, [] {});
}

Rays record(const Scene& of, const RenderSettings& settings, int frame) {
  RayLog log;
  Scene scene = of;
  scene.ray_log = &log;
  render(scene, settings, frame);
  const Camera camera = make_camera(scene, frame, settings.width_px, settings.height_px);
  Rays rays;
  rays.columns = settings.width_px + 1;
  for (int y = 0; y <= settings.height_px; ++y)
    for (int x = 0; x <= settings.width_px; ++x) rays.eye.push_back(camera.ray(x, y));
  for (const Ray& ray : log.closest)
    if (ray.origin != camera.location) rays.secondary.push_back(ray);
  rays.shadow = std::move(log.any);
  return rays;
}

/// One scene at one frame, and its rays.
class Bench {
 public:
  Bench(const Scene& scene, int frame, const Rays& rays, int runs)
      : scene_(scene), state_(scene), pose_(state_.at(frame)), frame_(frame), rays_(rays), runs_(runs) {}

  void ask(const RenderSettings& settings, CombinationRun& run) {
    run.eye.rays = rays_.eye.size();
    run.secondary = closest(rays_.secondary);
    run.shadow.rays = rays_.shadow.size();
    for (const Ray& ray : rays_.shadow) any_hit_counted(scene_, pose_, ray, run.shadow.counts);
    run.shadow.s = least_s(runs_, [&] {
      for (const Ray& ray : rays_.shadow) any_hit(scene_, pose_, ray);
    });
    if (settings.item_buffer == ItemBuffer::none)
      run.eye = closest(rays_.eye);
    else
      ask_buffer(settings, run);
  }

  /// Nanoseconds of a test of a primitive in an item: some of the eye rays, each with all items that are
  /// seen.
  double primitive_ns(const RenderSettings& settings) {
    EyeItems items(scene_, pose_, camera(settings), settings);
    std::vector<Item> seen;
    for (size_t i = 0; i < rays_.eye.size(); ++i)
      for (const Item& item : items.candidates_at(x_of(i), y_of(i)).items)
        if (std::find(seen.begin(), seen.end(), item) == seen.end()) seen.push_back(item);
    const size_t step = std::max<size_t>(1, rays_.eye.size() / 500);
    WalkCounts counts;
    for (size_t i = 0; i < rays_.eye.size(); i += step)
      closest_hit_among_counted(scene_, pose_, seen, rays_.eye[i], counts);
    const double s = least_s(5, [&] {
      for (size_t i = 0; i < rays_.eye.size(); i += step)
        closest_hit_among(scene_, pose_, seen, rays_.eye[i]);
    });
    return counts.primitives() > 0 ? 1e9 * s / static_cast<double>(counts.primitives()) : 0;
  }

  PhaseCost closest(const std::vector<Ray>& rays) const {
    PhaseCost cost{rays.size(), {}, 0};
    for (const Ray& ray : rays) closest_hit_counted(scene_, pose_, ray, cost.counts);
    cost.s = least_s(runs_, [&] {
      for (const Ray& ray : rays) closest_hit(scene_, pose_, ray);
    });
    return cost;
  }

 private:
  Camera camera(const RenderSettings& settings) const {
    return make_camera(scene_, frame_, settings.width_px, settings.height_px);
  }
  int x_of(size_t i) const { return static_cast<int>(i) % rays_.columns; }
  int y_of(size_t i) const { return static_cast<int>(i) / rays_.columns; }

  void ask_buffer(const RenderSettings& settings, CombinationRun& run) {
    std::optional<EyeItems> items;
    run.buffer_s = least_s(runs_, [&] { items.emplace(scene_, pose_, camera(settings), settings); });
    run.eye.s = least_s(runs_, [&] {
      RayPacket rays;
      RasterPoints at;
      std::array<Hit, kMostPacketRays> hits;
      RayCounts counts;
      for (size_t i = 0; i < rays_.eye.size(); ++i) {
        at.x[rays.size] = x_of(i);
        at.y[rays.size] = y_of(i);
        rays.push_back(rays_.eye[i].origin, rays_.eye[i].direction);
        if (!rays.is_full() && i + 1 < rays_.eye.size()) continue;
        items->find(pose_, rays, at, hits.data(), counts);
        rays.clear();
      }
    });
    for (size_t i = 0; i < rays_.eye.size(); ++i) {
      const EyeItems::Candidates& candidates = items->candidates_at(x_of(i), y_of(i));
      const Hit hit =
          closest_hit_among_counted(scene_, pose_, candidates.items, rays_.eye[i], run.eye.counts);
      if (!hit.is_hit() && !candidates.is_open)
        closest_hit_counted(scene_, pose_, rays_.eye[i], run.eye.counts);
    }
  }

  Scene scene_;
  FrameState state_;
  Pose pose_;
  int frame_;
  const Rays& rays_;
  int runs_;
};

uint64_t count_differing(const RenderedPixels& a, const RenderedPixels& b, size_t bytes) {
  uint64_t count = 0;
  for (size_t i = 0; i < a.pixels.size(); i += bytes)
    count += std::equal(&a.pixels[i], &a.pixels[i] + bytes, &b.pixels[i]) ? 0 : 1;
  return count;
}

RenderSettings settings_of(uint32_t depth, int width_px, int height_px) {
  RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  settings.crop = {0, 0, width_px, height_px};
  settings.sampling = SamplingPattern::corners;
  settings.pixel_format = PixelFormat::rgb8;
  if (depth > 0)
    limit_by_depth(settings, depth);
  else
    settings.min_weight = kAdaptiveWeight;
  return settings;
}

}  // namespace

EnvironmentRun run_environment(const SceneDescription& description, int frame, uint32_t depth, int width_px,
                               int height_px, int runs, const std::string& scratch) {
  EnvironmentRun environment;
  const RenderSettings ordinary = settings_of(depth, width_px, height_px);
  Rays rays;
  RenderedPixels expected;
  for (size_t c = 0; c < weghorst::kCombinationCount; ++c) {
    const CompiledScene compiled = compile(description, build_of(c));
    CombinationRun run;
    run.name = weghorst::kCombinations[c];
    RenderSettings settings = ordinary;
    if (weghorst::has_buffer(c)) settings.item_buffer = ItemBuffer::trusted;
    if (c == 0) rays = record(compiled.scene, ordinary, frame);
    RenderedPixels rendered;
    run.render_s = least_s(runs, [&] { rendered = render(compiled.scene, settings, frame); });
    const Image image{width_px, height_px, settings.crop, make_pixel_layout(settings.pixel_format),
                      rendered.pixels};
    run.write_s = least_s(runs, [&] { write_image(scratch, image, {}); });
    if (c == 0) {
      environment.rays = rendered.counts;
      expected = rendered;
    }
    run.differing_pixels = count_differing(rendered, expected, image.layout.bytes);
    Bench bench(compiled.scene, frame, rays, runs);
    bench.ask(settings, run);
    if (c == weghorst::kSH) {
      environment.primitive_ns = bench.primitive_ns(ordinary);
      settings.item_buffer = ItemBuffer::bound;
      environment.bound_s = least_s(runs, [&] { rendered = render(compiled.scene, settings, frame); });
      settings.item_buffer = ItemBuffer::trusted;
      settings.light_cells = 256;
      environment.light_buffer_s = least_s(runs, [&] { rendered = render(compiled.scene, settings, frame); });
      RenderSettings coarse = ordinary;
      coarse.min_weight = 0.1;
      environment.depth_above_tenth = render(compiled.scene, coarse, frame).counts.average_depth();
      environment.shadowed_by_items = rendered.counts[RayTally::shadow_items];
    }
    environment.runs.push_back(std::move(run));
  }
  return environment;
}

double cost_ns(const WalkCounts& counts, double primitive_ns) {
  double cost = primitive_ns * static_cast<double>(counts.primitives());
  for (size_t kind = 0; kind < kVolumeKinds; ++kind)
    cost += kVolumeFactors[kind] * static_cast<double>(counts.bounds[kind]);
  return cost;
}

ViewCost compare_bounds(const SceneDescription& description, int frame, int width_px, int height_px,
                        int runs) {
  ViewCost cost;
  const RenderSettings settings = settings_of(1, width_px, height_px);
  double primitive_ns = 0;
  for (const BoundChoice bounds : {BoundChoice::box, BoundChoice::sphere}) {
    BuildOptions build{.hierarchy = Hierarchy::object};
    build.objects.bounds = bounds;
    const CompiledScene compiled = compile(description, build);
    const Rays rays = record(compiled.scene, settings, frame);
    Bench bench(compiled.scene, frame, rays, runs);
    if (bounds == BoundChoice::box) primitive_ns = bench.primitive_ns(settings);
    const double counted = cost_ns(bench.closest(rays.eye).counts, primitive_ns);
    (bounds == BoundChoice::box ? cost.box_ns : cost.sphere_ns) = counted;
    (bounds == BoundChoice::box ? cost.box_s : cost.sphere_s) =
        least_s(runs, [&] { render(compiled.scene, settings, frame); });
  }
  return cost;
}

}  // namespace rayfarm
