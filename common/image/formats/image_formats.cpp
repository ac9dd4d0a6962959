#include "common/image/formats/image_formats.h"

#include <OpenImageIO/imageio.h>

extern "C" rayfarm::ReadImageFunction rayfarm_read_image;

std::string rayfarm_read_image(const std::string& path, rayfarm::ReadImage& image) {
  auto in = OIIO::ImageInput::open(path);
  if (!in) return OIIO::geterror();
  const OIIO::ImageSpec& spec = in->spec();
  if (spec.nchannels < 3)
    return "it has " + std::to_string(spec.nchannels) + " channels; red, green and blue are needed";
  image = {spec.width, spec.height, {}};
  image.pixels.resize(size_t{3} * static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height));
  if (!in->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, image.pixels.data())) return in->geterror();
  return "";
}
