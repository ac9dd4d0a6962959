#include "node/results.h"

#include <utility>

#include "protocol/block_codec.h"
#include "protocol/byte_codec.h"

namespace rayfarm {
namespace {

void send_pixels(Transport& transport, NodeId self, const DisplayPolygon& polygon,
                 const SubpolygonReport& report, const Bytes& pixels) {
  ByteWriter writer;
  size_t i = 0;
  for (int y = polygon.top; y <= polygon.bottom; ++y)
    for (int x = polygon.left; x <= polygon.right; ++x, i += 3) {
      append_pixel(processor_of(self),
                   {static_cast<uint16_t>(x),
                    static_cast<uint16_t>(y),
                    {static_cast<uint8_t>(pixels[i]), static_cast<uint8_t>(pixels[i + 1]),
                     static_cast<uint8_t>(pixels[i + 2])}},
                   writer);
      if (writer.size() == kPixelsPerTransfer * kPixelBytes)
        transport.send(kHost, Channel::pixels, std::exchange(writer, {}).take());
    }
  if (writer.size() > 0) transport.send(kHost, Channel::pixels, writer.take());
  transport.send(kHost, SubpolygonDone{report});
}

void send_block(Transport& transport, NodeId self, bool compresses, const DisplayPolygon& polygon,
                const SubpolygonReport& report, uint16_t pass, const ItemResult& result) {
  const Bytes& pixels = result.bytes;
  const int width = polygon.right - polygon.left + 1, height = polygon.bottom - polygon.top + 1;
  BlockResult block{report, false, pixels, pass, result.running};
  Bytes compressed;
  if (compresses) {
    compressed = compress_rgb8(pixels, width, height);
    if (compressed.size() < pixels.size()) {
      block.is_compressed = true;
      block.pixels = compressed;
    }
  }
  transport.send(kHost, Channel::command, encode_block(processor_of(self), block));
}

}  // namespace

void send_subpolygon(Transport& transport, NodeId self, const JobPlan& plan, const DisplayPolygon& polygon,
                     const SubpolygonReport& report, uint16_t pass, const ItemResult& result) {
  if (plan.wire == Wire::pixel)
    send_pixels(transport, self, polygon, report, result.bytes);
  else
    send_block(transport, self, plan.compresses, polygon, report, pass, result);
}

void send_zones(Transport& transport, NodeId self, ZoneResult result, const Bytes& bytes) {
  const std::optional<Bytes> compressed = compress_bytes(bytes);
  result.is_compressed = compressed.has_value();
  result.bytes = compressed ? *compressed : bytes;
  transport.send(kHost, Channel::command, encode_zone_result(processor_of(self), result));
}

}  // namespace rayfarm
