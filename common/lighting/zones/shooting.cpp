#include "common/lighting/zones/shooting.h"

#include "common/lighting/zones/power_rays.h"

namespace rayfarm {

void write(PackedWriter& out, const ZoneStageHead& head) {
  out.number(static_cast<uint64_t>(head.kind));
  out.number(head.pass);
  out.number(head.round);
  for (const double worth : head.quantum.worth) out.real(worth);
  out.real(head.rays);
  out.real(head.first);
}

ZoneStageHead read_stage_head(PackedReader& in, size_t passes) {
  ZoneStageHead head;
  const uint64_t kind = in.number(), pass = in.number(), round = in.number();
  if (kind > static_cast<uint64_t>(ZoneStageKind::count_hits) || pass >= passes || round >= kNone)
    throw PackedReader::damaged();
  head.kind = static_cast<ZoneStageKind>(kind);
  head.pass = static_cast<uint32_t>(pass);
  head.round = static_cast<uint32_t>(round);
  for (double& worth : head.quantum.worth) {
    worth = in.real();
    if (!(worth >= 0) || !std::isfinite(worth)) throw PackedReader::damaged();
  }
  head.rays = in.real();
  head.first = in.real();
  if (!(head.rays >= 0 && head.rays <= 0x1p32 && head.first > 0)) throw PackedReader::damaged();
  return head;
}

uint64_t sender_of(const ZoneScene& zones, uint64_t slot) {
  const ZoneMap& map = zones.map();
  if (slot < map.slot_count()) {
    const SlotPlace place = map.place_of_slot(slot);
    return place.direction == 0 ? slot : slot - place.direction + 1;
  }
  const uint64_t in_media = slot - map.slot_count();
  const MediumGrid& grid = zones.media().grid_of_slot(in_media);
  return slot - (in_media - grid.first_slot) % grid.directions.count();
}

void ZoneSenders::add(uint64_t slot, const Power& unsent) {
  const uint64_t first = sender_of(zones_, slot);
  if (senders_.empty() || senders_.back().first_slot != first) senders_.push_back({first, slots_, 0, 0});
  ++senders_.back().count;
  senders_.back().power += unsent.total();
  ++slots_;
}

bool is_followed_at(const Scene& scene, const Material& material, const ZoneGrid& grid) {
  if (material.kind == MaterialKind::mix)
    return is_followed_at(scene, scene.materials[material.parts[0]], grid) ||
           is_followed_at(scene, scene.materials[material.parts[1]], grid);
  for (const bool is_front : {true, false}) {
    const Interaction at{Vec3(0, 0, 1), Vec3(0, 0, 1), is_front,
                         is_front ? material.index : 1 / material.index};
    Lobes lobes;
    scatter(material, at, lobes);
    if (!followed_lobes(&grid, material, at, lobes).empty()) return true;
  }
  return false;
}

MirrorUnits::MirrorUnits(const ZoneMap& map) : map_(map) {
  const std::span<const ZoneGrid> grids = map.grids();
  for (uint32_t i = 0; i < grids.size(); ++i) {
    const ZoneGrid& grid = grids[i];
    if (grid.shape == ZoneShape::none ||
        !is_followed_at(map.scene(), map.scene().materials[grid.material], grid))
      continue;
    first_of_grid_.emplace_back(count_, i);
    count_ += uint64_t{2} * grid.cell_count;
  }
}

MirrorUnits::Unit MirrorUnits::operator[](uint64_t unit) const {
  const auto found = std::upper_bound(first_of_grid_.begin(), first_of_grid_.end(), unit,
                                      [](uint64_t u, const auto& entry) { return u < entry.first; });
  const auto& [first, grid] = *(found - 1);
  const auto in_grid = static_cast<uint32_t>(unit - first);
  return {&map_.grids()[grid], in_grid / 2, in_grid % 2};
}

}  // namespace rayfarm
