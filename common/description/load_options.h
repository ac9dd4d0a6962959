#pragma once
// What loaders are told beside the name of a file.
#include <string>

#include "common/description/read_progress.h"
#include "common/errors/stop.h"

namespace rayfarm {

/// Which axis of a file points up.
enum class UpAxis { usual, y, z };

struct LoadOptions {
  std::stop_token stop{};            ///< loaders throw Stopped soon after it is requested
  ReadProgress* progress = nullptr;  ///< counts what is read; may be null
  double fps = 24;                   ///< frames in a second of clips that are timed in seconds
  std::string clip{};         ///< of files that hold several: a name or a number from 0; empty: the first
  std::string camera{};       ///< the same, of cameras
  UpAxis up = UpAxis::usual;  ///< of meshes that are scenes by themselves; usual: z of STL, else y
};

}  // namespace rayfarm
