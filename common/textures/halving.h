#pragma once
// How a level of a mip map is made of the one above, along one axis.
#include <algorithm>
#include <cstddef>

namespace rayfarm {

/// Half as many cells, rounded down, over the same length. Of an odd number each covers two whole cells above
/// and parts of others, so that all of these weigh the same, and no level is lighter or darker than another.
class Halving {
 public:
  /// `above`: at least one.
  explicit Halving(size_t above) : above_(above), count_(std::max<size_t>(1, above / 2)) {}

  size_t count() const { return count_; }
  /// The cells above that cell `i` covers, or has a part of.
  size_t begin(size_t i) const { return i * above_ / count_; }
  size_t end(size_t i) const { return ((i + 1) * above_ + count_ - 1) / count_; }
  /// The first and last cell that have a part of cell `k` above.
  size_t first_with(size_t k) const { return k * count_ / above_; }
  size_t last_with(size_t k) const { return ((k + 1) * count_ - 1) / above_; }
  /// What cell `k` above is of cell `i`, from 0 to 1; exactly a half where `above` is even.
  double share(size_t i, size_t k) const {
    const size_t from = std::max(i * above_, k * count_), to = std::min((i + 1) * above_, (k + 1) * count_);
    return static_cast<double>(to - from) / static_cast<double>(above_);
  }

 private:
  size_t above_, count_;
};

}  // namespace rayfarm
