#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "common/files/regular_file.h"
#include "common/image/exr_file.h"
#include "common/image/exr_streams.h"

namespace rayfarm {
namespace {

/// A chunk of the file: what ZIP compresses together (OpenEXR's file layout, "Compression").
constexpr int kChunkRows = 16;
/// Before a chunk's data: its first row and its size, four bytes each.
constexpr size_t kChunkHeadBytes = 8;

[[noreturn]] void fail_as_different() {
  throw std::runtime_error("what was read back differs from what was written");
}

/// A channel of the file, in rows of interleaved values.
struct Column {
  std::string name;
  Imf::PixelType type;
  size_t offset_bytes;                  ///< in the pixel
  std::optional<PixelChannel> channel;  ///< of the image; none: 1 everywhere
};

class Columns {
 public:
  /// The image's channels, and alpha. RGB8 becomes half.
  explicit Columns(const PixelLayout& layout) : from_bytes_(layout.bytes) {
    for (const PixelChannel& channel : layout.channels)
      add(std::string(channel.name), type_of(channel.format), channel);
    if (const auto red = layout.find("R")) add("A", type_of(layout.channels[*red].format), std::nullopt);
  }
  std::span<const Column> list() const { return columns_; }
  /// Of a pixel.
  size_t bytes() const { return bytes_; }

  /// Where the columns lie in rows of a window's pixels, from row `y0` on.
  Imf::FrameBuffer slices(char* rows, int x0, int y0, int width) const {
    const size_t y_stride = bytes_ * static_cast<size_t>(width);
    Imf::FrameBuffer buffer;
    for (const Column& column : columns_) {
      // OpenEXR addresses pixels by their coordinates, so the base lies before the data for rows off the
      // origin.
      char* base = rows + column.offset_bytes - static_cast<ptrdiff_t>(x0) * static_cast<ptrdiff_t>(bytes_) -
                   static_cast<ptrdiff_t>(y0) * static_cast<ptrdiff_t>(y_stride);
      buffer.insert(column.name, Imf::Slice(column.type, base, bytes_, y_stride));
    }
    return buffer;
  }

