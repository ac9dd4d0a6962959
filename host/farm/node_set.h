#pragma once
// A set of nodes in the order of their numbers. Whether a node is in it, and which is the next, takes the
// same few looks at memory for one node and for thousands: one bit a node, and above 64 words a bit for each
// that is not 0.
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/index.h"

namespace rayfarm {

class NodeSet {
 public:
  /// For nodes 1 to `most`.
  explicit NodeSet(int most = 0) {
    size_t words = static_cast<size_t>(most) + 1;
    do {
      words = (words + 63) / 64;
      levels_.emplace_back(words);
    } while (words > 1);
  }

  void insert(NodeId node) {
    size_t bit = node.place();
    for (std::vector<uint64_t>& level : levels_) {
      level[bit / 64] |= mask(bit);
      bit /= 64;
    }
  }
  void erase(NodeId node) {
    size_t bit = node.place();
    for (std::vector<uint64_t>& level : levels_) {
      if ((level[bit / 64] &= ~mask(bit)) != 0) return;
      bit /= 64;
    }
  }
  /// The first that is `least` or later.
  std::optional<NodeId> first_from(NodeId least = NodeId(0)) const {
    size_t bit = least.place();
    for (size_t l = 0; l < levels_.size(); ++l) {
      if (bit / 64 >= levels_[l].size()) return std::nullopt;
      const uint64_t rest = levels_[l][bit / 64] & ~(mask(bit) - 1);
      if (rest != 0) return down(l, bit / 64 * 64 + static_cast<size_t>(std::countr_zero(rest)));
      bit = bit / 64 + 1;
    }
    return std::nullopt;
  }

 private:
  static uint64_t mask(size_t bit) { return uint64_t{1} << (bit % 64); }
  NodeId down(size_t level, size_t bit) const {
    for (; level > 0; --level)
      bit = bit * 64 + static_cast<size_t>(std::countr_zero(levels_[level - 1][bit]));
    return NodeId(static_cast<int>(bit));
  }

  std::vector<std::vector<uint64_t>> levels_;  ///< the last is one word
};

}  // namespace rayfarm
