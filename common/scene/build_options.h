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
  brute      ///< none: a ray tests all
};
/// Here and below: words for the values, in their order, on the command line and in scenes.
inline constexpr std::array kHierarchyWords{"sah", "thesis", "regular", "adaptive", "brute"};

/// What a build may take for the sake of the rays. The pictures are the same.
enum class BuildQuality : uint8_t {
  fast,      ///< primitives stay whole
  balanced,  ///< spatial splits where they are seen to pay, up to 1.3 references a primitive on average
  high       ///< up to 2
};
inline constexpr std::array kBuildQualityWords{"fast", "balanced", "high"};

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

/// How far a build is, for those who watch it from another thread.
struct BuildProgress {
  std::atomic<uint64_t> total = 0, done = 0;  ///< primitives
};

struct BuildOptions {
  Hierarchy hierarchy = Hierarchy::sah;
  uint32_t max_primitives = 8;  ///< a volume with at most this many is a leaf (the thesis used 4 to 30)
  BuildQuality quality = BuildQuality::balanced;  ///< of Hierarchy::sah
  uint32_t cells =
      0;  ///< of Hierarchy::regular, along each axis; 0: so that there are four for each primitive
  OctreeData octree_data = OctreeData::hash;  ///< these four of Hierarchy::adaptive
  OctreeNext octree_next = OctreeNext::root;
  uint32_t octree_depth = 16;   ///< a cell may be as small as the whole halved so often
  uint32_t octree_hash = 1000;  ///< places of the hash table (the thesis's number)
  bool has_mailbox = false;     ///< cells remember what a ray has been tested with (of those two)
  BuildProgress* progress = nullptr;
  std::stop_token stop{};  ///< a build that was asked to stop throws Stopped
};

}  // namespace rayfarm
