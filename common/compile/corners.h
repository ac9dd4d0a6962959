#pragma once
// What meshes know of their corners beside positions and normals: coordinates of textures, and colours. The
// scene has either none of a kind, or one for each corner; corners of meshes that lack it are filled up.
#include "common/scene/scene.h"

namespace rayfarm {

/// Fills the arrays of which `in_use`, a scene or its arrays, has any, up to the corners so far.
template <typename Arrays>
void fill_corners(SceneArrays<GrowingArray>& arrays, const Arrays& in_use) {
  const size_t of_triangles = 3 * arrays.triangle_shading.size(), of_faces = arrays.face_corners.size();
  if (!in_use.triangle_uvs.empty()) arrays.triangle_uvs.resize(of_triangles, kNoUv);
  if (!in_use.second_uvs.empty()) arrays.second_uvs.resize(of_triangles, kNoUv);
  if (!in_use.triangle_colors.empty()) arrays.triangle_colors.resize(of_triangles, kWhiteVertex);
  if (!in_use.face_uvs.empty()) arrays.face_uvs.resize(of_faces, kNoUv);
  if (!in_use.face_colors.empty()) arrays.face_colors.resize(of_faces, kWhiteVertex);
}

/// Sets the values of corners behind `before` others, which are filled up with `none`: values[of(k)] is of
/// corner k. Nothing if there are no values.
template <typename T, typename Of>
void add_corners(GrowingArray<T>& array, size_t before, const T& none, const LargeVector<T>& values,
                 size_t count, Of of) {
  if (values.empty()) return;
  array.resize(before, none);
  for (size_t k = 0; k < count; ++k) array.push_back(values[of(k)]);
}

}  // namespace rayfarm
