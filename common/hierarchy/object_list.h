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

/// A thread has one list, of which walks within walks have a piece each. Take all of it by `take_nearest`, or
/// all by `take_last`.
class ObjectList {
 public:
  ObjectList();
  ~ObjectList() { all_.resize(begin_); }
  ObjectList(const ObjectList&) = delete;
  ObjectList& operator=(const ObjectList&) = delete;

  bool is_empty() const { return all_.size() == begin_; }
  void push(const ListedObject& object) { all_.push_back(object); }
  /// Of those at equal distance the one that is first in the tree.
  ListedObject take_nearest();
  ListedObject take_last() {
    const ListedObject last = all_.back();
    all_.pop_back();
    return last;
  }

 private:
  std::vector<ListedObject>& all_;
  size_t begin_;  ///< of this walk's piece
};

}  // namespace rayfarm
