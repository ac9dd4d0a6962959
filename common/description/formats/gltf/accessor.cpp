#include "common/description/formats/gltf/accessor.h"

#include <fmt/core.h>

#include <cstring>

#include "common/description/scene_description.h"

namespace rayfarm {
namespace {

struct ElementShape {
  const char* name;
  size_t components;
};
constexpr ElementShape kElementShapes[] = {
    {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};

}  // namespace

size_t GltfAccessor::bytes_of(Type type) {
  switch (type) {
    case Type::int8:
    case Type::uint8:
      return 1;
    case Type::int16:
    case Type::uint16:
      return 2;
    case Type::uint32:
    case Type::float32:
      break;
  }
  return 4;
}

GltfAccessor::Type GltfAccessor::type_of(const GltfValue& owner, bool is_index) const {
  const GltfValue value = owner.at("componentType");
  const uint64_t code = value.whole_number();
  const bool is_known = is_index ? code == 5121 || code == 5123 || code == 5125
                                 : (code >= 5120 && code <= 5123) || code == 5125 || code == 5126;
  if (!is_known) value.fail(fmt::format("{} is no type of {}", code, is_index ? "indices" : "components"));
  return static_cast<Type>(code);
}

GltfAccessor::GltfAccessor(const GltfFile& file, uint32_t index)
    : file_(file), value_(file.item("accessors", index)) {
  type_ = type_of(value_, false);
  is_normalized_ = value_.boolean("normalized", false);
  const uint64_t count = value_.at("count").whole_number();
  if (count < 1 || count > limits::kFaceCorners)
    value_.at("count").fail(
        fmt::format("a number from 1 to {} was expected, not {}", limits::kFaceCorners, count));
  count_ = count;
  const std::string shape = value_.at("type").text();
  for (const ElementShape& known : kElementShapes)
    if (shape == known.name) components_ = known.components;
  if (components_ == 0) value_.at("type").fail(fmt::format("'{}' is not read here", shape.substr(0, 30)));
  if (value_.has("bufferView")) view_ = elements(value_, count_, components_ * component_bytes(), true);
  if (const auto sparse = value_.find("sparse")) {
    const uint64_t replaced = sparse->at("count").whole_number();
    if (replaced > count_) sparse->fail("it replaces more elements than there are");
    sparse_count_ = replaced;
    const GltfValue indices = sparse->at("indices");
    sparse_type_ = type_of(indices, true);
    sparse_indices_ = elements(indices, sparse_count_, bytes_of(sparse_type_), false);
    sparse_values_ = elements(sparse->at("values"), sparse_count_, components_ * component_bytes(), false);
  }
}

GltfAccessor::Elements GltfAccessor::elements(const GltfValue& owner, size_t count, size_t element_bytes,
                                              bool is_strided) const {
  const uint32_t index = owner.index("bufferView", file_.count("bufferViews"));
  if (index == kNone) owner.at("bufferView");
  const GltfFile::View view = file_.view(index);
  const uint64_t offset = owner.whole_number("byteOffset", 0);
  const size_t stride = is_strided && view.stride > 0 ? view.stride : element_bytes;
  if (stride < element_bytes)
    owner.fail(
        fmt::format("its elements of {} bytes overlap, as the byteStride is {}", element_bytes, stride));
  if (count > 0 && (offset > view.bytes.size() || view.bytes.size() - offset < element_bytes ||
                    count - 1 > (view.bytes.size() - offset - element_bytes) / stride))
    owner.fail(
        fmt::format("its {} elements are not all in its bufferView, which has {} bytes; the file is "
                    "damaged or cut off",
                    count, view.bytes.size()));
  return {view.bytes.subspan(std::min<uint64_t>(offset, view.bytes.size())), stride};
}

GltfAccessor GltfAccessor::of_vertices(const GltfFile& file, const GltfValue& owner, const char* key,
                                       size_t vertices, std::initializer_list<size_t> components) {
  const uint32_t index = owner.index(key, file.count("accessors"));
  if (index == kNone) owner.at(key);
  GltfAccessor accessor(file, index);
  accessor.expect_components(components);
  if (accessor.count() != vertices)
    owner.at(key).fail(
        fmt::format("it has {} elements, but the primitive has {} vertices", accessor.count(), vertices));
  return accessor;
}

void GltfAccessor::expect_components(std::initializer_list<size_t> allowed) const {
  if (std::find(allowed.begin(), allowed.end(), components_) == allowed.end())
    value_.fail(fmt::format("its elements have {} component{}, which don't fit what it is used for",
                            components_, components_ == 1 ? "" : "s"));
}

template <typename Stored, typename T>
void GltfAccessor::copy(const Elements& from, size_t components, std::span<const uint32_t> which,
                        std::span<T> to, double scale) {
  const size_t count = to.size() / components;
  for (size_t i = 0; i < count; ++i) {
    const std::byte* const element = from.bytes.data() + (which.empty() ? i : which[i]) * from.stride;
    for (size_t c = 0; c < components; ++c) {
      Stored stored;
      std::memcpy(&stored, element + c * sizeof(Stored), sizeof(Stored));
      if constexpr (std::is_same_v<T, float>) {
        // The smallest signed integer is -1, too (glTF 2.0, 3.11).
        const double value = scale * static_cast<double>(stored);
        to[i * components + c] = static_cast<float>(scale < 1 ? std::max(value, -1.0) : value);
      } else {
        to[i * components + c] = static_cast<T>(stored);
      }
    }
  }
}

template <typename T>
void GltfAccessor::read_elements(const Elements& from, std::span<const uint32_t> which,
                                 std::span<T> to) const {
  const auto scale = [&](double largest) { return is_normalized_ ? 1 / largest : 1.0; };
  switch (type_) {
    case Type::int8:
      return copy<int8_t>(from, components_, which, to, scale(127));
    case Type::uint8:
      return copy<uint8_t>(from, components_, which, to, scale(255));
    case Type::int16:
      return copy<int16_t>(from, components_, which, to, scale(32767));
    case Type::uint16:
      return copy<uint16_t>(from, components_, which, to, scale(65535));
    case Type::uint32:
      return copy<uint32_t>(from, components_, which, to, scale(4294967295.0));
    case Type::float32:
      if constexpr (std::is_same_v<T, float>) copy<float>(from, components_, which, to, 1);
  }
}

std::vector<uint32_t> GltfAccessor::replaced() const {
  std::vector<uint32_t> indices(sparse_count_);
  const std::span<uint32_t> to(indices);
  if (sparse_type_ == Type::uint8)
    copy<uint8_t>(sparse_indices_, 1, {}, to, 1);
  else if (sparse_type_ == Type::uint16)
    copy<uint16_t>(sparse_indices_, 1, {}, to, 1);
  else
    copy<uint32_t>(sparse_indices_, 1, {}, to, 1);
  for (size_t i = 0; i < indices.size(); ++i)
    if (indices[i] >= count_ || (i > 0 && indices[i] <= indices[i - 1]))
      value_.at("sparse").fail(fmt::format(
          "its {}. index, {}, is not above the one before, or beyond the last element", i + 1, indices[i]));
  return indices;
}

std::vector<float> GltfAccessor::replacements() const {
  std::vector<float> values(sparse_count_ * components_);
  read_elements<float>(sparse_values_, {}, values);
  return values;
}

template <typename T>
void GltfAccessor::read_all(std::span<T> to, std::span<const uint32_t> which) const {
  if (view_)
    read_elements(*view_, which, to);
  else
    std::fill(to.begin(), to.end(), T(0));
  if (sparse_count_ == 0) return;
  const std::vector<uint32_t> indices = replaced();
  std::vector<T> values(sparse_count_ * components_);
  read_elements<T>(sparse_values_, {}, values);
  const auto set = [&](size_t element, size_t replacement) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(replacement * components_), components_,
                to.begin() + static_cast<std::ptrdiff_t>(element * components_));
  };
  if (which.empty()) {
    for (size_t i = 0; i < indices.size(); ++i) set(indices[i], i);
    return;
  }
  for (size_t k = 0; k < which.size(); ++k) {
    const auto found = std::lower_bound(indices.begin(), indices.end(), which[k]);
    if (found != indices.end() && *found == which[k]) set(k, static_cast<size_t>(found - indices.begin()));
  }
}

void GltfAccessor::read(std::span<float> to, std::span<const uint32_t> which) const {
  read_all(to, which);
}

void GltfAccessor::read(std::span<uint32_t> to, std::span<const uint32_t> which) const {
  if (type_ != Type::uint8 && type_ != Type::uint16 && type_ != Type::uint32)
    value_.fail("unsigned integers were expected");
  read_all(to, which);
}

}  // namespace rayfarm
