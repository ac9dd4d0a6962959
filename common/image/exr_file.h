#pragma once
// OpenEXR files of the pixels' channels by their names and A (alpha 1), half or float, ZIP, scene-linear
// Rec.709.
#include <cstdio>

#include "common/image/image.h"

namespace rayfarm {

/// Writes into an empty file that is open for writing and reading, reads it back row by row and compares.
/// RGB8 pixels become half. Throws std::exception with what went wrong.
void write_exr(std::FILE* file, const Image& image, const std::map<std::string, std::string>& attributes);

/// Reads the header. Throws std::exception.
ImageInfo read_exr_info(std::FILE* file);

/// Reads every row. Throws std::exception if one is missing or damaged.
void check_exr(std::FILE* file);

}  // namespace rayfarm
