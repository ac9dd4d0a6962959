#pragma once
// Changes bytes at random; the same random numbers give the same bytes.
#include <algorithm>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace rayfarm::fuzz {

class Mutator {
 public:
  /// `keeps_size`: bytes are changed where they stand.
  Mutator(uint64_t seed, const std::vector<std::string>& words, bool keeps_size)
      : random_(seed), words_(words), keeps_size_(keeps_size) {}

  /// Changes `input` a few times; `other` gives pieces to insert.
  std::string mutate(std::string input, const std::string& other) {
    constexpr size_t kLargest = 1 << 18;
    for (size_t changes = 1 + below(6); changes > 0; --changes) change(input, other);
    if (input.size() > kLargest) input.resize(kLargest);
    return input;
  }
  size_t below(size_t n) { return n ? random_() % n : 0; }

 private:
  void change(std::string& s, const std::string& other) {
    switch (below(keeps_size_ ? 3 : 9)) {
      case 0:
        if (!s.empty()) s[below(s.size())] ^= static_cast<char>(1 << below(8));
        break;
      case 1:
        if (!s.empty()) s[below(s.size())] = static_cast<char>(random_());
        break;
      case 2:  // a number at the edge of its type, little-endian
        for (size_t at = below(s.size()), n = size_t{1} << below(4), i = 0; i < n && at + i < s.size(); ++i)
          s[at + i] = static_cast<char>(below(2) ? 0xff : i + 1 == n ? 0x7f : 0);
        break;
      case 3: {
        const size_t at = below(s.size() + 1);
        s.erase(at, 1 + below(std::min<size_t>(s.size() - at + 1, 64)));
        break;
      }
      case 4:  // a piece again
        if (!s.empty()) {
          const size_t at = below(s.size());
          s.insert(below(s.size()), s.substr(at, 1 + below(64)));
        }
        break;
      case 5:
        if (!other.empty()) s.insert(below(s.size() + 1), other.substr(below(other.size()), 1 + below(64)));
        break;
      case 6:
      case 7:
        if (!words_.empty()) s.insert(below(s.size() + 1), words_[below(words_.size())]);
        break;
      default:
        if (below(4) == 0) s.resize(below(s.size() + 1));
    }
  }

  std::mt19937_64 random_;
  const std::vector<std::string>& words_;
  bool keeps_size_;
};

}  // namespace rayfarm::fuzz
