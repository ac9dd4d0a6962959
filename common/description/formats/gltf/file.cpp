#include "common/description/formats/gltf/file.h"

#include <fmt/core.h>
#include <meshoptimizer.h>
#include <openssl/evp.h>

#include <cstring>
#include <filesystem>

#include "common/description/scene_description.h"
#include "common/files/read_file.h"
#include "common/image/image_file.h"

namespace rayfarm {
namespace {

constexpr uintmax_t kMostJsonBytes = 1ull << 30;  // binary data may stand in it, as base64
constexpr uint64_t kLeastElementBytes = 3;        // of a triangle, by indices of a byte
/// Those that are made of the same bytes several times.
constexpr uint64_t kRepeatedElements = 1'000'000;
constexpr uint64_t kMostZeros = 64'000'000;
/// Of meshes that nodes have of their own: some 20 million triangles.
constexpr double kMostCopiedBytes = 4.0 * (1ull << 30);

uint32_t word_at(const std::string& bytes, size_t at) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof(word));  // little-endian, as all machines that this runs on
  return word;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// "%20" is a blank.
std::string percent_decoded(const GltfValue& owner, const std::string& uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      text += uri[i];
      continue;
    }
    const std::string digits = uri.substr(i + 1, 2);
    if (digits.size() != 2 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
      owner.fail(fmt::format("'{}' is no URI: two hexadecimal digits must follow %", uri.substr(0, 100)));
    text += static_cast<char>(std::stoi(digits, nullptr, 16));
    if (text.back() == '\0') owner.fail("a URI with %00 in it names no file");
    i += 2;
  }
  return text;
}

std::string base64_decoded(const GltfValue& owner, std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::string padded(text);
  padded.append((4 - text.size() % 4) % 4, '=');
  std::string bytes(padded.size() / 4 * 3, '\0');
  const int size = text.size() % 4 == 1 || padded.size() > (1u << 30)
                       ? -1
                       : EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                         reinterpret_cast<const unsigned char*>(padded.data()),
                                         static_cast<int>(padded.size()));
  if (size < 0) owner.fail("its data is no base64; the file is damaged or cut off");
  bytes.resize(static_cast<size_t>(size) - (padded.size() - text.size()));
  return bytes;
}

}  // namespace

GltfFile::GltfFile(const std::string& path, const LoadOptions& options) : path_(path), options_(options) {
  const bool is_glb = extension_of(path) == ".glb";
  std::string text = read_file(path, is_glb ? limits::kFileBytes : kMostJsonBytes, options.stop);
  count_opened(options.progress, text.size());
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InputError({path_}, text.empty() ? "the file is empty; export it anew"
                                           : "there is nothing but blanks in the file; export it anew");
  if (is_glb && text.size() < 4)
    throw InputError({path_},
                     "it is too short for a binary glTF, whose header has 12 bytes; the file is "
                     "damaged or cut off");
  if (text.starts_with("glTF")) {
    glb_ = std::move(text);
    open_glb();
  } else {
    std::string_view json = text;
    refuse_wide_text(path_, json);
    if (json.starts_with("\xef\xbb\xbf")) json.remove_prefix(3);
    json_ = parse_gltf_json(json, path_);
    count_read(options.progress, text.size());
  }
  const GltfValue asset = root().at("asset");
  const std::string version = asset.at("version").text(), least = asset.text("minVersion", "2.0");
  if (!version.starts_with("2."))
    throw InputError({path_}, fmt::format("it is of glTF {}, but glTF 2.0 is what is read; export it as that",
                                          version.substr(0, 20)));
  if (least != "2.0")
    throw InputError({path_},
                     fmt::format("its asset.minVersion asks for a reader of glTF {}, but glTF 2.0 is "
                                 "what is read; export it for that",
                                 least.substr(0, 20)));
  buffers_.resize(count("buffers"));
  decoded_.resize(count("bufferViews"));
}

void GltfFile::open_glb() {
  const auto damaged = [&](const char* what) {
    throw InputError({path_}, fmt::format("{}; the file is damaged or cut off", what));
  };
  if (glb_.size() < 20) damaged("it ends before its first chunk");
  if (const uint32_t version = word_at(glb_, 4); version != 2)
    throw InputError({path_},
                     fmt::format("it is a binary glTF of version {}, but 2 is what is read", version));
  const size_t end = word_at(glb_, 8);
  if (end > glb_.size()) damaged("it is shorter than its header says");
  if (end < 20) damaged("its header leaves no room for a chunk");
  for (size_t at = 12; at + 8 <= end;) {
    const size_t size = word_at(glb_, at);
    if (size > end - at - 8) damaged("a chunk is longer than the file");
    const std::string_view type = std::string_view(glb_).substr(at + 4, 4);
    std::string_view chunk = std::string_view(glb_).substr(at + 8, size);
    if (!json_) {
      if (type != "JSON") damaged("its first chunk is not JSON");
      while (!chunk.empty() && (chunk.back() == '\0' || chunk.back() == ' ')) chunk.remove_suffix(1);
      json_ = parse_gltf_json(chunk, path_);
    } else if (type == std::string_view("BIN\0", 4)) {
      chunk_ = bytes_of(glb_).subspan(at + 8, size);
      break;
    }
    at += 8 + size;
  }
  if (!json_) damaged("it has no JSON");
  count_read(options_.progress, glb_.size());
}

