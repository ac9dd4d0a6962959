#include "tests/fuzz/image_bytes.h"

#include "common/description/scene_description.h"
#include "common/errors/input_error.h"
#include "common/files/read_file.h"
#include "common/image/image_file.h"

namespace rayfarm::fuzz {

std::vector<std::string> image_seeds(const Folder& folder) {
  std::vector<std::string> seeds;
  const Image image{
      5, 4, {0, 0, 5, 4}, make_pixel_layout(PixelFormat::rgb8), std::vector<std::byte>(3 * 5 * 4)};
  for (const char* name : {"seed.png", "seed.exr"}) {
    write_image(folder.path + "/" + name, image, {{"rayfarm/frame", "1"}});
    seeds.push_back(name[5] + read_file(folder.path + "/" + name, limits::kFileBytes));
  }
  seeds.push_back("h#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n0123456789abcdef");
  return seeds;
}

void read_images(const Folder& folder, const std::string& bytes) {
  if (bytes.empty()) return;
  const char kind = bytes[0];
  const std::string path = folder.write(kind == 'e'   ? "in.exr"
                                        : kind == 'h' ? "in.hdr"
                                                      : "in.png",
                                        bytes.substr(1));
  if (kind != 'h') {
    try {
      read_image_info(path);
      check_image_whole(path);
    } catch (const IoError&) {
    }
  }
  ImageReader reader(path, 1 << 20);
  for (int y = 0; y < reader.height_px(); ++y) reader.next_row();
}

}  // namespace rayfarm::fuzz
