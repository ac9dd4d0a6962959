#include "common/lighting/zones/zone_scene.h"

#include <fmt/core.h>

#include <stdexcept>

namespace rayfarm {

ZoneScene::ZoneScene(const Scene& scene, const RenderSettings& settings, int frame)
    : scene_(scene),
      frame_(has_poses(scene) ? frame : 0),
      state_(scene_),
      pose_(state_.at(frame)),
      passes_(make_coloured_scenes(scene_, settings)),
      map_(scene_, pose_, settings.zones, settings.lighting != LightingModel::radiosity),
      media_(scene_, map_.size(),
             settings.zones.most_bytes() / (sizeof(double) + sizeof(float) + slot_bytes(1))) {
  if (most_bytes() > settings.zones.most_bytes())
    throw std::runtime_error(fmt::format(
        "{} zones with {} sums of power{} take {:.1f} GiB, and {:g} GiB are allowed; a larger --zone-size, "
        "or more --zone-memory, is needed",
        map_.cell_count() + media_.cell_count(), slot_count(),
        passes() == 1 ? "" : fmt::format(" in each of {} passes", passes()),
        static_cast<double>(most_bytes()) / 0x1p30, settings.zones.most_GiB));
  if (!has_changing_links(scene_)) return;
  const FrameLights lights = make_frame_lights(scene_, light_powers(scene_), frame);
  for (ColouredScene& pass : passes_) pass.set_lights(lights);
}

uint64_t ZoneScene::most_bytes() const {
  return slot_count() * slot_bytes(passes()) + map_.bytes() +
         media_.cell_count() * (sizeof(double) + sizeof(float));
}

bool is_sent_on(const ZoneScene& zones, uint64_t slot) {
  const ZoneMap& map = zones.map();
  if (slot >= map.slot_count()) return true;
  const SlotPlace place = map.place_of_slot(slot);
  const Material& material = map.scene().materials[map.grids()[place.grid].material];
  return place.direction == 0 ? has_diffuse_rays(material) : has_reflected_rays(material);
}

}  // namespace rayfarm