size_t GltfFile::count(const char* list) const {
  const auto all = root().find(list);
  return all ? all->size() : 0;
}

GltfValue GltfFile::item(const char* list, size_t i) const {
  return root().at(list)[i];
}

std::string GltfFile::name_of(const GltfValue& value) const {
  const std::string name = value.text("name", "");
  return name.empty() ? value.where() : name.substr(0, 200);
}

std::optional<std::string> GltfFile::path_of_uri(const GltfValue& uri) const {
  const std::string& text = uri.text();
  if (text.starts_with("data:")) return std::nullopt;
  if (text.find("://") != std::string::npos)
    uri.fail(fmt::format("'{}' is not read; fetch it, and name it by its place beside the file",
                         text.substr(0, 100)));
  return (std::filesystem::path(path_).parent_path() / percent_decoded(uri, text)).string();
}

void GltfFile::fail_of_uri(const GltfValue& uri, std::string_view problem) const {
  const std::string& text = uri.text();
  const bool is_absolute = text.starts_with('/') || text.starts_with("file:") ||
                           (text.size() > 1 && text[1] == ':') || text.find('\\') != std::string::npos;
  uri.fail(fmt::format("{}{}", problem,
                       is_absolute ? "; a URI here is a path from this file on, with `/` between folders: "
                                     "put what it names beside the file, and name it so"
                                   : ""));
}

std::span<const std::byte> GltfFile::bytes_of_uri(const GltfValue& uri) const {
  const auto path = path_of_uri(uri);
  if (!path) {
    const auto [known, is_new] = data_uris_.try_emplace(uri.where());
    if (!is_new) return known->second;
    const std::string_view text = uri.text();
    const size_t comma = text.find(',');
    if (comma == std::string_view::npos || !text.substr(0, comma).ends_with(";base64"))
      uri.fail("a URI with data in it must hold it as base64");
    known->second = bytes_of(contents_.emplace_back(base64_decoded(uri, text.substr(comma + 1))));
    return known->second;
  }
  try {
    contents_.push_back(read_file(*path, limits::kFileBytes, options_.stop));
  } catch (const IoError& e) {
    fail_of_uri(uri, e.what());
  }
  count_opened(options_.progress, contents_.back().size());
  count_read(options_.progress, contents_.back().size());
  files_.push_back(*path);
  return bytes_of(contents_.back());
}

std::span<const std::byte> GltfFile::buffer(uint32_t index, const GltfValue& user) const {
  if (index == kNone) user.at("buffer");
  std::optional<std::span<const std::byte>>& known = buffers_[index];
  if (known) return *known;
  const GltfValue value = item("buffers", index);
  const uint64_t size = value.at("byteLength").whole_number();
  const auto uri = value.find("uri");
  if (!uri && (index > 0 || glb_.empty())) value.fail("it has no `uri`, and so no bytes");
  const std::span<const std::byte> bytes = uri ? bytes_of_uri(*uri) : chunk_;
  if (bytes.size() < size)
    value.fail(
        fmt::format("of its {} bytes {} are there; the file is damaged or cut off", size, bytes.size()));
  buffer_bytes_ += size;
  return *(known = bytes.first(size));
}

