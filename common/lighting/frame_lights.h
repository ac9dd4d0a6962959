#pragma once
// The sources that shine in one frame of a scene whose objects come and go: the same tables as those of a
// scene that never had the others.
#include <vector>

#include "common/lighting/light_choice.h"

namespace rayfarm {

/// What of a scene's sources depends on what is there.
struct FrameLights {
  std::vector<uint32_t> shining;  ///< indices into the scene's lights, rising
  std::vector<double> shares;     ///< as SceneArrays::light_shares, of those
  uint32_t first_luminaire = 0;   ///< among those
  double far_away = 1;            ///< as in SceneHeader
};

/// Of `frame`; `powers`: of all the scene's lights. The scene's own tables are those of a frame in which all
/// is there.
FrameLights make_frame_lights(const Scene& scene, std::span<const LightPower> powers, double frame);

/// Half the diagonal of `bounds`, or 1 if there is nothing in them: by which sources are weighed.
double light_radius(const Box& bounds);
/// The same box, grown by those of media.
Box with_media(Box bounds, std::span<const ParticipatingMedium> media);
/// A distance that leads out of `bounds` from anywhere in them.
double distance_out_of(const Box& bounds);

}  // namespace rayfarm
