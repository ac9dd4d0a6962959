#pragma once
// Values brought together from where indices lead: a few of them on the stack, any number otherwise.
#include <array>
#include <span>
#include <vector>

#include "common/math/inline_vector.h"

namespace rayfarm {

template <typename T>
class Gathered {
 public:
  /// `size` values, which the caller then assigns.
  explicit Gathered(size_t size) : size_(size) {
    if (size > kFew)
      many_.resize(size);
    else
      few_.resize_for_overwrite(size);
  }
  size_t size() const { return size_; }
  T& operator[](size_t i) { return size_ > kFew ? many_[i] : few_[i]; }
  std::span<const T> span() const { return size_ > kFew ? std::span<const T>(many_) : few_.span(); }

 private:
  static constexpr size_t kFew = 8;
  size_t size_;
  InlineVector<T, kFew> few_;
  std::vector<T> many_;
};

}  // namespace rayfarm
