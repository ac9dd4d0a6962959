#pragma once
// A scene to measure with, and the rays that are traced through it.
#include <memory>
#include <string>
#include <vector>

#include "common/compile/compile.h"
#include "common/hierarchy/traverser.h"
#include "protocol/clock.h"

namespace rayfarm::bench {

struct RaySet {
  std::string name;
  bool is_any_hit = false;
  std::vector<Ray> rays;
  std::vector<RayPacket> packets;  ///< the same, eight by eight
};

/// Primary rays of a picture in tiles, as a subpolygon gives them; one diffuse ray from each hit, distributed
/// by the cosine; one shadow ray from each hit to the first light, if that is on the side that is seen.
std::vector<RaySet> make_rays(const Scene& scene, const Pose& pose);

/// A loaded scene with its rays.
struct Subject {
  std::string name;
  SceneDescription description;
  CompiledScene compiled;
  std::unique_ptr<FrameState> frame;
  std::vector<RaySet> sets;

  const Scene& scene() const { return compiled.scene; }
};
std::unique_ptr<Subject> load_subject(const std::string& path);

/// The hits of rays [begin, end), traced alone, or eight at a time if begin is the first of eight.
size_t trace(const Scene& scene, const Pose& pose, const RaySet& set, size_t begin, size_t end);
size_t trace_packets(const Scene& scene, const Pose& pose, const RaySet& set, size_t begin, size_t end);

/// The triangles and spheres of a part, as other programs take them: what was split or clipped is whole
/// again.
struct PartGeometry {
  std::vector<float> triangle_vertices;  ///< 9 per triangle
  std::vector<float> spheres;            ///< x, y, z, radius
};
PartGeometry geometry_of(const Scene& scene, const Part& part);

}  // namespace rayfarm::bench
