#pragma once
// Letters of three by five squares, for numbers and names in pictures.
#include <string_view>

#include "common/image/image.h"

namespace rayfarm {

inline constexpr int kLetterHeight_px = 10;

int width_of_letters(std::string_view text);

/// In black, as far as the picture (rgb8) reaches. What there is no letter for stays blank.
void write_letters(Image& image, int left_px, int top_px, std::string_view text);

}  // namespace rayfarm
