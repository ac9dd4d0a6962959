#pragma once
// Meshes as loaders make them, face by face.
#include <span>

#include "common/description/scene_description.h"

namespace rayfarm {

struct FaceCorner {
  uint32_t point = 0;     ///< of the mesh's positions
  uint32_t normal = ~0u;  ///< of its normals; ~0: the face is flat
  uint32_t uv = 0;        ///< of its uvs, if it has any
};

/// Makes room for faces of so many corners each.
void reserve_faces(std::span<const uint32_t> sides, bool has_uvs, MeshShape& mesh);

/// Adds a face of three corners or more, counter-clockwise seen from outside. Every face of a mesh is added
/// so; its uvs, if it has any, stand in it before. Normals count only if the mesh is smooth and all corners
/// have one. `material`: of none or of all faces.
void add_face(MeshShape& mesh, std::span<const FaceCorner> corners, std::optional<uint32_t> material);

/// Gives every vertex the average of the normals of all the polygons that contain it (Gouraud; thesis 2.3.5),
/// and every corner its vertex's. Throws Stopped.
void average_normals(MeshShape& mesh, const std::stop_token& stop);

}  // namespace rayfarm
