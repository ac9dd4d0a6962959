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

/// Where a face goes: how many triangles, other polygons, and corners of these stand before it.
struct FacePlace {
  size_t triangle = 0, polygon = 0, polygon_corner = 0;
};

/// Makes room for all faces before `end`; the mesh's uvs, if it has any, stand in it before.
void resize_faces(MeshShape& mesh, const FacePlace& end);

/// Sets a face of three corners or more, counter-clockwise seen from outside, into the room made for it, and
/// moves `place` behind it. Normals count only if the mesh is smooth and all corners have one. Faces may be
/// set by several threads.
void set_face(MeshShape& mesh, FacePlace& place, std::span<const FaceCorner> corners);

/// The same, behind all faces so far.
void add_face(MeshShape& mesh, std::span<const FaceCorner> corners);

/// A position that a mesh may have.
inline bool is_position(const glm::vec3& p) {
  return is_finite(Vec3(p)) && max_magnitude(Vec3(p)) <= limits::kCoordinate;
}

/// Throws InputError if the mesh that is the whole file has no faces, or more than a scene holds.
void check_faces(const MeshShape& mesh, const std::string& path);

/// Gives every vertex the average of the normals of all the polygons that contain it (Gouraud; thesis 2.3.5),
/// and every corner its vertex's. Throws Stopped.
void average_normals(MeshShape& mesh, const std::stop_token& stop);

}  // namespace rayfarm