  /// The image's pixels as the file has them.
  void convert(std::span<const std::byte> pixels, char* out) const {
    for (; !pixels.empty(); pixels = pixels.subspan(from_bytes_), out += bytes_)
      for (const Column& column : columns_) {
        const auto value =
            column.channel ? static_cast<float>(decode_value(*column.channel, pixels.data())) : 1.0f;
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
  void add(const std::string& name, Imf::PixelType type, std::optional<PixelChannel> channel) {
    columns_.push_back({name, type, bytes_, channel});
    bytes_ += type == Imf::HALF ? sizeof(Imath::half) : sizeof(float);
  }

  size_t from_bytes_;  ///< of the image's pixel
  std::vector<Column> columns_;
  size_t bytes_ = 0;
};

/// What is missing of a value that comes at the end.
std::string padded(std::string value) {
  value.resize(kLateAttributeBytes, ' ');
  return value;
}

Imf::Header make_header(const Image& image, const Columns& columns,
                        const std::map<std::string, std::string>& attributes) {
  const PixelRect& w = image.window;
  const Imath::Box2i display({0, 0}, {image.width_px - 1, image.height_px - 1});
  const Imath::Box2i data({w.x0, w.y0}, {w.x1 - 1, w.y1 - 1});
  Imf::Header header(display, data, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  for (const Column& column : columns.list())
    header.channels().insert(column.name, Imf::Channel(column.type));
  Imf::addChromaticities(header, Imf::Chromaticities());  // Rec. ITU-R BT.709-3
  for (const auto& [name, value] : attributes) header.insert(name, Imf::StringAttribute(value));
  return header;
}

/// A file without its end has an empty table of where its chunks are, and OpenEXR would read all of it to
/// find them. They are found here as they are written, and what is read back is read by a table of our own;
/// the file's is compared with it at the end, and read by for the last rows.
class ExrWriter : public RowWriter {
 public:
  ExrWriter(std::FILE* file, const Image& image, std::map<std::string, std::string> attributes,
            const std::vector<std::string>& late)
      : file_(file), window_(image.window), columns_(image.layout), stream_(file) {
    for (const std::string& name : late) attributes[name] = padded("");
    attributes_ = std::move(attributes);
    out_.emplace(stream_, make_header(image, columns_, attributes_), 1);
    next_chunk_ = stream_.tellp();
    const int chunks = (window_.height() + kChunkRows - 1) / kChunkRows;
    table_.resize(8 * static_cast<size_t>(chunks));
    table_begin_ = next_chunk_ - table_.size();
    // None of those that are not there is asked for; 0 would have OpenEXR look for them.
    for (int i = 0; i < chunks; ++i) set_place(i, next_chunk_);

    row_bytes_ = columns_.bytes() * static_cast<size_t>(window_.width());
    from_row_bytes_ = image.layout.bytes * static_cast<size_t>(window_.width());
    const auto whole_chunks = static_cast<int>(kReadBackBytes / row_bytes_) / kChunkRows;
    most_rows_ = std::min(window_.height(), kChunkRows * std::max(1, whole_chunks));
    rows_.resize(row_bytes_ * static_cast<size_t>(most_rows_));
  }

  void write_rows(std::span<const std::byte> rows) override {
    while (!rows.empty()) {
      const int there = static_cast<int>(
          std::min<size_t>(rows.size() / from_row_bytes_, static_cast<size_t>(most_rows_ - held_)));
      const size_t bytes = from_row_bytes_ * static_cast<size_t>(there);
      columns_.convert(rows.first(bytes), rows_.data() + row_bytes_ * static_cast<size_t>(held_));
      rows = rows.subspan(bytes);
      out_->setFrameBuffer(slices(rows_));
      out_->writePixels(there);
      held_ += there;
      // The last are read when the file is whole.
      if (held_ < most_rows_ || first_ + held_ == window_.height()) continue;
      find_chunks();
      ExrInput stream(file_, {table_begin_, table_});
      Imf::InputFile in(stream, 1);
      read_back(in);
      first_ += held_;
      held_ = 0;
    }
  }

  void finish(const std::map<std::string, std::string>& late) override {
    out_.reset();
    for (const auto& [name, value] : late) fill_in(name, attributes_[name] = padded(value));
    find_chunks();
    std::vector<std::byte> table(table_.size());
    if (read_at(file_, table_begin_, table) != table.size() || table != table_) fail_as_different();
    ExrInput stream(file_);
    Imf::InputFile in(stream, 1);
    if (!in.isComplete()) fail_as_different();
    for (const auto& [name, value] : attributes_) {
      const auto* const attribute = in.header().findTypedAttribute<Imf::StringAttribute>(name);
      if (!attribute || attribute->value() != value) fail_as_different();
    }
    read_back(in);
  }

 private:
  void set_place(int chunk, uint64_t place) {
    for (size_t i = 0; i < 8; ++i)
      table_[8 * static_cast<size_t>(chunk) + i] = static_cast<std::byte>(place >> 8 * i & 0xff);
  }
  Imf::FrameBuffer slices(std::vector<char>& rows) const {
    return columns_.slices(rows.data(), window_.x0, window_.y0 + first_, window_.width());
  }

  /// All that is written leaves for the file, and the table takes in where the chunks of rows held are.
  void find_chunks() {
    if (std::fflush(file_) != 0) throw std::runtime_error(std::strerror(errno));
    for (int row = first_; row < first_ + held_; row += kChunkRows) {
      std::array<std::byte, kChunkHeadBytes> head;
      if (read_at(file_, next_chunk_, head) != head.size()) fail_as_different();
      const auto number = [&head](size_t at) {
        uint32_t value = 0;
        for (size_t i = 0; i < 4; ++i) value |= static_cast<uint32_t>(head[at + i]) << 8 * i;
        return value;
      };
      if (static_cast<int>(number(0)) != window_.y0 + row) fail_as_different();
      set_place(row / kChunkRows, next_chunk_);
      next_chunk_ += kChunkHeadBytes + number(4);
    }
  }

  /// The rows held are the file's.
  void read_back(Imf::InputFile& in) {
    back_.assign(row_bytes_ * static_cast<size_t>(held_), 0);
    in.setFrameBuffer(slices(back_));
    in.readPixels(window_.y0 + first_, window_.y0 + first_ + held_ - 1);
    if (std::memcmp(back_.data(), rows_.data(), back_.size()) != 0) fail_as_different();
  }

  /// Writes the value where the header has room for it.
  void fill_in(const std::string& name, const std::string& value) {
    std::string entry = name;
    entry += '\0';
    entry += "string";
    entry += '\0';
    for (size_t i = 0; i < 4; ++i) entry += static_cast<char>(kLateAttributeBytes >> 8 * i & 0xff);
    if (std::fflush(file_) != 0) throw std::runtime_error(std::strerror(errno));
    std::string header(table_begin_, '\0');
    read_at(file_, 0, std::as_writable_bytes(std::span(header)));
    const size_t at = header.find(entry + padded(""));
    if (at == std::string::npos) fail_as_different();
    stream_.seekp(at + entry.size());
    stream_.write(value.data(), static_cast<int>(value.size()));
  }

  std::FILE* file_;
  PixelRect window_;
  std::map<std::string, std::string> attributes_;  ///< as the file has them
  Columns columns_;
  ExrOutput stream_;
  std::optional<Imf::OutputFile> out_;
  uint64_t table_begin_ = 0;
  std::vector<std::byte> table_;  ///< as the file will have it: where its chunks are
  uint64_t next_chunk_ = 0;       ///< the place of the first that `table_` does not have
  size_t row_bytes_ = 0, from_row_bytes_ = 0;
  int most_rows_ = 0;       ///< held
  int first_ = 0;           ///< row held
  int held_ = 0;            ///< rows that are written and were not read back
  std::vector<char> rows_;  ///< with room for `most_rows_`
  std::vector<char> back_;
};

}  // namespace

std::unique_ptr<RowWriter> make_exr_writer(std::FILE* file, const Image& image,
                                           const std::map<std::string, std::string>& attributes,
                                           const std::vector<std::string>& late) {
  return std::make_unique<ExrWriter>(file, image, attributes, late);
}

}  // namespace rayfarm
