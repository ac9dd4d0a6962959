// What a renderer sets up once, and anew for each frame.
#include "common/lighting/renderer.h"
#include "common/lighting/self_hits.h"

namespace rayfarm {

Renderer::Renderer(const Scene& scene, const RenderSettings& settings)
    : scene_(scene),
      settings_(settings),
      passes_(make_coloured_scenes(scene, settings)),
      integrator_(make_integrator(settings.lighting)),
      filter_(settings.filter),
      moments_(scene) {
  if (has_changing_links(scene)) powers_ = light_powers(scene);
}

void Renderer::set_zones(int frame, std::span<const std::byte> solution) {
  zones_.clear();
  zone_scene_ = std::make_unique<ZoneScene>(scene_, settings_, frame);
  const std::vector<ZonePassSolution> solved =
      decode_zone_solution(solution, zone_scene_->passes(), zone_scene_->slot_count());
  for (size_t pass = 0; pass < solved.size(); ++pass)
    zones_.emplace_back(*zone_scene_, pass, solved[pass], settings_.zones.view);
}

void Renderer::set_frame(int frame) {
  frame_.reset();  // stays so if the frame can't be set up
  now_ = moments_.at(frame, settings_);
  if (has_changing_links(scene_)) {
    const FrameLights lights = make_frame_lights(scene_, powers_, frame);
    for (ColouredScene& pass : passes_) pass.set_lights(lights);
  }
  tables_.emplace(settings_, frame);
  small_objects_.clear();
  if (settings_.adaptive_contrast > 0)
    small_objects_ =
        find_small_objects(passes_.front().scene(), now_.front().pose, now_.front().camera, settings_.crop);
  const Scene& shining = passes_.front().scene();
  eye_items_.reset();
  light_items_.reset();
  if (settings_.item_buffer != ItemBuffer::none && has_one_eye(scene_, settings_))
    eye_items_.emplace(scene_, now_.front().pose, now_.front().camera, settings_);
  if (settings_.light_cells > 0 && !follows_paths(settings_.lighting) &&
      settings_.self_hit == SelfHit::bound && now_.size() == 1)
    light_items_.emplace(shining, now_.front().pose, settings_.light_cells);
  eye_media_.clear();
  if (settings_.self_hit == SelfHit::medium)
    for (const Moment& moment : now_)
      eye_media_.push_back(find_eye_media(
          scene_, moment.pose, moment.camera.ray(0.5 * settings_.width_px, 0.5 * settings_.height_px)));
  frame_ = frame;
}

}  // namespace rayfarm
