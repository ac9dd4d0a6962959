#pragma once
// Which frames, and the names of their files.
#include <string>
#include <vector>

#include "protocol/index.h"

namespace rayfarm {

/// Parses `1-10x2`, `5`, `1,4,7-9`: ascending order of writing is kept, a frame named twice is an error.
/// Throws std::invalid_argument with a message for the user.
std::vector<FrameNumber> parse_frames(const std::string& text);

bool has_frame_pattern(const std::string& path);
/// `shot.####.exr` with frame 7 is `shot.0007.exr`: the last run of # is replaced, padded to its length.
std::string file_of_frame(const std::string& path, FrameNumber frame);

}  // namespace rayfarm
