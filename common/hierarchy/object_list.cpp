#include "common/hierarchy/object_list.h"

#include <algorithm>

namespace rayfarm {
namespace {

std::vector<ListedObject>& list_of_thread() {
  thread_local std::vector<ListedObject> list;
  return list;
}

}  // namespace

ObjectList::ObjectList() : all_(list_of_thread()), begin_(all_.size()) {}

ListedObject ObjectList::take_nearest() {
  const auto nearest = std::min_element(all_.begin() + static_cast<std::ptrdiff_t>(begin_), all_.end(),
                                        [](const ListedObject& a, const ListedObject& b) {
                                          return a.entry < b.entry || (a.entry == b.entry && a.node < b.node);
                                        });
  const ListedObject taken = *nearest;
  *nearest = all_.back();
  all_.pop_back();
  return taken;
}

}  // namespace rayfarm
