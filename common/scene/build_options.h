#pragma once
// How hierarchies are built.
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
  brute     ///< none: a ray tests all
};

/// What a build may take for the sake of the rays. The pictures are the same.
enum class BuildQuality : uint8_t {
  fast,      ///< primitives stay whole
  balanced,  ///< spatial splits where they are seen to pay, up to 1.3 references a primitive on average
  high       ///< up to 2
};

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
  BuildProgress* progress = nullptr;
  std::stop_token stop{};  ///< a build that was asked to stop throws Stopped
};

}  // namespace rayfarm
