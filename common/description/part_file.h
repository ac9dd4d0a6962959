#pragma once
// Compiled objects in a file of their own: "the construction of objects into a volume hierarchy is done only
// once when the object is originally created" (thesis 4.2.2). The file is [head, 512 bytes] [scene block]. It
// is read by builds whose records are declared in the same words as those of the build that wrote it.
#include "common/errors/stop.h"
#include "common/scene/scene_block.h"

namespace rayfarm {

struct PartFile {
  SceneBlock block;
  Scene scene;  ///< a view into the block
};

/// `source`: the scene that the block was compiled from, for those who must do it again. Throws IoError.
void write_part_file(const std::string& path, const SceneBlock& block, const std::string& source);

/// Every index is checked as those of bytes from the net are. Throws IoError that says what to do: there is
/// no such file, it is none of compiled objects, another build wrote it, or it is damaged. Throws Stopped.
PartFile read_part_file(const std::string& path, const std::stop_token& stop = {});

}  // namespace rayfarm
