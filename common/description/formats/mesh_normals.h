#pragma once
// Normals of meshes whose files give none but say what is smooth.
#include "common/description/formats/mesh_loaders.h"

namespace rayfarm {

/// Of each face: its group. Edges between faces of different groups stay sharp; faces of group 0 are flat.
/// Empty: all faces are of one.
struct SmoothingGroups {
  LargeVector<uint32_t> triangles, polygons;
};

/// Groups of faces that reach each other over edges at which the normals of faces differ by `degrees` at
/// most.
SmoothingGroups groups_by_crease(const MeshShape& mesh, double degrees, const std::stop_token& stop);

/// Gives each vertex of each group the sum of the normals of the group's faces there, weighed by the faces'
/// angles at the vertex, so that it does not depend on how faces are cut (Thürmer and Wüthrich 1998). The
/// mesh has no normals before and is not flat. Throws Stopped.
void smooth_normals(MeshShape& mesh, const SmoothingGroups& groups, const std::stop_token& stop);
/// Makes a mesh as smooth as it is asked for, if its file says nothing of that: neither normals nor groups.
/// Throws Stopped.
void add_asked_normals(MeshShape& mesh, const MeshRequest& request, const std::stop_token& stop);

}  // namespace rayfarm
