#pragma once
// PNG files of R, G and B in sRGB, 8 bits a channel, a text chunk for each attribute.
#include <cstdio>

#include "common/image/image_writer.h"

namespace rayfarm {

/// The window's pixels into an empty file that is open for writing and reading; late attributes stand after
/// them. Throws std::exception with what went wrong.
std::unique_ptr<RowWriter> make_png_writer(std::FILE* file, const Image& image,
                                           const std::map<std::string, std::string>& attributes);

/// Reads all that stands before the pixels, and texts at the file's end. Throws std::exception.
ImageInfo read_png_info(std::FILE* file);

/// Reads every row and chunk. Throws std::exception if one is missing or damaged.
void check_png(std::FILE* file);

/// What is wrong with the chunks that a PNG file can't be shown without, by their checksums: empty if nothing
/// is, or it is no PNG file. Nothing is decoded, and the file's place stays.
std::string find_png_damage(std::FILE* file);

}  // namespace rayfarm
