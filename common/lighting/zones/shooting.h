#pragma once
// Progressive refinement (Shirley, Sung and Brown 1991, section 3; Cohen and others 1988) in rounds: what
// host and nodes agree on. In a round zones send all that they have not sent (Jacobi's order), or the one
// that has most does.
#include "common/lighting/zones/power.h"
#include "common/lighting/zones/zone_scene.h"

namespace rayfarm {

enum class ZoneStageKind : uint8_t {
  light,      ///< zones measure what comes from sources: units are cells
  mirrors,    ///< what comes from sources to mirrors and glass goes on as rays: units are these
  emit,       ///< luminous zones send what they emit, if that is asked for: units are rays
  shoot,      ///< zones send: units are rays
  count_hits  ///< rays from zones count which zones they see: units are cells
};

/// What a stage's data begin with.
struct ZoneStageHead {
  ZoneStageKind kind = ZoneStageKind::light;
  uint32_t pass = 0, round = 0;
  ZoneQuantum quantum;
  double rays = 0, first = 1;  ///< of the first round: so many rays for so much power
};
void write(PackedWriter& out, const ZoneStageHead& head);
/// Throws std::runtime_error.
ZoneStageHead read_stage_head(PackedReader& in, size_t passes);

/// Slots that send together: the directions of a zone's side, or of a medium's cell; a diffuse slot is alone.
struct ZoneSender {
  uint64_t first_slot = 0;
  size_t first = 0, count = 0;  ///< of those that have something, among all such slots
  double power = 0;             ///< of all channels
};

/// The first of the slots that a slot sends together with.
uint64_t sender_of(const ZoneScene& zones, uint64_t slot);

/// Gathers slots, which come as they rise, into senders.
class ZoneSenders {
 public:
  explicit ZoneSenders(const ZoneScene& zones) : zones_(zones) {}
  void add(uint64_t slot, const Power& unsent);
  std::span<const ZoneSender> all() const { return senders_; }

 private:
  const ZoneScene& zones_;
  std::vector<ZoneSender> senders_;
  size_t slots_ = 0;
};

/// How many rays a sender sends: in every round as many for the same power.
inline uint64_t ray_count(const ZoneSender& sender, const ZoneStageHead& head) {
  return static_cast<uint64_t>(std::max(1.0, std::ceil(head.rays * (sender.power / head.first))));
}

/// Sides of cells at which light goes on along mirrors and through glass.
class MirrorUnits {
 public:
  explicit MirrorUnits(const ZoneMap& map);
  uint64_t count() const { return count_; }
  struct Unit {
    const ZoneGrid* grid = nullptr;
    uint32_t cell = 0, side = 0;
  };
  Unit operator[](uint64_t unit) const;

 private:
  const ZoneMap& map_;
  std::vector<std::pair<uint64_t, uint32_t>> first_of_grid_;
  uint64_t count_ = 0;
};

/// True if light that meets the material may go on in lobes that zones of this grid do not keep.
bool is_followed_at(const Scene& scene, const Material& material, const ZoneGrid& grid);

}  // namespace rayfarm
