#pragma once
// The work of a job: phases, one after the other, decided as it goes. A phase goes in steps that are begun in
// order, and a step has items, which any node can do; how many is all that the assignment of work knows.
#include <algorithm>
#include <variant>
#include <vector>

#include "protocol/index.h"
#include "protocol/subpolygons.h"

namespace rayfarm {

/// Pictures: a step is a pass of a frame, most often the only one, and an item one of its subpolygons. Passes
/// of a frame follow each other; each goes on from what the one before gave.
struct PicturesPhase {
  std::vector<FrameNumber> frames;  ///< in the order in which they are rendered
  SubpolygonGrid grid;              ///< of every frame
  FrameIndex first;                 ///< of the job's frames: from there on interleaved sets have moved
  int passes = 1;                   ///< of each frame

  static constexpr int kMostPasses = 1000;

  int steps() const { return static_cast<int>(frames.size()) * passes; }
  int items_per_step() const { return grid.count(); }
  bool has(ItemIndex item) const {
    return item.value() >= 0 && item.value() < int64_t{steps()} * items_per_step();
  }
  StepIndex step_of(FrameIndex frame, int pass) const { return StepIndex(frame.value() * passes + pass); }
  StepIndex step_of(ItemIndex item) const {
    return StepIndex(static_cast<int>(item.value() / items_per_step()));
  }
  FrameIndex frame_of(StepIndex step) const { return FrameIndex(step.value() / passes); }
  int pass_of(StepIndex step) const { return step.value() % passes; }
  ItemIndex item_of(StepIndex step, SubpolygonId subpolygon) const {
    return ItemIndex(int64_t{step.value()} * items_per_step() + subpolygon.value());
  }
  FrameIndex frame_of(ItemIndex item) const { return frame_of(step_of(item)); }
  SubpolygonId subpolygon_of(ItemIndex item) const {
    return SubpolygonId(static_cast<int>(item.value() % items_per_step()));
  }
  FrameNumber number_of(ItemIndex item) const { return frames[frame_of(item).place()]; }
  DisplayPolygon polygon_of(ItemIndex item) const { return grid.polygon(subpolygon_of(item)); }
};

/// A stage in which light is spread over zones: one step, whose items are ranges of its units.
struct ZonePhase {
  FrameNumber frame;            ///< whose pose it is
  uint64_t units = 1;           ///< at most kMostUnits
  uint64_t units_per_item = 1;  ///< the last item has what is left

  /// Units are addressed by 32 bits.
  static constexpr uint64_t kMostUnits = uint64_t{1} << 32;

  int64_t items() const { return static_cast<int64_t>((units + units_per_item - 1) / units_per_item); }
  bool has(ItemIndex item) const { return item.value() >= 0 && item.value() < items(); }
  UnitRange units_of(ItemIndex item) const {
    const uint64_t first = static_cast<uint64_t>(item.value()) * units_per_item;
    return {static_cast<uint32_t>(first), static_cast<uint32_t>(std::min(first + units_per_item, units) - 1)};
  }
  /// The item that such a range is, or nothing.
  std::optional<ItemIndex> find(const UnitRange& range) const {
    const ItemIndex item(static_cast<int64_t>(range.first / units_per_item));
    return has(item) && units_of(item) == range ? std::optional(item) : std::nullopt;
  }
};

/// Interleaved: the node that does an item of the phase of that number by itself.
inline NodeId zone_owner(uint32_t phase, int processors, ItemIndex item) {
  return NodeId(static_cast<int>((item.value() + phase) % processors) + 1);
}

using Phase = std::variant<PicturesPhase, ZonePhase>;

}  // namespace rayfarm
