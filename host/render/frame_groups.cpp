#include "host/render/frame_groups.h"

namespace rayfarm {

std::vector<FrameGroup> group_frames(const Scene& scene, size_t frames) {
  if (frames == 0) return {};
  if (!has_poses(scene)) return {{FrameIndex(0), static_cast<int>(frames)}};
  std::vector<FrameGroup> groups;
  for (FrameIndex frame; frame.place() < frames; ++frame) groups.push_back({frame, 1});
  return groups;
}

}  // namespace rayfarm
