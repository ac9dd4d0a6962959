#pragma once
// A vector of bounded length that lives where it is declared and, unlike std::array, costs nothing to
// declare.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

namespace rayfarm {

template <typename T, size_t kCapacity>
class InlineVector {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  InlineVector() {}  // leaves the storage as it is
  InlineVector(const InlineVector& other) { *this = other; }
  InlineVector& operator=(const InlineVector& other) {
    size_ = other.size_;
    std::copy(other.begin(), other.end(), data());
    return *this;
  }

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool is_full() const { return size_ == kCapacity; }
  void clear() { size_ = 0; }
  /// There must be room.
  T& push_back(const T& value) { return *std::construct_at(data() + size_++, value); }
  /// Makes the element in place of the arguments.
  template <typename... Arguments>
  T& emplace_back(Arguments&&... arguments) {
    return *std::construct_at(data() + size_++, std::forward<Arguments>(arguments)...);
  }
  /// Sets the length without setting the elements, which the caller then assigns.
  void resize_for_overwrite(size_t size) { size_ = size; }

  T* data() { return reinterpret_cast<T*>(storage_); }
  const T* data() const { return reinterpret_cast<const T*>(storage_); }
  T& operator[](size_t i) { return data()[i]; }
  const T& operator[](size_t i) const { return data()[i]; }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  std::span<const T> span() const { return {data(), size_}; }
  std::span<T> span() { return {data(), size_}; }

 private:
  alignas(T) std::byte storage_[kCapacity * sizeof(T)];
  size_t size_ = 0;
};

}  // namespace rayfarm
