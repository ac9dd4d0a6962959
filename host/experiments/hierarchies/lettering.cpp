#include "host/experiments/hierarchies/lettering.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

namespace rayfarm {
namespace {

constexpr int kSquare_px = 2, kColumns = 3, kRows = 5;

struct Letter {
  char name;
  std::array<uint8_t, kRows> rows;  ///< from the top; 4: the left square
};

constexpr std::array kLetters{
    Letter{'0', {7, 5, 5, 5, 7}}, Letter{'1', {2, 6, 2, 2, 7}}, Letter{'2', {7, 1, 7, 4, 7}},
    Letter{'3', {7, 1, 3, 1, 7}}, Letter{'4', {5, 5, 7, 1, 1}}, Letter{'5', {7, 4, 7, 1, 7}},
    Letter{'6', {7, 4, 7, 5, 7}}, Letter{'7', {7, 1, 1, 2, 2}}, Letter{'8', {7, 5, 7, 5, 7}},
    Letter{'9', {7, 5, 7, 1, 7}}, Letter{'A', {2, 5, 7, 5, 5}}, Letter{'B', {6, 5, 6, 5, 6}},
    Letter{'C', {3, 4, 4, 4, 3}}, Letter{'D', {6, 5, 5, 5, 6}}, Letter{'E', {7, 4, 6, 4, 7}},
    Letter{'F', {7, 4, 6, 4, 4}}, Letter{'G', {3, 4, 5, 5, 3}}, Letter{'H', {5, 5, 7, 5, 5}},
    Letter{'I', {7, 2, 2, 2, 7}}, Letter{'J', {1, 1, 1, 5, 2}}, Letter{'K', {5, 5, 6, 5, 5}},
    Letter{'L', {4, 4, 4, 4, 7}}, Letter{'M', {5, 7, 7, 5, 5}}, Letter{'N', {6, 5, 5, 5, 5}},
    Letter{'O', {2, 5, 5, 5, 2}}, Letter{'P', {6, 5, 6, 4, 4}}, Letter{'Q', {2, 5, 5, 7, 3}},
    Letter{'R', {6, 5, 6, 5, 5}}, Letter{'S', {3, 4, 2, 1, 6}}, Letter{'T', {7, 2, 2, 2, 2}},
    Letter{'U', {5, 5, 5, 5, 7}}, Letter{'V', {5, 5, 5, 5, 2}}, Letter{'W', {5, 5, 7, 7, 5}},
    Letter{'X', {5, 5, 2, 5, 5}}, Letter{'Y', {5, 5, 2, 2, 2}}, Letter{'Z', {7, 1, 2, 4, 7}},
    Letter{'.', {0, 0, 0, 0, 2}}, Letter{'-', {0, 0, 7, 0, 0}}};

void fill_square(Image& image, int left_px, int top_px) {
  for (int y = top_px; y < top_px + kSquare_px; ++y)
    for (int x = left_px; x < left_px + kSquare_px; ++x)
      if (x >= 0 && y >= 0 && x < image.width_px && y < image.height_px)
        std::fill_n(image.pixels.begin() + 3 * (static_cast<ptrdiff_t>(y) * image.width_px + x), 3,
                    std::byte{0});
}

}  // namespace

int width_of_letters(std::string_view text) {
  return static_cast<int>(text.size()) * (kColumns + 1) * kSquare_px;
}

void write_letters(Image& image, int left_px, int top_px, std::string_view text) {
  for (const char c : text) {
    const char name = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const auto letter =
        std::find_if(kLetters.begin(), kLetters.end(), [&](const Letter& l) { return l.name == name; });
    if (letter != kLetters.end())
      for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column)
          if (letter->rows[static_cast<size_t>(row)] >> (kColumns - 1 - column) & 1)
            fill_square(image, left_px + column * kSquare_px, top_px + row * kSquare_px);
    left_px += (kColumns + 1) * kSquare_px;
  }
}

}  // namespace rayfarm
