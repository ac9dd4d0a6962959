#pragma once
// The head of a PLY file (Turk, "The PLY Polygon File Format", 1994): which tables it holds.
#include "common/description/formats/mesh_tables.h"

namespace rayfarm {

/// Which tables the file `path` of these bytes holds, and where; what of them is not used is noted in the
/// scene. The body is a view of `bytes`. Throws InputError.
MeshTables read_ply_header(SceneDescription& scene, std::string_view bytes, const std::string& path);

}  // namespace rayfarm
