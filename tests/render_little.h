#pragma once
// What was accepted is also rendered: tests of damaged input look no closer at it.
#include "common/lighting/renderer.h"

namespace rayfarm::test {

/// A few pixels of a frame by the models that together reach all of a scene. Throws std::domain_error if the
/// frame has no such view or pose.
inline void render_little(const Scene& scene, int frame, int width_px, int height_px) {
  for (const LightingModel model : {LightingModel::whitted, LightingModel::path}) {
    RenderSettings settings;
    settings.width_px = width_px;
    settings.height_px = height_px;
    settings.crop = {0, 0, width_px, height_px};
    settings.lighting = model;
    settings.max_depth = 3;
    settings.reflected_rays = settings.transmitted_rays = 2;
    settings.glass_shadows = GlassShadows::transparent;
    settings.item_buffer = ItemBuffer::bound;
    settings.self_hit = model == LightingModel::path ? SelfHit::medium : SelfHit::bound;
    settings.light_cells = 4;
    Renderer(scene, settings).render(frame, settings.crop, [] {});
  }
}

}  // namespace rayfarm::test
