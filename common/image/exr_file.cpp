#include "common/image/exr_file.h"

#include <ImathBox.h>
#include <ImathFun.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>

#include "common/image/exr_streams.h"
#include "common/image/image_writer.h"

namespace rayfarm {
namespace {

constexpr int kRowsAtOnce = 64;  // a multiple of what ZIP compresses together

/// As long as a late attribute, which is filled up with spaces.
std::string without_padding(std::string value) {
  if (value.size() == kLateAttributeBytes) value.erase(value.find_last_not_of(' ') + 1);
  return value;
}

PixelRect rect_of(const Imath::Box2i& box, const Imath::V2i& origin) {
  return {box.min.x - origin.x, box.min.y - origin.y, box.max.x - origin.x + 1, box.max.y - origin.y + 1};
}

/// Half or float, if that is what all of R, G and B are.
std::optional<PixelFormat> format_of(const Imf::ChannelList& channels) {
  const Imf::Channel* red = channels.findChannel("R");
  if (!red || red->type == Imf::UINT) return std::nullopt;
  for (const char* name : {"G", "B"}) {
    const Imf::Channel* other = channels.findChannel(name);
    if (!other || other->type != red->type) return std::nullopt;
  }
  return red->type == Imf::HALF ? PixelFormat::half_float : PixelFormat::float32;
}

}  // namespace

ImageInfo read_exr_info(std::FILE* file) {
  ExrInput stream(file);
  const Imf::InputFile in(stream, 1);
  const Imf::Header& header = in.header();
  const PixelRect display = rect_of(header.displayWindow(), header.displayWindow().min);
  ImageInfo info{display.width(),
                 display.height(),
                 rect_of(header.dataWindow(), header.displayWindow().min),
                 format_of(header.channels()),
                 {}};
  for (auto i = header.begin(); i != header.end(); ++i)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute()))
      info.attributes[i.name()] = without_padding(text->value());
  return info;
}

void check_exr(std::FILE* file) {
  ExrInput stream(file);
  Imf::InputFile in(stream, 1);
  const Imath::Box2i& window = in.header().dataWindow();
  // One row of memory for all: only that every row can be read is of interest.
  std::vector<float> row(static_cast<size_t>(rect_of(window, window.min).width()));
  Imf::FrameBuffer buffer;
  const Imf::ChannelList& channels = in.header().channels();
  for (auto i = channels.begin(); i != channels.end(); ++i) {
    const Imf::Channel& channel = i.channel();
    const ptrdiff_t first = Imath::divp(window.min.x, channel.xSampling);
    char* base = reinterpret_cast<char*>(row.data()) - first * static_cast<ptrdiff_t>(sizeof(float));
    buffer.insert(i.name(),
                  Imf::Slice(Imf::FLOAT, base, sizeof(float), 0, channel.xSampling, channel.ySampling));
  }
  in.setFrameBuffer(buffer);
  for (int64_t y = window.min.y; y <= window.max.y; y += kRowsAtOnce)
    in.readPixels(static_cast<int>(y),
                  static_cast<int>(std::min<int64_t>(y + kRowsAtOnce - 1, window.max.y)));
}

}  // namespace rayfarm
