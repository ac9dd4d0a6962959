#include "common/hierarchy/object_list.h"

#include <algorithm>

namespace rayfarm {
namespace {

std::vector<ListedObject>& list_of_thread() {
  thread_local std::vector<ListedObject> list;
  return list;
}

bool is_behind(const ListedObject& a, const ListedObject& b) {
  return a.entry > b.entry || (a.entry == b.entry && a.node > b.node);
}

}  // namespace

ObjectList::ObjectList() : all_(list_of_thread()), begin_(all_.size()) {}

void ObjectList::add(const ListedObject& object) {
  all_.push_back(object);
  std::push_heap(begin(), all_.end(), is_behind);
}

ListedObject ObjectList::take_nearest() {
  std::pop_heap(begin(), all_.end(), is_behind);
  return take_last();
}

}  // namespace rayfarm
