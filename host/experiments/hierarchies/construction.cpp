#include "host/experiments/hierarchies/construction.h"

#include <algorithm>
#include <functional>

#include "common/compile/compile.h"
#include "common/hierarchy/frame_state.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

constexpr int kFrames = 200;

double median_s(const std::function<void(int frame)>& work) {
  std::vector<double> took_s;
  for (int frame = 1; frame <= kFrames; ++frame) {
    const double begin_s = now_s();
    work(frame);
    took_s.push_back(now_s() - begin_s);
  }
  std::nth_element(took_s.begin(), took_s.begin() + kFrames / 2, took_s.end());
  return took_s[kFrames / 2];
}

}  // namespace

UpdateTime measure_update(SceneDescription description) {
  TransformStep step;
  step.curve = {Interpolation::linear, {0, kFrames}, {Vec4(0), Vec4(1, 0, 0, 0)}};
  for (ChildDescription& child : description.objects[description.root].children)
    child.transform.push_back(step);
  const CompiledScene compiled = compile(description, {.hierarchy = Hierarchy::thesis});
  const Scene& scene = compiled.scene;
  UpdateTime time;
  time.nodes = scene.object_nodes.size();
  time.links =
      static_cast<size_t>(std::count_if(scene.object_nodes.begin(), scene.object_nodes.end(),
                                        [](const ObjectNode& node) { return node.parent != kNone; }));
  FrameState state(scene);
  time.whole_s = median_s([&](int frame) { state.at(frame); });
  std::vector<InstancePose> poses(scene.moving_instances.size());
  time.matrices_s = median_s([&](int frame) {
    const std::vector<Affine> world = world_transforms(scene, frame);
    for (size_t i = 0; i < poses.size(); ++i) {
      const Instance& instance = scene.instances[scene.moving_instances[i]];
      poses[i] = make_instance_pose(scene, instance, world[instance.object_node]);
    }
  });
  return time;
}

}  // namespace rayfarm
