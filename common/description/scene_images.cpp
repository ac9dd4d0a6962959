#include "common/description/scene_images.h"

namespace rayfarm {

uint64_t texels_left(const SceneDescription& scene) {
  uint64_t used = scene.environment ? scene.environment->texels.size() / 3 : 0;
  for (const TextureDescription& t : scene.textures) used += t.texels.size() / 3;
  return limits::kTexels - std::min(limits::kTexels, used);
}

void load_scene_image(SceneDescription& scene, const ImageFile& file, TextureDescription& texture,
                      const std::stop_token& stop, const ImageReading& reading) {
  // A mip map takes at most half as many texels again, in the worst case of an image one pixel wide as many.
  texture.kind = TextureKind::image;
  texture.is_mapped = 1;
  texture.texels =
      load_texels(file, texture, std::min(limits::kTexturePixels, texels_left(scene) / 2), stop, reading);
  texture.is_from_srgb = !is_linear(file.name, reading);
  if (!file.bytes) scene.files.push_back(file.name);
}

}  // namespace rayfarm
