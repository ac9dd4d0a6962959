#pragma once
// A face's corners in double, brought together from the vertices that the faces of its mesh share.
#include "common/math/gathered.h"
#include "common/scene/scene.h"

namespace rayfarm {

inline Gathered<Vec3> points_of(const Scene& scene, const MeshFace& face) {
  Gathered<Vec3> points(face.corner_count);
  for (size_t i = 0; i < face.corner_count; ++i)
    points[i] = scene.mesh_points[scene.face_corners[face.first_corner + i]];
  return points;
}

/// Of a face that has any.
inline Gathered<Vec3> normals_of(const Scene& scene, const MeshFace& face) {
  Gathered<Vec3> normals(face.corner_count);
  for (size_t i = 0; i < face.corner_count; ++i)
    normals[i] = scene.normals[scene.face_normals[face.first_normal + i]];
  return normals;
}

}  // namespace rayfarm
