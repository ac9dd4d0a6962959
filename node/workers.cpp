#include "common/scene/scene_block.h"
#include "common/scene/settings_codec.h"
#include "node/node.h"

namespace rayfarm {

Workers make_workers() {
  return {make_scene_worker, [](const JobPlan& plan, std::span<const std::byte> scene, FrameNumber frame) {
            return make_zone_tracer(decode_scene(scene), decode_settings(plan.settings), frame.value());
          }};
}

}  // namespace rayfarm
