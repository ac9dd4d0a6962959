#pragma once
// How the cost of a ray grows: over the cut (the most primitives in a volume), over the number of primitives,
// and on scenes of today.
#include <filesystem>
#include <string>
#include <vector>

#include "host/experiments/hierarchies/hierarchies_page.h"

namespace rayfarm {

/// Over cuts from 1 to 64, of the hierarchies that have one.
std::vector<GrowthPoint> measure_cuts(const std::string& name, const SceneDescription& scene,
                                      const PictureRays& rays, const SceneFacts& facts);

/// Hilly ground of 2 n² triangles under a light.
SceneDescription make_terrain(uint32_t n);

/// Of ground in about 10³, 10⁴, 10⁵ and, if that is the limit, 10⁶ triangles, every hierarchy.
std::vector<GrowthPoint> measure_growth(int side_px, uint32_t most_primitives);

/// Every hierarchy as it is without further options, on a scene from a file. Where all primitives are tested,
/// of as many rays as end soon.
std::vector<HierarchyRow> measure_scene_of_today(const std::string& name, const std::string& path,
                                                 int side_px);

/// Of a CSV file; empty if there is none. Throws InputError if it is damaged.
std::vector<PeerTime> read_peer_times(const std::filesystem::path& file);

}  // namespace rayfarm
