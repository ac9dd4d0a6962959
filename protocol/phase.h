#pragma once
// The work of a job: phases, one after the other. A phase goes in steps that are begun in order, and a step
// has items, which any node can do; how many is all that the assignment of work knows.
#include <variant>
#include <vector>

#include "protocol/index.h"
#include "protocol/subpolygons.h"

namespace rayfarm {

/// The pictures of a sequence: a step is a frame, an item one of its subpolygons.
struct PicturesPhase {
  std::vector<FrameNumber> frames;  ///< in the order in which they are rendered
  SubpolygonGrid grid;              ///< of every frame

  int steps() const { return static_cast<int>(frames.size()); }
  int items_per_step() const { return grid.count(); }
  bool has(ItemIndex item) const {
    return item.value() >= 0 && item.value() < int64_t{steps()} * items_per_step();
  }
  ItemIndex item_of(FrameIndex frame, SubpolygonId subpolygon) const {
    return ItemIndex(int64_t{frame.value()} * items_per_step() + subpolygon.value());
  }
  FrameIndex frame_of(ItemIndex item) const {
    return FrameIndex(static_cast<int>(item.value() / items_per_step()));
  }
  SubpolygonId subpolygon_of(ItemIndex item) const {
    return SubpolygonId(static_cast<int>(item.value() % items_per_step()));
  }
  FrameNumber number_of(ItemIndex item) const { return frames[frame_of(item).place()]; }
  DisplayPolygon polygon_of(ItemIndex item) const { return grid.polygon(subpolygon_of(item)); }
};

using Phase = std::variant<PicturesPhase>;

}  // namespace rayfarm
