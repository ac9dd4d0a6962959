#include "host/commands/hierarchy_options.h"

namespace rayfarm {

void add_hierarchy_options(Options& options, BuildOptions& build) {
  options.choice<Hierarchy>(
      "--hierarchy", build.hierarchy, choices<Hierarchy>(kHierarchyWords),
      "how primitives are arranged: volumes that are split by the surface area heuristic "
      "(sah), or about the centre of the data (thesis); equal cells (regular); cells that are halved where "
      "they hold much (adaptive); not at all "
      "(brute); bounding volumes about the scene's objects and groups (object); pictures are the same "
      "(default: sah)");
  options.number("--max-primitives", build.max_primitives, 1, 1000,
                 "in a leaf of sah or thesis; a cell of adaptive that holds more is divided (default: 8)");
  options.choice<BuildQuality>(
      "--build", build.quality, choices<BuildQuality>(kBuildQualityWords),
      "of sah: fast leaves primitives whole; balanced divides large ones among volumes where that pays, up "
      "to 1.3 "
      "references a primitive on average, high up to 2 (default: balanced)");
  options.choice<ThesisVolumes>("--thesis-volumes", build.thesis.volumes,
                                choices<ThesisVolumes>(kThesisVolumesWords),
                                "of thesis: boxes, tested eight at once; or one sphere about each volume, "
                                "and octants in the order in which a "
                                "ray enters them (default: boxes)");
  options.choice<ThesisClip>("--thesis-clip", build.thesis.clip, choices<ThesisClip>(kThesisClipWords),
                             "of thesis: what lies across octants is clipped where that makes no more than "
                             "1.5 references of one, or "
                             "always (default: bounded)");
  options.choice<ThesisCenter>(
      "--thesis-center", build.thesis.center, choices<ThesisCenter>(kThesisCenterWords),
      "of thesis: a volume is divided about the mean of its primitives' centres, or the "
      "middle of the box about them (default: data)");
  options.number("--cells", build.cells, 0, kMostCells,
                 "of regular: along each axis; 0: four cells for each primitive (default: 0)");
  options.number("--octree-depth", build.octree_depth, 1, kMostOctreeDepth,
                 "of adaptive: how often the whole may be halved (default: 16)");
  options.choice<OctreeData>("--octree-data", build.octree_data, choices<OctreeData>(kOctreeDataWords),
                             "of adaptive: what a cell holds is found by the cell's name in a hash table, or "
                             "from its node (default: hash)");
  options.number("--octree-hash", build.octree_hash, 1, kMostHashPlaces,
                 "of adaptive: places of the hash table (default: 1000)");
  options.choice<OctreeNext>(
      "--octree-next", build.octree_next, choices<OctreeNext>(kOctreeNextWords),
      "of adaptive: a ray's next cell is looked for from the root, from the parent upward, or by steps "
      "across "
      "faces (default: root)");
  options.choice<OctreeBuild>("--octree-build", build.octree_build, choices<OctreeBuild>(kOctreeBuildWords),
                              "of adaptive: cells are divided before rays are traced, or when a ray first "
                              "comes into them (default: before)");
  options.flag(
      "--mailbox", build.has_mailbox,
      "of regular, adaptive and the spheres of thesis: a primitive that a ray was tested with in a cell or "
      "volume is not tested with it in others");
  ObjectOptions& objects = build.objects;
  options.choice<BoundChoice>(
      "--bounds", objects.bounds, choices<BoundChoice>(kBoundWords),
      "of object: the bounding volumes; best: sphere, box or cylinder, by volume and cost "
      "of the test (default: best)");
  options.choice<Clusters>(
      "--clusters", objects.clusters, choices<Clusters>(kClustersWords),
      "of object: the scene's groups have volumes, or objects alone, or groups of near objects (default: "
      "groups)");
  options.choice<ObjectOrder>("--object-order", objects.order, choices<ObjectOrder>(kObjectOrderWords),
                              "of object: a ray looks into volumes by where it enters them, until a hit is "
                              "nearer; or into all that it meets (default: sorted)");
  options.choice<BoundsFor>("--bounds-for", objects.bounds_for, choices<BoundsFor>(kBoundsForWords),
                            "of object: best for rays from anywhere, or for those from the eye at the first "
                            "frame (default: all)");
  options.flag(
      "--last-hit", build.has_last_hit,
      "a ray is first tested with what the last one of its kind hit, and then searched as far as that");
  constexpr double kLeastRayCoherence = 0.1;
  options.number("--ray-coherence", build.ray_coherence, kLeastRayCoherence, kMostRayCoherence,
                 "the half angle in degrees of the cones of directions for which it is listed what rays "
                 "from a primitive can meet (default: no lists)");
}

}  // namespace rayfarm
