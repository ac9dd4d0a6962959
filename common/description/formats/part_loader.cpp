// A file of compiled objects as a scene: to look at what is in it. It is seen from the front, whole, and lit
// from beside the viewer if nothing in it shines.
#include "common/description/describe_part.h"
#include "common/description/formats/scene_loaders.h"

namespace rayfarm {
namespace {

/// Of the objects at the frame for which they were compiled.
Box bounds_of(const Scene& objects) {
  Box bounds;
  for (const InstancePose& pose : objects.poses) bounds.grow(pose.bounds);
  return bounds;
}

void look_at(const Box& bounds, ViewDescription& view) {
  if (bounds.is_empty()) return;
  constexpr double kSine = 0.29;  // of half the angle of view from the picture's lower edge to its upper
  const Vec3 center = bounds.center();
  const double distance = std::max(1e-6, 0.5 * glm::length(bounds.extent())) / kSine;
  view.location = constant_curve(Vec4(center + Vec3(0, 0, distance), 0));
  view.direction = constant_curve(Vec4(0, 0, -1, 0));
}

/// From the first key to the last of what moves, or comes and goes.
std::optional<std::array<int, 2>> frames_of(const Scene& objects) {
  double first = 9'999'999, last = 0;
  bool changes = false;
  const auto add = [&](uint32_t index) {
    const CurveRecord& curve = objects.curves[index];
    if (curve.key_count < 2) return;
    changes = true;
    const auto frames = objects.key_frames.subspan(curve.first_key, curve.key_count);
    first = std::min(first, frames.front());
    last = std::max(last, frames.back());
  };
  for (const TransformStepRecord& step : objects.steps) add(step.curve);
  for (const ObjectNode& node : objects.object_nodes)
    if (node.visible != kNone) add(node.visible);
  if (!changes) return std::nullopt;
  const int begin = static_cast<int>(std::clamp(std::floor(first), 0.0, 9'999'999.0));
  return std::array{begin, std::max(begin, static_cast<int>(std::clamp(std::ceil(last), 0.0, 9'999'999.0)))};
}

}  // namespace

SceneDescription load_part_scene(const std::string& path, const LoadOptions& options) {
  SceneDescription scene;
  scene.files = {path};
  scene.materials.emplace_back("default");
  scene.objects.push_back({"scene", {}, {}, {}});
  const uint32_t objects_of_file = add_part_file(scene, path, {}, options.stop);
  scene.objects[0].children.push_back({objects_of_file, {}, {}});
  const Scene& objects = scene.libraries[0].scene;
  look_at(bounds_of(objects), scene.view);
  scene.frames = frames_of(objects);
  if (objects.lights.empty()) {
    Light& light = scene.lights.emplace_back();
    light.kind = LightKind::distant;
    light.direction = normalized(Vec3(-1, -2, -3));
  }
  return scene;
}

}  // namespace rayfarm
