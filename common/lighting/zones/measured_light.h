#pragma once
// The first stage of each lighting model with zones: what zones get straight from sources, as nodes measure
// it and the host reads it.
#include <functional>
#include <map>

#include "common/lighting/zones/power.h"
#include "common/lighting/zones/primary_light.h"
#include "common/lighting/zones/zone_scene.h"

namespace rayfarm {

/// The node's part: of cells [first, first + count), those of media behind those of surfaces. `scene`: in a
/// pass's colours. `pulse` is called after each.
std::vector<std::byte> measure_light(const ZoneScene& zones, const Scene& scene, const ZoneColors& colors,
                                     const Sampler& sampler, const RenderSettings& settings, uint64_t first,
                                     uint64_t count, const std::function<void()>& pulse, RayCounts& counts);

/// The host's part. Sums of doubles are in the order of zones, whatever the order in which items came.
class MeasuredLight {
 public:
  /// `zones` must outlive it.
  explicit MeasuredLight(const ZoneScene& zones) : zones_(zones) {}

  uint64_t units() const { return zones_.map().cell_count() + zones_.media().cell_count(); }
  /// Forgets what there is.
  void begin(uint64_t units_per_item) {
    units_per_item_ = units_per_item;
    items_.clear();
  }
  /// Throws std::runtime_error, with nothing changed, if the bytes are damaged.
  void add(uint64_t item, std::span<const std::byte> result);

  /// Calls visit_cell(followed) once for each cell, with the power that goes on from its surface, and
  /// visit_slot(slot, direct, by_chance) for what its sums keep: power that leaves.
  template <typename VisitCell, typename VisitSlot>
  void for_each(VisitCell visit_cell, VisitSlot visit_slot) const {
    for (const auto& [item, bytes] : items_) read(item, bytes, visit_cell, visit_slot);
  }
  /// Of all that is kept or goes on.
  Color total() const;

 private:
  template <typename VisitCell, typename VisitSlot>
  void read(uint64_t item, std::span<const std::byte> result, VisitCell visit_cell,
            VisitSlot visit_slot) const;
  std::pair<uint64_t, uint64_t> slots_of_cell(uint64_t cell) const;

  const ZoneScene& zones_;
  uint64_t units_per_item_ = 1;
  std::map<uint64_t, std::vector<std::byte>> items_;
};

/// What zones of sources emit that are to shoot, by slot. `scene`: in a pass's colours.
std::vector<std::pair<uint64_t, Color>> find_shot(const ZoneScene& zones, const Scene& scene,
                                                  const ZoneSettings& settings);

template <typename VisitCell, typename VisitSlot>
void MeasuredLight::read(uint64_t item, std::span<const std::byte> result, VisitCell visit_cell,
                         VisitSlot visit_slot) const {
  PackedReader in(result);
  const uint64_t first = item * units_per_item_, end = std::min(units(), first + units_per_item_);
  for (uint64_t i = first; i < end; ++i) {
    const auto [first_slot, slots] = slots_of_cell(i);
    const uint64_t lit = in.number(), has_followed = in.number();
    if (lit > slots || has_followed > 1) throw PackedReader::damaged();
    visit_cell(has_followed ? in.color() : Color(0));
    for (uint64_t s = 0; s < lit; ++s) {
      const uint64_t slot = in.number();
      if (slot >= slots) throw PackedReader::damaged();
      const Color direct = in.color(), by_chance = in.color();
      visit_slot(first_slot + slot, direct, by_chance);
    }
  }
  in.expect_end();
}

}  // namespace rayfarm
