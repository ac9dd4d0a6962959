#include "host/render/frame_groups.h"

#include <algorithm>

namespace rayfarm {

bool has_poses(const Scene& scene) {
  const auto moves = [](const auto& one) { return one.moving != kNone; };
  const auto comes_and_goes = [](const ObjectNode& node) { return node.visible != kNone; };
  return std::any_of(scene.instances.begin(), scene.instances.end(), moves) ||
         std::any_of(scene.lights.begin(), scene.lights.end(), moves) ||
         std::any_of(scene.object_nodes.begin(), scene.object_nodes.end(), comes_and_goes);
}

std::vector<FrameGroup> group_frames(const Scene& scene, size_t frames) {
  if (frames == 0) return {};
  if (!has_poses(scene)) return {{FrameIndex(0), static_cast<int>(frames)}};
  std::vector<FrameGroup> groups;
  for (FrameIndex frame; frame.place() < frames; ++frame) groups.push_back({frame, 1});
  return groups;
}

}  // namespace rayfarm
