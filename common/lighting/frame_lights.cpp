#include "common/lighting/frame_lights.h"

#include "common/hierarchy/frame_state.h"

namespace rayfarm {

double light_radius(const Box& bounds) {
  return bounds.is_empty() ? 1 : std::max(1e-150, 0.5 * glm::length(bounds.extent()));
}

Box with_media(Box bounds, std::span<const ParticipatingMedium> media) {
  for (const ParticipatingMedium& medium : media) bounds.grow(medium.box);
  return bounds;
}

double distance_out_of(const Box& bounds) {
  return 4 * (light_radius(bounds) + bounds.magnitude());
}

FrameLights make_frame_lights(const Scene& scene, std::span<const LightPower> powers, double frame) {
  const std::vector<char> visible = visible_nodes(scene, frame);
  Box bounds;
  for (size_t i = 0; i < scene.instances.size(); ++i)
    if (visible[scene.instances[i].object_node]) bounds.grow(scene.poses[i].bounds);
  FrameLights result;
  result.far_away = distance_out_of(with_media(bounds, scene.media));
  std::vector<LightPower> shining;
  for (uint32_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const bool is_luminaire = i >= scene.head().first_luminaire;
    const uint32_t node = is_luminaire ? scene.instances[light.instance].object_node : light.object_node;
    if (node != kNone && !visible[node]) continue;
    result.shining.push_back(i);
    shining.push_back(powers[i]);
    if (!is_luminaire) ++result.first_luminaire;
  }
  result.shares = make_light_shares(shining, light_radius(bounds));
  return result;
}

}  // namespace rayfarm
