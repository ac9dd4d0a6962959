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
  /// Of one ray in one collection.
  struct Search {
    uint64_t number;
    /// Where the numbers of each PointerKind begin, less where the collection's own begin in the scene.
    std::array<size_t, 3> first;
  };

  /// Threads have one each, so that none waits for another. It is as large as the largest collection.
  static Mailbox& of_this_thread();
  Search begin_search(const Collection& collection);
  /// True for the first time in a search. Searches in searches only forget what the outer ones tested.
  bool take(const PrimitivePointer& pointer, const Search& search) {
    uint64_t& last = last_search_[search.first[static_cast<size_t>(pointer.kind())] + pointer.place()];
    if (last == search.number) return false;
    last = search.number;
    return true;
  }

 private:
  std::vector<uint64_t> last_search_;
  uint64_t searches_ = 0;
};

}  // namespace rayfarm
