#pragma once
// OpenEXR files of the pixels' channels by their names and A (alpha 1), half or float, ZIP, scene-linear
// Rec.709.
#include <cstdio>

#include "common/image/image_writer.h"

namespace rayfarm {

/// Into an empty file that is open for writing and reading. RGB8 pixels become half. Throws std::exception
/// with what went wrong.
/// \param late names of attributes whose values come at the end: 20 characters, filled up with spaces
std::unique_ptr<RowWriter> make_exr_writer(std::FILE* file, const Image& image,
                                           const std::map<std::string, std::string>& attributes,
                                           const std::vector<std::string>& late);

/// Reads the header. Throws std::exception.
ImageInfo read_exr_info(std::FILE* file);

/// Reads every row. Throws std::exception if one is missing or damaged.
void check_exr(std::FILE* file);

}  // namespace rayfarm
