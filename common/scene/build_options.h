#pragma once
// How hierarchies are built.
#include <array>
#include <atomic>
#include <cstdint>

#include "common/errors/stop.h"

namespace rayfarm {

/// How the primitives of a collection are arranged. All give the same pictures.
enum class Hierarchy : uint8_t {
  sah,  ///< volumes, divided where a ray is expected to do least work: the surface area heuristic (Goldsmith,
        ///< Salmon 1987)
  thesis,   ///< volumes, divided into the octants about the centre of the data, straddling primitives clipped
            ///< (4.2.1.2)
  regular,  ///< equal cells (2.6.2; Ullner, Cleary)
  adaptive,  ///< cells that are halved where they hold much: an octree (2.6.2; Glassner 1984)
  brute,     ///< none: a ray tests all
  object     ///< bounding volumes about the objects and groups of the scene (2.6.1; Weghorst, Hooper and
             ///< Greenberg 1984)
};
/// Here and below: words for the values, in their order, on the command line and in scenes.
inline constexpr std::array kHierarchyWords{"sah", "thesis", "regular", "adaptive", "brute", "object"};

/// The shapes of bounding volumes.
enum class VolumeKind : uint32_t {
  sphere,
  box,       ///< along the axes
  cylinder,  ///< with caps
  slabs      ///< seven pairs of planes (Kay and Kajiya 1986)
};
inline constexpr size_t kVolumeKinds = 4;

/// Which bounding volumes objects and groups get. The first are those of VolumeKind.
enum class BoundChoice : uint8_t { sphere, box, cylinder, slabs, best, none };
inline constexpr std::array kBoundWords{"sphere", "box", "cylinder", "slabs", "best"};     ///< of a hierarchy
inline constexpr std::array kOneBoundWords{"sphere", "box", "cylinder", "slabs", "none"};  ///< of a node

/// What groups of objects are.
enum class Clusters : uint8_t {
  groups,    ///< the scene's
  none,      ///< objects stand in a flat list
  automatic  ///< near ones are put together
};
inline constexpr std::array kClustersWords{"groups", "none", "automatic"};

/// In which order a ray looks into the bounding volumes that it meets.
enum class ObjectOrder : uint32_t {
  sorted,  ///< by where it enters them, until a hit is nearer (thesis Figure 4.4, Weghorst's Figure 4)
  all      ///< all of them (thesis Figure 2.15)
};
inline constexpr std::array kObjectOrderWords{"sorted", "all"};

/// From where the rays come for which the best bounding volumes are chosen.
enum class BoundsFor : uint8_t {
  all,  ///< anywhere: volume stands for what they see of a shape
  eye   ///< the camera, at the first frame
};
inline constexpr std::array kBoundsForWords{"all", "eye"};

/// Of Hierarchy::object.
struct ObjectOptions {
  BoundChoice bounds = BoundChoice::best;
  Clusters clusters = Clusters::groups;
  ObjectOrder order = ObjectOrder::sorted;
  BoundsFor bounds_for = BoundsFor::all;
  bool operator==(const ObjectOptions&) const = default;
};

/// What a build may take for the sake of the rays. The pictures are the same.
enum class BuildQuality : uint8_t {
  fast,      ///< primitives stay whole
  balanced,  ///< spatial splits where they are seen to pay, up to 1.3 references a primitive on average
  high       ///< up to 2
};
inline constexpr std::array kBuildQualityWords{"fast", "balanced", "high"};

/// What bounds a volume of Hierarchy::thesis, and so how rays look into those in it.
enum class ThesisVolumes : uint8_t {
  boxes,   ///< up to eight at a node, tested at once; the nearest first
  spheres  ///< one about each volume (4.3.2), in the order in which a ray enters octants (Table 4.2)
};
inline constexpr std::array kThesisVolumesWords{"boxes", "spheres"};

/// When a volume of Hierarchy::thesis is divided by clipping what lies across octants.
enum class ThesisClip : uint8_t {
  bounded,  ///< where that makes no more than 1.5 references of one. Boxes are divided by the centres of
            ///< whole primitives elsewhere, spheres are not divided
  always    ///< as the thesis has it
};
inline constexpr std::array kThesisClipWords{"bounded", "always"};

/// About which point a volume of Hierarchy::thesis is divided.
enum class ThesisCenter : uint8_t {
  data,   ///< the mean of its primitives' centres
  volume  ///< the middle of the box about its primitives
};
inline constexpr std::array kThesisCenterWords{"data", "volume"};

/// Of Hierarchy::thesis.
struct ThesisOptions {
  ThesisVolumes volumes = ThesisVolumes::boxes;
  ThesisClip clip = ThesisClip::bounded;
  ThesisCenter center = ThesisCenter::data;
  bool operator==(const ThesisOptions&) const = default;
};

/// How an octree finds what a cell holds.
enum class OctreeData : uint8_t {
  hash,     ///< by the cell's name in a hash table (Glassner; thesis 2.6.2)
  pointers  ///< from the cell's node
};
inline constexpr std::array kOctreeDataWords{"hash", "pointers"};

/// How an octree finds the next cell on a ray's way (Shirley, Sung and Brown, 2.3). All find the same.
enum class OctreeNext : uint32_t {
  root,  ///< from the root, by a point that is moved beyond the face (Glassner)
  walk,  ///< by the same point, upward from the parent until it is inside, and down again (tree walking)
  dda    ///< by steps of whole numbers across one face, from the smallest node that holds both cells
};
inline constexpr std::array kOctreeNextWords{"root", "walk", "dda"};

/// When an octree's cells are divided (Shirley, Sung and Brown, 2.3.2: "statically before ray tracing starts,
/// or dynamically during ray tracing").
enum class OctreeBuild : uint32_t {
  before,
  tracing  ///< when a ray first comes into them
};
inline constexpr std::array kOctreeBuildWords{"before", "tracing"};

/// Of BuildOptions::ray_coherence, in degrees.
inline constexpr double kMostRayCoherence = 60;

/// How far a build is, for those who watch it from another thread.
struct BuildProgress {
  std::atomic<uint64_t> total = 0, done = 0;  ///< primitives
};

struct BuildOptions {
  Hierarchy hierarchy = Hierarchy::sah;
  uint32_t max_primitives = 8;  ///< a volume with at most this many is a leaf (the thesis used 4 to 30)
  BuildQuality quality = BuildQuality::balanced;  ///< of Hierarchy::sah
  ThesisOptions thesis{};
  uint32_t cells =
      0;  ///< of Hierarchy::regular, along each axis; 0: so that there are four for each primitive
  OctreeData octree_data = OctreeData::hash;  ///< these five of Hierarchy::adaptive
  OctreeNext octree_next = OctreeNext::root;
  OctreeBuild octree_build = OctreeBuild::before;
  uint32_t octree_depth = 16;   ///< a cell may be as small as the whole halved so often
  uint32_t octree_hash = 1000;  ///< places of the hash table (the thesis's number)
  bool has_mailbox = false;  ///< lists of cells, and of spheres of Hierarchy::thesis, remember what a ray has
                             ///< been tested with
  ObjectOptions objects{};
  // These two of whole scenes, in every hierarchy.
  bool has_last_hit = false;  ///< a ray is first tested with what the last one hit
  double ray_coherence =
      0;  ///< the half angle, in degrees, of the cones for which candidates are listed; 0: none
  BuildProgress* progress = nullptr;
  std::stop_token stop{};  ///< a build that was asked to stop throws Stopped
};

}  // namespace rayfarm
