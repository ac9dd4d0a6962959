#include "common/image/exr_file.h"

#include <ImathBox.h>
#include <ImathFun.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>

namespace rayfarm {
namespace {

constexpr int kRowsAtOnce = 64;  // a multiple of what ZIP compresses together

[[noreturn]] void fail(int error) {
  throw std::runtime_error(std::strerror(error ? error : EIO));
}

/// OpenEXR's own streams open files by their names; these use one that is open.
class Output : public Imf::OStream {
 public:
  explicit Output(std::FILE* file) : OStream("the file"), file_(file) {}
  void write(const char bytes[], int count) override {
    const auto size = static_cast<size_t>(count);
    errno = 0;
    if (std::fwrite(bytes, 1, size, file_) != size) fail(errno);
  }
  uint64_t tellp() override { return static_cast<uint64_t>(ftello(file_)); }
  void seekp(uint64_t position) override {
    if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) fail(errno);
  }

 private:
  std::FILE* file_;
};

class Input : public Imf::IStream {
 public:
  explicit Input(std::FILE* file) : IStream("the file"), file_(file) { seekg(0); }
  bool read(char bytes[], int count) override {
    const auto size = static_cast<size_t>(count);
    errno = 0;
    if (std::fread(bytes, 1, size, file_) != size) {
      if (std::ferror(file_)) fail(errno);
      throw std::runtime_error("the file ends too early");
    }
    const int next = std::getc(file_);
    if (next != EOF) std::ungetc(next, file_);
    return next != EOF;
  }
  uint64_t tellg() override { return static_cast<uint64_t>(ftello(file_)); }
  void seekg(uint64_t position) override {
    if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) fail(errno);
  }
  void clear() override { std::clearerr(file_); }

 private:
  std::FILE* file_;
};

/// A channel of the file, in rows of interleaved values.
struct Column {
  std::string name;
  Imf::PixelType type;
  size_t offset_bytes;            ///< in the pixel
  std::optional<size_t> channel;  ///< of the image; none: 1 everywhere
};

class Columns {
 public:
  /// The image's channels, and alpha. RGB8 becomes half.
  explicit Columns(const PixelLayout& layout) {
    for (size_t i = 0; i < layout.channels.size(); ++i)
      add(std::string(layout.channels[i].name), type_of(layout.channels[i].format), i);
    if (const auto red = layout.find("R")) add("A", type_of(layout.channels[*red].format), std::nullopt);
  }
  std::span<const Column> list() const { return columns_; }

  /// Where the columns lie in rows of a window's pixels, from row `y0` on.
  Imf::FrameBuffer slices(std::vector<char>& rows, int x0, int y0, int width) const {
    const size_t y_stride = bytes_ * static_cast<size_t>(width);
    Imf::FrameBuffer buffer;
    for (const Column& column : columns_) {
      // OpenEXR addresses pixels by their coordinates, so the base lies before the data for rows off the
      // origin.
      char* base = rows.data() + column.offset_bytes -
                   static_cast<ptrdiff_t>(x0) * static_cast<ptrdiff_t>(bytes_) -
                   static_cast<ptrdiff_t>(y0) * static_cast<ptrdiff_t>(y_stride);
      buffer.insert(column.name, Imf::Slice(column.type, base, bytes_, y_stride));
    }
    return buffer;
  }

  /// Rows of the image, from `first` of the window's on.
  void convert_rows(const Image& image, int first, int count, std::vector<char>& rows) const {
    const auto width = static_cast<size_t>(image.window.width());
    const size_t from = static_cast<size_t>(first) * width, pixels = static_cast<size_t>(count) * width;
    rows.resize(bytes_ * pixels);
    char* out = rows.data();
    for (size_t i = 0; i < pixels; ++i, out += bytes_)
      for (const Column& column : columns_) {
        const auto value =
            column.channel ? static_cast<float>(channel_value(image, from + i, *column.channel)) : 1.0f;
        if (column.type == Imf::HALF) {
          const Imath::half half(value);
          std::memcpy(out + column.offset_bytes, &half, sizeof half);
        } else {
          std::memcpy(out + column.offset_bytes, &value, sizeof value);
        }
      }
  }

 private:
  static Imf::PixelType type_of(PixelFormat format) {
    return format == PixelFormat::float32 ? Imf::FLOAT : Imf::HALF;
  }
  void add(const std::string& name, Imf::PixelType type, std::optional<size_t> channel) {
    columns_.push_back({name, type, bytes_, channel});
    bytes_ += type == Imf::HALF ? sizeof(Imath::half) : sizeof(float);
  }

  std::vector<Column> columns_;
  size_t bytes_ = 0;  ///< of a pixel
};

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

void write_exr(std::FILE* file, const Image& image, const std::map<std::string, std::string>& attributes) {
  const PixelRect& w = image.window;
  const Imath::Box2i display({0, 0}, {image.width_px - 1, image.height_px - 1});
  const Imath::Box2i data({w.x0, w.y0}, {w.x1 - 1, w.y1 - 1});
  Imf::Header header(display, data, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  const Columns columns(image.layout);
  for (const Column& column : columns.list())
    header.channels().insert(column.name, Imf::Channel(column.type));
  Imf::addChromaticities(header, Imf::Chromaticities());  // Rec. ITU-R BT.709-3
  for (const auto& [name, value] : attributes) header.insert(name, Imf::StringAttribute(value));

  std::vector<char> rows, back;
  {
    Output stream(file);
    Imf::OutputFile out(stream, header, 1);
    for (int y = 0; y < w.height(); y += kRowsAtOnce) {
      const int count = std::min(kRowsAtOnce, w.height() - y);
      columns.convert_rows(image, y, count, rows);
      out.setFrameBuffer(columns.slices(rows, w.x0, w.y0 + y, w.width()));
      out.writePixels(count);
    }
  }
  Input stream(file);
  Imf::InputFile in(stream, 1);
  for (int y = 0; y < w.height(); y += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, w.height() - y);
    columns.convert_rows(image, y, count, rows);
    back.assign(rows.size(), 0);
    in.setFrameBuffer(columns.slices(back, w.x0, w.y0 + y, w.width()));
    in.readPixels(w.y0 + y, w.y0 + y + count - 1);
    if (rows != back) throw std::runtime_error("what was read back differs from what was written");
  }
}

ImageInfo read_exr_info(std::FILE* file) {
  Input stream(file);
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
      info.attributes[i.name()] = text->value();
  return info;
}

void check_exr(std::FILE* file) {
  Input stream(file);
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