GltfFile::View GltfFile::view(uint32_t index) const {
  const GltfValue value = item("bufferViews", index);
  if (const auto compression = value.extension("EXT_meshopt_compression")) {
    std::optional<View>& known = decoded_[index];
    if (!known) known = decoded(value, *compression);
    return *known;
  }
  const std::span<const std::byte> bytes = buffer(value.index("buffer", count("buffers")), value);
  const uint64_t offset = value.whole_number("byteOffset", 0), size = value.at("byteLength").whole_number();
  if (offset > bytes.size() || size > bytes.size() - offset)
    value.fail(fmt::format("its bytes {} to {} are not all in its buffer, which has {}", offset,
                           offset + size, bytes.size()));
  const uint64_t stride = value.whole_number("byteStride", 0);
  if (stride > 65'536) value.fail("its byteStride is too large");
  return {bytes.subspan(offset, size), stride};
}

GltfFile::View GltfFile::decoded(const GltfValue& view, const GltfValue& compression) const {
  const std::span<const std::byte> bytes = buffer(compression.index("buffer", count("buffers")), compression);
  const uint64_t offset = compression.whole_number("byteOffset", 0),
                 size = compression.at("byteLength").whole_number(),
                 stride = compression.at("byteStride").whole_number(),
                 count = compression.at("count").whole_number();
  if (offset > bytes.size() || size > bytes.size() - offset)
    compression.fail("its bytes are not all in its buffer");
  const std::string mode = compression.at("mode").text(), filter = compression.text("filter", "NONE");
  const bool is_attributes = mode == "ATTRIBUTES";
  constexpr uint64_t kMostGain = 256;  // of the codec: beyond it the count is damaged
  if (stride == 0 || stride > 256 || (is_attributes && stride % 4 != 0) ||
      (!is_attributes && stride != 2 && stride != 4) || count > kMostGain * size / stride + 16 ||
      (mode == "TRIANGLES" && count % 3 != 0))
    compression.fail("its count or byteStride is damaged");
  std::string& result = contents_.emplace_back(count * stride, '\0');
  const auto* from = reinterpret_cast<const unsigned char*>(bytes.data() + offset);
  const int problem =
      is_attributes         ? meshopt_decodeVertexBuffer(result.data(), count, stride, from, size)
      : mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(result.data(), count, stride, from, size)
      : mode == "INDICES"   ? meshopt_decodeIndexSequence(result.data(), count, stride, from, size)
                            : 1;
  if (problem != 0) compression.fail("its bytes can't be decoded; the file is damaged or cut off");
  if (is_attributes && filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    meshopt_decodeFilterOct(result.data(), count, stride);
  else if (is_attributes && filter == "QUATERNION" && stride == 8)
    meshopt_decodeFilterQuat(result.data(), count, stride);
  else if (is_attributes && filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(result.data(), count, stride);
  else if (filter != "NONE")
    compression.fail(fmt::format("its filter '{}' can't be undone", filter.substr(0, 30)));
  buffer_bytes_ += result.size();
  return {bytes_of(result), view.whole_number("byteStride", 0)};
}

size_t GltfFile::morph_targets(uint32_t mesh) const {
  const GltfValue primitives = item("meshes", mesh).at("primitives");
  const auto targets = primitives.size() > 0 ? primitives[0].find("targets") : std::nullopt;
  return targets ? targets->size() : 0;
}

size_t GltfFile::find_choice(const char* kind, const std::string& wanted,
                             const std::vector<std::string>& names) const {
  if (const auto named = std::find(names.begin(), names.end(), wanted); named != names.end())
    return static_cast<size_t>(named - names.begin());
  if (wanted.size() < 10 && wanted.find_first_not_of("0123456789") == std::string::npos)
    if (const size_t number = std::stoul(wanted); number < names.size()) return number;
  std::string list;
  for (size_t i = 0; i < names.size() && i < 50; ++i)
    list += fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, names[i]);
  throw InputError({path_}, fmt::format("there is no {} '{}' ({}){}", kind, wanted,
                                        names.empty() ? "the file has none" : "it has " + list,
                                        suggestion(wanted, names)));
}

void GltfFile::take_elements(const GltfValue& owner, uint64_t count) const {
  elements_ += count;
  if (elements_ > buffer_bytes_ / kLeastElementBytes + kRepeatedElements)
    owner.fail(
        "the file's meshes use the same data over and over, so that they have too many faces; give several "
        "nodes one mesh instead of several meshes the same data");
}

void GltfFile::take_copies(const GltfValue& owner, double bytes) const {
  copied_bytes_ += bytes;
  if (copied_bytes_ > kMostCopiedBytes)
    owner.fail(fmt::format(
        "each node with a skin or morph targets bends a copy of its mesh of its own, and those of "
        "this file would take {:.1f} GiB, where {:.0f} are allowed; use fewer such nodes, meshes of "
        "fewer triangles or skins of fewer joints (copies by EXT_mesh_gpu_instancing share one "
        "morphed shape)",
        copied_bytes_ / (1ull << 30), kMostCopiedBytes / (1ull << 30)));
}

void GltfFile::take_zeros(const GltfValue& owner, uint64_t values) const {
  zeros_ += std::min(values, kMostZeros + 1);
  if (zeros_ > kMostZeros)
    owner.fail(
        fmt::format("it has no bufferView, and with it more than {} values of the file are said to be "
                    "zero; the file is damaged",
                    kMostZeros));
}

}  // namespace rayfarm
