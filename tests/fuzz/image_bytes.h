#pragma once
#include <vector>

#include "tests/fuzz/folder.h"

namespace rayfarm::fuzz {

/// Files of images, behind a byte that names the format.
std::vector<std::string> image_seeds(const Folder& folder);
void read_images(const Folder& folder, const std::string& bytes);

}  // namespace rayfarm::fuzz
