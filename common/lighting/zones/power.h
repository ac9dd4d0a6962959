#pragma once
// Power as integers: sums of it are the same in any order (quanta; ZoneQuantum tells what one is worth). And
// how lists of it travel.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

/// Of each channel.
struct Power {
  std::array<int64_t, 3> quanta{};

  int64_t& operator[](size_t c) { return quanta[c]; }
  int64_t operator[](size_t c) const { return quanta[c]; }
  Power& operator+=(const Power& other) {
    for (size_t c = 0; c < 3; ++c) quanta[c] += other.quanta[c];
    return *this;
  }
  Power& operator-=(const Power& other) {
    for (size_t c = 0; c < 3; ++c) quanta[c] -= other.quanta[c];
    return *this;
  }
  bool is_zero() const { return quanta == std::array<int64_t, 3>{}; }
  double total() const {
    return static_cast<double>(quanta[0]) + static_cast<double>(quanta[1]) + static_cast<double>(quanta[2]);
  }
  bool operator==(const Power&) const = default;
};

/// The part of `power` that is left, to the nearest quantum.
inline Power scaled(const Power& power, const Color& by) {
  Power result;
  for (size_t c = 0; c < 3; ++c)
    result[c] =
        static_cast<int64_t>(std::floor(static_cast<double>(power[c]) * by[static_cast<int>(c)] + 0.5));
  return result;
}

/// All primary power is so many quanta: sums of it have room in 63 bits as long as light is sent on fewer
/// than kMostSendings times.
inline constexpr double kQuanta = 0x1p52, kMostSendings = 1000;
/// What is told as one power before it is added up: all that there is, and something for rounding.
inline constexpr int64_t kMostAtOnce = int64_t{1} << 54;
inline bool is_possible(const Power& power) {
  for (const int64_t q : power.quanta)
    if (q > kMostAtOnce || q < -kMostAtOnce) return false;
  return true;
}

/// What one quantum is worth.
struct ZoneQuantum {
  std::array<double, 3> worth{};

  ZoneQuantum() = default;
  explicit ZoneQuantum(const Color& primary)
      : worth{primary.x / kQuanta, primary.y / kQuanta, primary.z / kQuanta} {}

  Color value(const Power& power) const {
    return {static_cast<double>(power[0]) * worth[0], static_cast<double>(power[1]) * worth[1],
            static_cast<double>(power[2]) * worth[2]};
  }
  Power quantized(const Color& power) const {
    Power result;
    for (size_t c = 0; c < 3; ++c) {
      if (!(worth[c] > 0)) continue;
      const double quanta = std::floor(power[static_cast<int>(c)] / worth[c] + 0.5);
      if (!(quanta <= static_cast<double>(kMostAtOnce)))
        throw std::runtime_error("a zone has more power than there is");
      result[c] = static_cast<int64_t>(quanta);
    }
    return result;
  }
};

/// Sums of many slots, in pages that are made when power first arrives in them: the inside of a closed body
/// never has any.
class PowerSums {
 public:
  explicit PowerSums(uint64_t slots) : pages_((slots + kPage - 1) / kPage), slots_(slots) {}

  uint64_t slots() const { return slots_; }
  Power& operator[](uint64_t slot) {
    std::unique_ptr<Page>& page = pages_[slot / kPage];
    if (!page) page = std::make_unique<Page>();
    return (*page)[slot % kPage];
  }
  Power at(uint64_t slot) const {
    const std::unique_ptr<Page>& page = pages_[slot / kPage];
    return page ? (*page)[slot % kPage] : Power();
  }
  /// Calls visit(slot, power) for all that are not 0, as slots rise.
  template <typename Visit>
  void for_each(Visit visit) const {
    for (size_t p = 0; p < pages_.size(); ++p)
      if (pages_[p])
        for (size_t i = 0; i < kPage; ++i)
          if (!(*pages_[p])[i].is_zero()) visit(p * kPage + i, (*pages_[p])[i]);
  }
  void clear() {
    for (auto& page : pages_) page.reset();
  }

 private:
  static constexpr size_t kPage = 128;
  using Page = std::array<Power, kPage>;
  std::vector<std::unique_ptr<Page>> pages_;
  uint64_t slots_;
};

/// Writes numbers of any size in as few bytes as they need.
class PackedWriter {
 public:
  void number(uint64_t x) {
    for (; x >= 0x80; x >>= 7) bytes_.push_back(static_cast<std::byte>(x | 0x80));
    bytes_.push_back(static_cast<std::byte>(x));
  }
  void integer(int64_t x) { number(static_cast<uint64_t>(x) << 1 ^ static_cast<uint64_t>(x >> 63)); }
  void real(double x) {
    const auto bits = std::bit_cast<uint64_t>(x);
    for (int i = 0; i < 8; ++i) bytes_.push_back(static_cast<std::byte>(bits >> 8 * i));
  }
  void color(const Color& c) {
    for (int i = 0; i < 3; ++i) real(c[i]);
  }
  void power(const Power& p) {
    for (const int64_t q : p.quanta) integer(q);
  }
  /// All that is not 0.
  void sums(const PowerSums& sums);
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Throws std::runtime_error where the bytes end too soon or hold what was never written.
class PackedReader {
 public:
  /// Of what is told as one power.
  static constexpr int64_t kMostQuanta = int64_t{1} << 61;

  explicit PackedReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  uint64_t number();
  int64_t integer() {
    const uint64_t x = number();
    return static_cast<int64_t>(x >> 1 ^ (0 - (x & 1)));
  }
  double real();
  /// Finite, and none below 0.
  Color color();
  Power power() {
    Power p;
    for (int64_t& q : p.quanta) {
      q = integer();
      if (q > kMostQuanta || q < -kMostQuanta) throw damaged();
    }
    return p;
  }
  /// As PackedWriter::sums: calls visit(slot, power).
  template <typename Visit>
  void sums(uint64_t slots, Visit visit) {
    const uint64_t count = number();
    uint64_t next = 0;
    for (uint64_t i = 0; i < count; ++i) {
      const uint64_t skipped = number();
      if (skipped >= slots - next) throw damaged();
      next += skipped;
      visit(next, power());
      ++next;
    }
  }
  bool at_end() const { return bytes_.empty(); }
  void expect_end() const {
    if (!at_end()) throw damaged();
  }
  static std::runtime_error damaged() { return std::runtime_error("what is told of zones is damaged"); }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace rayfarm
