#include "host/experiments/hierarchies/profile.h"

#include <algorithm>
#include <functional>

#include "common/compile/compile.h"
#include "common/hierarchy/frame_state.h"
#include "common/hierarchy/traverser.h"
#include "common/image/image_file.h"
#include "common/lighting/renderer.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

constexpr int kRuns = 3;

double least_s(const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < kRuns; ++run) {
    const double begin_s = now_s();
    work();
    least = std::min(least, now_s() - begin_s);
  }
  return least;
}

std::vector<RayPacket> pack(const std::vector<Ray>& rays) {
  std::vector<RayPacket> packets;
  for (size_t i = 0; i < rays.size(); i += kMostPacketRays)
    packets.emplace_back(std::span(rays).subspan(i, std::min(kMostPacketRays, rays.size() - i)));
  return packets;
}

/// Table 4.4: a polygon of N corners takes 40 N + 40 bytes, a quadric with N planes 16 N + 56.
double formula_bytes(const Scene& s) {
  const auto polygon = [](double corners) { return 40 * corners + 40; };
  double bytes = polygon(3) * static_cast<double>(s.triangle_shading.size());
  for (const Polygon& p : s.polygons) bytes += polygon(p.point_count);
  for (const MeshFace& face : s.mesh_faces) bytes += polygon(face.corner_count);
  bytes += 56 * static_cast<double>(s.spheres.size());
  for (const Quadric& q : s.quadrics) bytes += 16 * static_cast<double>(q.plane_count) + 56;
  return bytes;
}

}  // namespace

RenderProfile measure_profile(const std::string& path, const PictureRays& rays, int side_px,
                              const HierarchyRun& run, const std::filesystem::path& scratch) {
  RenderProfile profile;
  const WalkCounts counts = run.all().counts;
  profile.curved_leaves = counts.curved_leaves;
  profile.polygon_leaves = counts.leaves - counts.curved_leaves;
  profile.polygons = counts.triangles + counts.polygons;
  profile.curved = counts.spheres + counts.quadrics;
  profile.nodes = counts.nodes;
  profile.boxes = counts.boxes;
  profile.eye_rays = rays.eye.size();
  profile.secondary_rays = rays.secondary.size();
  profile.shadow_rays = rays.shadow.size();

  SceneDescription description;
  profile.load_s = least_s([&] { description = load_scene(path); });
  CompiledScene compiled;
  profile.compile_s = least_s(
      [&] { compiled = compile(description, {.hierarchy = Hierarchy::thesis, .max_primitives = 15}); });
  const Scene& scene = compiled.scene;
  profile.object_nodes = scene.object_nodes.size();
  profile.place_s = least_s([&] { world_transforms(scene, 0); });

  RenderSettings settings;
  settings.width_px = settings.height_px = side_px;
  settings.crop = {0, 0, side_px, side_px};
  settings.lighting = LightingModel::whitted;
  settings.sampling = SamplingPattern::corners;
  settings.pixel_format = PixelFormat::rgb8;
  Renderer renderer(scene, settings);
  RenderedPixels picture;
  profile.frame_s = least_s([&] { picture = renderer.render(0, settings.crop, [] {}); });
  profile.pixels = static_cast<uint64_t>(side_px) * static_cast<uint64_t>(side_px);

  FrameState state(scene);
  const Pose pose = state.at(0);
  const std::array closest{pack(rays.eye), pack(rays.secondary)};
  const std::vector<RayPacket> any = pack(rays.shadow);
  profile.search_s = least_s([&] {
    std::array<Hit, kMostPacketRays> hits;
    for (const std::vector<RayPacket>& packets : closest)
      for (const RayPacket& packet : packets) closest_hits(scene, pose, packet, hits.data());
    for (const RayPacket& packet : any) any_hits(scene, pose, packet, packet.all());
  });

  const std::filesystem::path file = scratch / "profile.png";
  profile.write_s = least_s([&] {
    write_image(file.string(),
                {side_px, side_px, settings.crop, make_pixel_layout(settings.pixel_format), picture.pixels},
                {});
  });
  std::filesystem::remove(file);

  profile.formula_bytes = formula_bytes(scene);
  profile.hierarchy_bytes = run.thesis_bytes;
  profile.block_bytes = static_cast<double>(compiled.block.size);
  std::error_code error;
  const auto code_bytes = std::filesystem::file_size("/proc/self/exe", error);
  if (!error) profile.code_bytes = static_cast<double>(code_bytes);
  profile.raster_bytes = 3 * static_cast<double>(profile.pixels);
  return profile;
}

}  // namespace rayfarm
