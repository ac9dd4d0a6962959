// What blocks of pixels take on the wire and on a core: bytes a pixel, millions of pixels a second. Of made
// pictures or of those given, cut into squares, and as the farm cuts them for a number of nodes, there with
// the header that each result carries.
//   block_codec [PICTURE.png ...]
#include "protocol/block_codec.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/image/image_file.h"
#include "protocol/messages.h"
#include "protocol/subpolygons.h"

namespace {

using namespace rayfarm;

struct Picture {
  std::string name;
  int width = 0, height = 0;
  Bytes pixels;
};

Picture read_picture(const std::string& path) {
  ImageReader reader(path, 1 << 26);
  Picture picture{path, reader.width_px(), reader.height_px(), {}};
  for (int y = 0; y < picture.height; ++y)
    for (const float v : reader.next_row())
      picture.pixels.push_back(static_cast<std::byte>(std::lround(255 * v)));
  return picture;
}

/// 512 × 512 pixels of `value(x, y, channel)`.
template <typename Value>
Picture make_picture(const char* name, Value value) {
  Picture picture{name, 512, 512, {}};
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c)
        picture.pixels.push_back(static_cast<std::byte>(std::clamp(value(x, y, c), 0, 255)));
  return picture;
}

std::vector<Picture> make_pictures() {
  uint32_t random = 1;
  const auto noise = [&](int size) {
    random = random * 1664525u + 1013904223u;
    return static_cast<int>((random >> 16) % static_cast<uint32_t>(size)) - size / 2;
  };
  return {make_picture("smooth", [](int x, int y, int c) { return (x * (c + 2) + y * 3) / 16 + 20 * c; }),
          make_picture("discs",
                       [](int x, int y, int c) {
                         const int u = x % 61 - 30, v = y % 53 - 26, r = u * u + v * v;
                         return r < 560 ? 250 - r / 4 - 30 * c : 40 + y / 5 + 25 * c;
                       }),
          make_picture("noise", [&](int x, int, int c) { return x / 4 + 40 + 10 * c + noise(48); })};
}

Bytes cut(const Picture& picture, const DisplayPolygon& p) {
  Bytes pixels;
  for (int y = p.top; y <= p.bottom; ++y) {
    const auto row = picture.pixels.begin() + 3 * std::ptrdiff_t{y} * picture.width;
    pixels.insert(pixels.end(), row + 3 * p.left, row + 3 * (p.right + 1));
  }
  return pixels;
}

struct Block {
  int width = 0, height = 0;
  Bytes pixels, compressed;
};

/// The least of several runs, each of about a tenth of a second.
template <typename Work>
double seconds_of(Work work) {
  using Clock = std::chrono::steady_clock;
  double least = std::numeric_limits<double>::infinity();
  const auto begin = Clock::now();
  do {
    const auto from = Clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(Clock::now() - from).count());
  } while (Clock::now() - begin < std::chrono::milliseconds(100));
  return least;
}

void measure(const Picture& picture, int side) {
  std::vector<Block> blocks;
  for (int y = 0; y < picture.height; y += side)
    for (int x = 0; x < picture.width; x += side) {
      const int right = std::min(x + side, picture.width) - 1,
                bottom = std::min(y + side, picture.height) - 1;
      blocks.push_back({right - x + 1,
                        bottom - y + 1,
                        cut(picture, {static_cast<uint16_t>(x), static_cast<uint16_t>(y),
                                      static_cast<uint16_t>(right), static_cast<uint16_t>(bottom)}),
                        {}});
    }
  const double pixels = double(picture.width) * picture.height;
  const double encode_s = seconds_of([&] {
    for (Block& b : blocks) b.compressed = compress_rgb8(b.pixels, b.width, b.height);
  });
  Bytes back;
  const double decode_s = seconds_of([&] {
    for (const Block& b : blocks) {
      back.resize(b.pixels.size());
      decompress_rgb8(b.compressed, b.width, b.height, back);
    }
  });
  size_t bytes = 0;
  for (const Block& b : blocks) {
    bytes += b.compressed.size();
    if (decompress_rgb8(b.compressed, b.width, b.height) != b.pixels) {
      fmt::print(stderr, "block_codec: a block of {} is not what it was\n", picture.name);
      std::exit(1);
    }
  }
  fmt::print("{:>24} {:4} {:14.3f} {:10.0f} {:10.0f}\n", picture.name, side,
             static_cast<double>(bytes) / pixels, pixels / encode_s * 1e-6, pixels / decode_s * 1e-6);
}

/// As results of `nodes` nodes, with what they report of a common picture: four rays a pixel from the eye,
/// half as many to a light and of reflection, and a microsecond a pixel.
double bytes_a_pixel(const Picture& picture, const SubpolygonGrid& grid) {
  size_t bytes = 0;
  for (SubpolygonId s; s.value() < grid.count(); ++s) {
    const DisplayPolygon p = grid.polygon(s);
    const int width = p.right - p.left + 1, height = p.bottom - p.top + 1;
    const auto n = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
    const Bytes pixels = cut(picture, p), compressed = compress_rgb8(pixels, width, height);
    const bool is_less = compressed.size() < pixels.size();
    const SubpolygonReport report{FrameNumber(1), s, {4 * n, 2 * n, 2 * n}, n, true, 0, {}};
    bytes += encode_block(0, {report, is_less, is_less ? compressed : pixels}).size();
  }
  return static_cast<double>(bytes) / (double(picture.width) * picture.height);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Picture> pictures;
  for (int i = 1; i < argc; ++i) pictures.push_back(read_picture(argv[i]));
  if (pictures.empty()) pictures = make_pictures();
  fmt::print("{:>24} {:>4} {:>14} {:>10} {:>10}\n", "picture", "side", "bytes a pixel", "coded", "decoded");
  for (const Picture& picture : pictures)
    for (const int side : {8, 11, 16, 32, 45}) measure(picture, side);
  fmt::print("\n{:>24} {:>6} {:>12} {:>14}\n", "picture", "nodes", "subpolygons", "bytes a pixel");
  for (const Picture& picture : pictures)
    for (const int nodes : {2, 8, 32, 128, 512, 1000, 10000}) {
      const SubpolygonGrid grid = make_tapering_grid(0, 0, picture.width, picture.height, nodes,
                                                     kLeastBlockSide_px, kMostSubpolygonBytes / 3);
      fmt::print("{:>24} {:6} {:12} {:14.3f}\n", picture.name, nodes, grid.count(),
                 bytes_a_pixel(picture, grid));
    }
}
