#pragma once
// The mailbox (Arnaldi, Priol and Bouatouch 1987; Amanatides and Woo 1987; Shirley, Sung and Brown 1991,
// 2.3.3): "avoid multiple ray-object intersection calculation between the same object and the same ray in
// different spatial cell units".
#include <vector>

#include "common/scene/scene.h"

namespace rayfarm {

/// With each primitive the number of the last search that tested it. The result is in the search itself: the
/// hit so far, which a second test of the same primitive can't beat.
class Mailbox {
 public:
  /// Threads have one each, so that none waits for another.
  static Mailbox& of_this_thread();
  /// Of one ray in one collection; the number that it has.
  uint64_t begin_search(const Scene& scene);
  /// True for the first time in a search.
  bool take(const PrimitivePointer& pointer, uint64_t search) {
    uint64_t& last = last_search_[first_[static_cast<size_t>(pointer.kind())] + pointer.place()];
    if (last == search) return false;
    last = search;
    return true;
  }

 private:
  std::vector<uint64_t> last_search_;  ///< by where primitives stand in blocks, and in leaf_primitives
  std::array<size_t, 3> first_{};      ///< of each PointerKind
  uint64_t searches_ = 0;
};

}  // namespace rayfarm
