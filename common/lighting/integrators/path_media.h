#pragma once
// What participating media do to the paths of a packet: they scatter them between surfaces, and weaken their
// shadow rays.
#include "common/lighting/integrators/path_step.h"
#include "common/lighting/medium_walk.h"

namespace rayfarm {

/// Follows a lane's ray through media as far as `t_max`. Its throughput is weighed by what happens there.
MediumEvent walk_in_media(const PathStage& stage, size_t lane, double t_max, PathLanes& paths);

/// A shadow ray from where a path is scattered to one of the sources.
void light_in_media(const PathStage& stage, size_t lane, const MediumEvent& event, const PathLanes& paths,
                    ShadowLanes& shadows);

/// The step of a path that is scattered: a shadow ray to one of the sources, and the direction in which the
/// path goes on, by the medium's phase function. False: the path ends.
bool scatter_in_media(const PathStage& stage, size_t lane, const MediumEvent& event, PathLanes& paths,
                      ShadowLanes& shadows);

/// Weakens the shadow rays that are not `blocked` by the media on their way.
void weaken_in_media(const PathStage& stage, LaneSet blocked, ShadowLanes& shadows);

}  // namespace rayfarm
