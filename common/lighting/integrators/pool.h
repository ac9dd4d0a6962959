#pragma once
// Records by number, in places that are used again. References are invalid once a record is added.
#include <cstdint>
#include <vector>

namespace rayfarm {

template <typename T>
class Pool {
 public:
  T& operator[](uint32_t place) { return records_[place]; }
  /// Makes a record of the arguments.
  template <typename... Arguments>
  uint32_t add(const Arguments&... arguments) {
    if (free_.empty()) {
      records_.emplace_back(arguments...);
      return static_cast<uint32_t>(records_.size() - 1);
    }
    const uint32_t place = free_.back();
    free_.pop_back();
    std::construct_at(&records_[place], arguments...);
    return place;
  }
  void release(uint32_t place) { free_.push_back(place); }
  void clear() {
    records_.clear();
    free_.clear();
  }

 private:
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  std::vector<T> records_;
  std::vector<uint32_t> free_;
};

}  // namespace rayfarm
