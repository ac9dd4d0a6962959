#include "common/description/formats/density_grid.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>

#include "common/description/scene_description.h"
#include "common/errors/input_error.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

static_assert(std::endian::native == std::endian::little);

struct TypeInfo {
  const char* name;
  size_t bytes;
  double scale;
};
constexpr TypeInfo kTypes[] = {{"uint8", 1, 255}, {"uint16", 2, 65535}, {"float32", 4, 1}};

double number_at(const char* data, DensityType type, bool is_big_endian) {
  if (type == DensityType::uint8) return static_cast<unsigned char>(*data);
  std::array<char, 4> bytes{};
  const size_t size = kTypes[static_cast<size_t>(type)].bytes;
  std::copy(data, data + size, bytes.begin());
  if (is_big_endian) std::reverse(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
  if (type == DensityType::uint16) {
    uint16_t value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  float value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

/// `data`: of the file `path`, all of it.
DensityGrid densities_of(std::string_view data, const std::string& path, const DensityLayout& layout,
                         const std::stop_token& stop) {
  const auto& [nx, ny, nz] = layout.cells;
  const TypeInfo& type = kTypes[static_cast<size_t>(layout.type)];
  const uint64_t count = uint64_t{nx} * ny * nz;
  if (data.size() != count * type.bytes)
    throw InputError({path}, fmt::format("{} × {} × {} cells of {} are {} bytes, but {} are there", nx, ny,
                                         nz, type.name, count * type.bytes, data.size()));
  DensityGrid grid;
  grid.cells = layout.cells;
  grid.values.reserve(count);
  grid.files = {path};
  for (uint64_t i = 0; i < count; ++i) {
    if (i % nx == 0) throw_if_stopped(stop);
    const double value = number_at(data.data() + i * type.bytes, layout.type, layout.is_big_endian);
    if (!(value >= 0 && std::isfinite(value)))
      throw InputError({path}, fmt::format("the density at [{}, {}, {}] is {:g}; densities must be 0 or more",
                                           i % nx, i / nx % ny, i / nx / ny, value));
    grid.values.push_back(static_cast<float>(value / type.scale));
  }
  return grid;
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// The header of an NRRD file, field by field.
class NrrdHeader {
 public:
  NrrdHeader(std::string_view text, const std::string& path) : text_(text), path_(path) {
    if (!text.starts_with("NRRD000")) fail("it is no NRRD file: it does not begin with NRRD000");
    if (text.size() < 8 || text[7] < '1' || text[7] > '5') fail("NRRD files are read of versions 1 to 5");
    next_line();
    while (at_ < text_.size()) {
      const std::string_view line = trimmed(next_line());
      if (line.empty()) break;                                                    // the data follow
      if (line[0] == '#' || line.find(":=") != std::string_view::npos) continue;  // comments, keys of others
      const size_t colon = line.find(':');
      if (colon == std::string_view::npos) fail("a field of the form `name: value` was expected");
      const std::string name = short_name(line.substr(0, colon));
      if (!fields_.emplace(name, Field{std::string(trimmed(line.substr(colon + 1))), line_}).second)
        fail(fmt::format("the field `{}` stands here twice", name));
    }
  }

  /// Where the data begin that are attached.
  size_t end() const { return at_; }
  /// The field's value; it is used.
  std::optional<std::string> find(const char* name) {
    const auto found = fields_.find(name);
    if (found == fields_.end()) return std::nullopt;
    line_ = found->second.line;
    const std::string value = found->second.value;
    fields_.erase(found);
    return value;
  }
  std::string require(const char* name) {
    auto value = find(name);
    if (!value) throw InputError({path_}, fmt::format("its header lacks the field `{}`", name));
    return *value;
  }
  std::vector<std::string> unused() const {
    std::vector<std::string> names;
    for (const auto& [name, _] : fields_) names.push_back(name);
    return names;
  }
  /// At the line of the field that was found last.
  [[noreturn]] void fail(const std::string& problem) const { throw InputError({path_, line_}, problem); }

 private:
  struct Field {
    std::string value;
    int line;
  };

  std::string_view next_line() {
    ++line_;
    const size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (line.size() > 10'000) fail("a line of its header is longer than 10,000 bytes");
    if (line_ > 1000) fail("its header has no end: an empty line");
    return line;
  }
  /// Lower case, without the blanks that some names are written with and others not: `data file`, `datafile`.
  static std::string short_name(std::string_view name) {
    std::string result;
    for (const char c : name)
      if (c != ' ' && c != '\t') result += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return result;
  }

  std::string_view text_;
  const std::string& path_;
  size_t at_ = 0;
  int line_ = 0;
  std::map<std::string, Field> fields_;
};

DensityType type_of(const NrrdHeader& header, const std::string& name) {
  for (const char* other : {"uchar", "unsigned char", "uint8", "uint8_t"})
    if (name == other) return DensityType::uint8;
  for (const char* other : {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"})
    if (name == other) return DensityType::uint16;
  if (name == "float") return DensityType::float32;
  header.fail(fmt::format("its numbers are of the type '{}'; save them as uchar, ushort or float", name));
}

std::array<uint32_t, 3> sizes_of(const NrrdHeader& header, std::string_view text, uint64_t most_cells) {
  std::array<uint32_t, 3> cells{};
  uint64_t left = most_cells;
  for (uint32_t& n : cells) {
    text = trimmed(text);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
    if (error != std::errc{} || n < 1) header.fail("`sizes` must be three whole numbers from 1 on");
    if (n > left) header.fail(fmt::format("the grid has more cells than there is room for, {}", most_cells));
    left /= n;
    text.remove_prefix(static_cast<size_t>(end - text.data()));
  }
  if (!trimmed(text).empty()) header.fail("`sizes` must be three whole numbers from 1 on");
  return cells;
}

}  // namespace

DensityGrid load_raw_densities(const std::string& path, const DensityLayout& layout,
                               const std::stop_token& stop) {
  return densities_of(read_file(path, limits::kFileBytes, stop), path, layout, stop);
}

DensityGrid load_nrrd(const std::string& path, uint64_t most_cells, const std::stop_token& stop) {
  const std::string bytes = read_file(path, limits::kFileBytes, stop);
  NrrdHeader header(bytes, path);
  if (const std::string axes = header.require("dimension"); axes != "3")
    header.fail(fmt::format("a density has three axes, not {}", axes));
  DensityLayout layout;
  layout.cells = sizes_of(header, header.require("sizes"), most_cells);
  layout.type = type_of(header, header.require("type"));
  if (const std::string encoding = header.require("encoding"); encoding != "raw")
    header.fail(fmt::format("its encoding is '{}'; save it as raw (`unu save -f nrrd -e raw`)", encoding));
  if (layout.type != DensityType::uint8) {
    const std::string endian = header.require("endian");
    if (endian != "little" && endian != "big") header.fail("`endian` must be little or big");
    layout.is_big_endian = endian == "big";
  } else {
    header.find("endian");  // of single bytes it says nothing
  }
  for (const char* skip : {"lineskip", "byteskip"})
    if (const auto n = header.find(skip); n && *n != "0")
      header.fail(fmt::format("`{}` is not supported; save the data without other text before them", skip));
  std::optional<std::string> beside = header.find("datafile");
  DensityGrid grid;
  if (beside) {
    if (beside->starts_with("LIST") || beside->find('%') != std::string::npos)
      header.fail("its data are in several files; save them as one");
    const std::string data = (std::filesystem::path(path).parent_path() / *beside).string();
    try {
      grid = load_raw_densities(data, layout, stop);
    } catch (const IoError& e) {
      header.fail(e.what());
    }
    grid.files.insert(grid.files.begin(), path);
  } else {
    grid = densities_of(std::string_view(bytes).substr(header.end()), path, layout, stop);
  }
  grid.ignored = header.unused();
  return grid;
}

}  // namespace rayfarm
