#include "tests/jobs/first_hits.h"

#include <fmt/core.h>

#include "common/compile/compile.h"
#include "common/lighting/coloured_scene.h"
#include "common/lighting/eye_rays.h"
#include "common/lighting/holes.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/moments.h"
#include "common/lighting/surfaces.h"
#include "common/lighting/textured.h"

namespace rayfarm {
namespace {

/// As the renderer does it: a row's pixels, up to eight at a time.
struct EyePacket {
  RayPacket rays;
  OfPacket<SampleId> ids;
};

EyePacket eye_packet(const Camera& camera, int x0, int x1, int y) {
  EyePacket packet;
  RasterPoints at;
  for (int x = x0; x < x1; ++x) {
    at.x[packet.ids.size()] = x + 0.5;
    at.y[packet.ids.size()] = y + 0.5;
    packet.ids.push_back({x, y, 0});
  }
  packet.rays.size = packet.ids.size();
  if (camera.is_pinhole()) {
    make_eye_rays(camera, at, packet.rays);
    return packet;
  }
  for (size_t i = 0; i < packet.rays.size; ++i) {
    const Ray ray = camera.ray(at.x[i], at.y[i]);
    packet.rays.set(i, ray.origin, ray.direction, ray.t_max);
  }
  return packet;
}

Color base_color(const FrameContext& context, const Ray& ray, const Hit& hit, double width, Surface surface) {
  PrincipledPoint point;
  constexpr double kChoice = 0.5;  // of mixes, which models have none of
  const Material material = textured(context.scene, context.pose, ray, hit, width, kChoice, surface, point);
  return material.kind == MaterialKind::principled ? point.base : material.color;
}

void print_packet(const FrameContext& context, const Camera& camera, const EyePacket& packet) {
  OfPacket<Hit> hits;
  hits.resize_for_overwrite(packet.rays.size);
  find_eye_hits(context, packet.rays, hits.data());
  if (has_holes(context))
    for (size_t i = 0; i < packet.rays.size; ++i)
      hits[i] = next_solid_hit(context, packet.rays[i],
                               {packet.ids.span()[i], 0, context.width, context.spread}, hits[i]);
  Surfaces surfaces;
  const uint32_t met = eval_surfaces(context.scene, context.pose, packet.rays, hits.data(), surfaces);
  for (size_t i = 0; i < packet.rays.size; ++i) {
    const PrimitiveKind kind = hits[i].primitive.kind();
    if (!(met >> i & 1) || (kind != PrimitiveKind::triangle && kind != PrimitiveKind::face)) {
      fmt::print("-\n");
      continue;
    }
    const Surface surface = surfaces[i];
    const Ray ray = packet.rays[i];
    const Color filtered =
        base_color(context, ray, hits[i], context.width + hits[i].t * context.spread, surface);
    const Color plain = base_color(context, ray, hits[i], 0, surface);
    fmt::print("{:.9g} {}", glm::dot(surface.p - camera.location, camera.forward), surface.is_front ? 1 : 0);
    for (const Vec3& v : {surface.geometric_normal, surface.shading_normal, filtered, plain})
      fmt::print(" {:.7g} {:.7g} {:.7g}", v.x, v.y, v.z);
    fmt::print("\n");
  }
}

}  // namespace

void print_first_hits(SceneDescription& scene, int frame, int width_px, int height_px,
                      const std::optional<SimpleView>& view) {
  if (view) {
    scene.view = {};
    scene.view.location = constant_curve(Vec4(view->location, 0));
    scene.view.look_at = constant_curve(Vec4(view->look_at, 0));
    scene.view.field_of_view = constant_curve(Vec4(view->field_of_view, 0, 0, 0));
  }
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  settings.lighting = LightingModel::path;
  const std::vector<ColouredScene> passes = make_coloured_scenes(compiled.scene, settings);
  Moments moments(compiled.scene);
  const Moment& now = moments.at(frame, settings).front();
  const SamplingTables tables(settings, frame);
  const FrameContext context{passes.front().scene(), now.pose, tables, now.camera.width(),
                             now.camera.spread()};
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; x += static_cast<int>(kMostPacketRays))
      print_packet(context, now.camera,
                   eye_packet(now.camera, x, std::min(width_px, x + static_cast<int>(kMostPacketRays)), y));
}

}  // namespace rayfarm
