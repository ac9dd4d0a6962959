#include "common/description/formats/npy_loader.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "common/description/scene_description.h"
#include "common/errors/input_error.h"
#include "common/files/read_file.h"
#include "common/image/half_float.h"

namespace rayfarm {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The file's own description of itself: a Python dictionary of three known keys.
struct Header {
  std::string type;
  bool is_fortran = false;  ///< the first axis varies fastest, else the last
  std::vector<uint64_t> shape;
  size_t data_begin = 0;
};

class NpyHeaderReader {
 public:
  NpyHeaderReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  Header read() {
    if (!bytes_.starts_with("\x93NUMPY") || bytes_.size() < 10) fail("it is no array that numpy.save wrote");
    const auto version = static_cast<unsigned char>(bytes_[6]);
    if (version < 1 || version > 3) fail(fmt::format("its format {} is unknown", version));
    const size_t begin = version == 1 ? 10 : 12;
    size_t length = 0;
    if (bytes_.size() < begin) fail("it is cut off in its header");
    std::memcpy(&length, bytes_.data() + 8, begin - 8);
    if (length > bytes_.size() - begin) fail("it is cut off in its header");
    text_ = bytes_.substr(begin, length);
    Header header;
    header.data_begin = begin + length;
    header.type = quoted(after("'descr':"));
    header.is_fortran = after("'fortran_order':").starts_with("True");
    header.shape = numbers(after("'shape':"));
    return header;
  }

  [[noreturn]] void fail(const std::string& problem) const { throw InputError({path_}, problem); }

 private:
  std::string_view after(std::string_view key) const {
    const size_t at = text_.find(key);
    if (at == std::string_view::npos) fail(fmt::format("its header lacks {}", key));
    std::string_view rest = text_.substr(at + key.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    return rest;
  }
  std::string quoted(std::string_view rest) const {
    const size_t end = rest.starts_with('\'') ? rest.find('\'', 1) : std::string_view::npos;
    if (end == std::string_view::npos) fail("its numbers are of several kinds; save them as one array");
    return std::string(rest.substr(1, end - 1));
  }
  std::vector<uint64_t> numbers(std::string_view rest) const {
    std::vector<uint64_t> result;
    if (!rest.starts_with('(')) fail("its header has no shape");
    while (true) {
      rest.remove_prefix(std::min(rest.find_first_not_of("(, "), rest.size()));
      if (rest.starts_with(')')) return result;
      uint64_t n = 0;
      const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), n);
      if (error != std::errc{}) fail("its header has no shape");
      result.push_back(n);
      rest.remove_prefix(static_cast<size_t>(end - rest.data()));
    }
  }

  std::string_view bytes_, text_;
  const std::string& path_;
};

template <typename T>
double number_at(const char* data) {
  T value;
  std::memcpy(&value, data, sizeof value);
  return static_cast<double>(value);
}

struct NpyType {
  const char* name;
  size_t bytes;
  double (*read)(const char*);
  double scale;
};
constexpr NpyType kNpyTypes[] = {
    {"|u1", 1, number_at<uint8_t>, 255},
    {"<u2", 2, number_at<uint16_t>, 65535},
    {"<f2", 2,
     [](const char* data) { return float_of_half(static_cast<uint16_t>(number_at<uint16_t>(data))); }, 1},
    {"<f4", 4, number_at<float>, 1},
    {"<f8", 8, number_at<double>, 1},
};

}  // namespace

ArrayValues load_npy(const std::string& path, uint64_t most_cells, const std::stop_token& stop) {
  const std::string bytes = read_file(path, limits::kFileBytes, stop);
  NpyHeaderReader reader(bytes, path);
  const Header header = reader.read();
  const auto* const type = std::find_if(std::begin(kNpyTypes), std::end(kNpyTypes),
                                        [&](const NpyType& t) { return t.name == header.type; });
  if (type == std::end(kNpyTypes))
    reader.fail(fmt::format("its numbers are of the type '{}'; save them as float32 or uint8", header.type));
  const std::vector<uint64_t>& shape = header.shape;
  if (shape.size() < 2 || shape.size() > 4 || (shape.size() == 4 && shape[3] != 3))
    reader.fail(
        "it must have two or three axes, x, y and z, or four of which the last is 3: red, green, blue");
  ArrayValues array;
  array.channels = shape.size() == 4 ? 3 : 1;
  uint64_t left = most_cells;
  for (size_t axis = 0; axis < 3; ++axis) {
    const uint64_t n = axis < shape.size() ? shape[axis] : 1;
    if (n < 1 || n > left)
      reader.fail(n < 1 ? "it is empty"
                        : fmt::format("it has more cells than there is room for, {}", most_cells));
    array.size[axis] = static_cast<uint32_t>(n);
    left /= n;
  }
  const uint64_t count = array.cells() * array.channels;
  if (bytes.size() - header.data_begin != count * type->bytes)
    reader.fail(fmt::format("its header speaks of {} bytes of numbers, but {} are there", count * type->bytes,
                            bytes.size() - header.data_begin));
  // How far apart in the file neighbours along each axis are, the last of the channels.
  std::array<uint64_t, 4> step{};
  std::array<uint64_t, 4> size{array.size[0], array.size[1], array.size[2], array.channels};
  uint64_t next = 1;
  for (size_t i = 0; i < 4; ++i) {
    const size_t axis = header.is_fortran ? i : 3 - i;
    step[axis] = next;
    next *= size[axis];
  }
  array.values.reserve(count);
  for (uint64_t z = 0; z < size[2]; ++z)
    for (uint64_t y = 0; y < size[1]; ++y) {
      throw_if_stopped(stop);
      for (uint64_t x = 0; x < size[0]; ++x)
        for (uint64_t c = 0; c < size[3]; ++c) {
          const uint64_t at = x * step[0] + y * step[1] + z * step[2] + c * step[3];
          const double value = type->read(bytes.data() + header.data_begin + at * type->bytes) / type->scale;
          if (!(value >= 0 && value <= 1))
            reader.fail(
                fmt::format("the value at [{}, {}, {}] is {:g}; values must be from 0 to 1", x, y, z, value));
          array.values.push_back(static_cast<float>(value));
        }
    }
  return array;
}

}  // namespace rayfarm
