#pragma once
// Arrays as NumPy saves them (`numpy.save`; format 1.0 to 3.0 of its documentation): the axes are x, y, z,
// and maybe the three primary colours.
#include "common/textures/array_texture.h"

namespace rayfarm {

/// Numbers of 8 or 16 bits without sign become 0 to 1; those with a point (2, 4 or 8 bytes) are taken as they
/// are, and must be from 0 to 1. Throws InputError or IoError, also if there are more cells than
/// `most_cells`.
ArrayValues load_npy(const std::string& path, uint64_t most_cells, const std::stop_token& stop = {});

}  // namespace rayfarm
