#pragma once
// What solver, tracer and pictures know of a scene at one pose.
#include "common/hierarchy/frame_state.h"
#include "common/lighting/coloured_scene.h"
#include "common/lighting/zones/medium_zones.h"
#include "common/lighting/zones/zone_colors.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

class ZoneScene {
 public:
  /// Throws as ZoneMap, and std::domain_error if the frame has no pose.
  ZoneScene(const Scene& scene, const RenderSettings& settings, int frame);
  ZoneScene(const ZoneScene&) = delete;

  const ZoneMap& map() const { return map_; }
  const MediumZones& media() const { return media_; }
  /// Surfaces' slots, then the media's.
  uint64_t slot_count() const { return map_.slot_count() + media_.slot_count(); }
  /// That zones take on the host, at the most.
  uint64_t most_bytes() const;
  const Pose& pose() const { return pose_; }
  /// Of random numbers: where nothing moves, comes or goes all frames have the same zones.
  int frame() const { return frame_; }
  size_t passes() const { return passes_.size(); }
  /// The scene in the colours of a pass.
  const Scene& scene(size_t pass) const { return passes_[pass].scene(); }
  const ColourPass& colours(size_t pass) const { return passes_[pass].pass(); }

 private:
  Scene scene_;
  int frame_;
  FrameState state_;
  Pose pose_;
  std::vector<ColouredScene> passes_;
  ZoneMap map_;
  MediumZones media_;
};

/// True if light that is kept at the slot is sent on: some materials only reflect what sources send
/// (Material::reflections).
bool is_sent_on(const ZoneScene& zones, uint64_t slot);

}  // namespace rayfarm
