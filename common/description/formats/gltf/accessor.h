#pragma once
// An accessor of a glTF file: vectors or whole numbers in its buffers.
#include "common/description/formats/gltf/file.h"
#include "common/memory/large_vector.h"

namespace rayfarm {

class GltfAccessor {
 public:
  /// Checks that all of its elements are there; the file must outlive it. Throws InputError.
  GltfAccessor(const GltfFile& file, uint32_t index);

  /// What `owner` names under `key`: one of a primitive's `vertices` each. Throws InputError if it is not
  /// there, has other components or another number of elements.
  static GltfAccessor of_vertices(const GltfFile& file, const GltfValue& owner, const char* key,
                                  size_t vertices, std::initializer_list<size_t> components);

  const GltfValue& value() const { return value_; }
  size_t count() const { return count_; }
  size_t components() const { return components_; }
  /// Those of the elements' bytes in the file.
  size_t size_bytes() const { return view_ ? count_ * components_ * component_bytes() : 0; }
  void expect_components(std::initializer_list<size_t> allowed) const;

  /// Sets count × components numbers, those of the elements of `which` in this order, or of all if it is
  /// empty. Integers are taken as they stand, or if they are normalized as parts of the largest.
  void read(std::span<float> to, std::span<const uint32_t> which = {}) const;
  /// The same of unsigned integers.
  void read(std::span<uint32_t> to, std::span<const uint32_t> which = {}) const;
  template <typename T>
  LargeVector<T> all() const {
    check_room();
    LargeVector<T> values(count_ * components_);
    read(std::span<T>(values));
    return values;
  }

  /// Of all elements at once: counts those that no bytes stand behind (GltfFile::take_zeros).
  void check_room() const {
    if (!view_) file_.take_zeros(value_, count_ * components_);
  }

  /// Only some elements are not zero, and the others need not be looked at.
  bool is_mostly_zero() const { return !view_; }
  /// The elements that replace others, in rising order, and their values.
  std::vector<uint32_t> replaced() const;
  std::vector<float> replacements() const;

 private:
  enum class Type { int8 = 5120, uint8, int16, uint16, uint32 = 5125, float32 };
  struct Elements {
    std::span<const std::byte> bytes;
    size_t stride = 0;
  };

  static size_t bytes_of(Type type);
  size_t component_bytes() const { return bytes_of(type_); }
  Type type_of(const GltfValue& owner, bool is_index) const;
  /// Of a bufferView, from an offset on.
  Elements elements(const GltfValue& owner, size_t count, size_t element_bytes, bool is_strided) const;
  template <typename Stored, typename T>
  static void copy(const Elements& from, size_t components, std::span<const uint32_t> which, std::span<T> to,
                   double scale);
  template <typename T>
  void read_elements(const Elements& from, std::span<const uint32_t> which, std::span<T> to) const;
  template <typename T>
  void read_all(std::span<T> to, std::span<const uint32_t> which) const;

  const GltfFile& file_;
  GltfValue value_;
  Type type_ = Type::float32;
  size_t count_ = 0, components_ = 0;
  bool is_normalized_ = false;
  std::optional<Elements> view_;
  Elements sparse_indices_, sparse_values_;
  Type sparse_type_ = Type::uint32;
  size_t sparse_count_ = 0;
};

}  // namespace rayfarm
