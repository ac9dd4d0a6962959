#include "common/compile/textures.h"

namespace rayfarm {

uint32_t add_texture(SceneArrays<GrowingArray>& arrays, const TextureDescription& texture) {
  arrays.textures.push_back(texture);
  arrays.textures.back().first_texel = static_cast<uint32_t>(arrays.texels.size() / 3);
  arrays.texels.insert(arrays.texels.end(), texture.texels.begin(), texture.texels.end());
  return static_cast<uint32_t>(arrays.textures.size() - 1);
}

}  // namespace rayfarm
