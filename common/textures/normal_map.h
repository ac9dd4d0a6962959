#pragma once
// Images of heights and of normals, as maps of bumps are given: which of the two an image is, and the one
// made of the other.
#include <cstdint>
#include <vector>

#include "common/textures/texture.h"

namespace rayfarm {

/// True if an image of numbers holds normals: its mean is the blue of a normal that stands upright.
bool holds_normals(const Texture& image, const std::vector<uint16_t>& texels);

/// Turns an image of heights, all its levels, into one of normals (x along u, y along v; n is 2 c - 1). White
/// stands over black by a hundredth of the image's width.
void make_normals_of_heights(const Texture& image, std::vector<uint16_t>& texels);

}  // namespace rayfarm
