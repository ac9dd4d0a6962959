#include "common/lighting/frame_lights.h"

#include "common/hierarchy/frame_state.h"
#include "common/lighting/light_choice.h"

namespace rayfarm {

double light_radius(const Box& bounds) {
  return bounds.is_empty() ? 1 : std::max(1e-150, 0.5 * glm::length(bounds.extent()));
}

double distance_out_of(const Box& bounds) {
  return 4 * (light_radius(bounds) + bounds.magnitude());
}

FrameLights make_frame_lights(const Scene& scene, double frame) {
  const std::vector<char> visible = visible_nodes(scene, frame);
  Box bounds;
  for (size_t i = 0; i < scene.instances.size(); ++i)
    if (visible[scene.instances[i].object_node]) bounds.grow(scene.poses[i].bounds);
  FrameLights result;
  result.far_away = distance_out_of(bounds);
  std::vector<Light> lights;
  for (uint32_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const bool is_luminaire = i >= scene.head().first_luminaire;
    const uint32_t node = is_luminaire ? scene.instances[light.instance].object_node : light.object_node;
    if (node != kNone && !visible[node]) continue;
    result.shining.push_back(i);
    lights.push_back(light);
    if (!is_luminaire) ++result.first_luminaire;
  }
  Scene of_frame = scene;
  of_frame.lights = lights;
  result.shares = make_light_shares(of_frame, light_radius(bounds));
  return result;
}

}  // namespace rayfarm
