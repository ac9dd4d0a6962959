#include "common/lighting/zones/zone_scene.h"

namespace rayfarm {

ZoneScene::ZoneScene(const Scene& scene, const RenderSettings& settings, int frame)
    : scene_(scene),
      state_(scene_),
      pose_(state_.at(frame)),
      passes_(make_coloured_scenes(scene_, settings)),
      map_(scene_, pose_, settings.zones) {
  if (!has_changing_links(scene_)) return;
  const FrameLights lights = make_frame_lights(scene_, light_powers(scene_), frame);
  for (ColouredScene& pass : passes_) pass.set_lights(lights);
}

bool is_sent_on(const ZoneMap& map, uint64_t slot) {
  const SlotPlace place = map.place_of_slot(slot);
  const Material& material = map.scene().materials[map.grids()[place.grid].material];
  return place.direction == 0 ? has_diffuse_rays(material) : has_reflected_rays(material);
}

}  // namespace rayfarm
