#pragma once
// The objects and groups whose volumes a ray meets and that it has still to look into (Weghorst, Hooper and
// Greenberg 1984: the intersection list).
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayfarm {

struct ListedObject {
  double entry;   ///< how far it is
  uint32_t node;  ///< in bounding_nodes
};

/// A thread has one list, of which walks within walks have a piece each: a heap, filled by `add` and emptied
/// by `take_nearest`, or a stack, by `push` and `take_last`.
class ObjectList {
 public:
  ObjectList();
  ~ObjectList() { all_.resize(begin_); }
  ObjectList(const ObjectList&) = delete;
  ObjectList& operator=(const ObjectList&) = delete;

  bool is_empty() const { return all_.size() == begin_; }
  void add(const ListedObject& object);
  /// Of those at equal distance the one that is first in the tree.
  ListedObject take_nearest();
  void push(const ListedObject& object) { all_.push_back(object); }
  ListedObject take_last() {
    const ListedObject last = all_.back();
    all_.pop_back();
    return last;
  }

 private:
  auto begin() { return all_.begin() + static_cast<std::ptrdiff_t>(begin_); }

  std::vector<ListedObject>& all_;
  size_t begin_;  ///< of this walk's piece
};

}  // namespace rayfarm
