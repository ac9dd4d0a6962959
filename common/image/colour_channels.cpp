#include "common/image/colour_channels.h"

#include <stdexcept>

namespace rayfarm {

std::array<PixelChannel, 3> colour_channels(const PixelLayout& layout) {
  constexpr std::array kNames{"R", "G", "B"};
  std::array<PixelChannel, 3> channels{};
  for (size_t c = 0; c < 3; ++c) {
    const auto channel = layout.find(kNames[c]);
    if (!channel) throw std::runtime_error("the pixels hold no colour");
    channels[c] = layout.channels[*channel];
  }
  return channels;
}

}  // namespace rayfarm
