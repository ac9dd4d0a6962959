#pragma once
// Files of meshes that a node of a scene names, one loader a format. All throw InputError, IoError where a
// file can't be read, and Stopped.
#include <vector>

#include "common/description/load_options.h"
#include "common/description/scene_description.h"

namespace rayfarm {

/// A mesh's file as a node of a scene asks for it.
struct MeshRequest {
  std::string path;
  uint32_t material = 0;  ///< of faces to which the file gives none
  Smoothing smoothing = Smoothing::flat;
  Place place;                         ///< of the request
  bool is_smoothing_asked_for = true;  ///< else it is the file's own, where that says what is smooth
  /// Where the file says nothing: edges between faces that meet at a larger angle, in degrees, stay sharp,
  /// and if no smoothing is asked for the rest is `phong`. 0: no edges do, and it is flat.
  double crease = 0;
};

/// Adds what the file holds to an object, and its materials and notes to the scene.
using MeshLoader = void (*)(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                            const LoadOptions& options);

/// Wavefront OBJ: one primitive; its MTL materials.
void load_obj_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options);

/// glTF 2.0, .gltf or .glb: a child that holds all that its scene shows, with its materials and lights; what
/// moves by its clip does so.
void load_gltf_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                    const LoadOptions& options);
/// PLY, in text and in bytes: one primitive; colours of vertices.
void load_ply_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options);
/// STL, in text and in bytes: one primitive, all solids of the file; equal points are one.
void load_stl_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options);
/// Geomview's OFF in three dimensions, in text, with normals, colours and coordinates: one primitive.
void load_off_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options);

struct MeshFormat {
  const char* extension;
  MeshLoader load;
};

/// Every format that a mesh may be in.
inline constexpr MeshFormat kMeshFormats[] = {{".obj", load_obj_mesh},  {".off", load_off_mesh},
                                              {".ply", load_ply_mesh},  {".stl", load_stl_mesh},
                                              {".glb", load_gltf_mesh}, {".gltf", load_gltf_mesh}};

/// The format of a file by its name; null if it is none of them.
const MeshFormat* find_mesh_format(const std::string& path);

/// Their extensions, for messages: ".obj, .ply or .stl".
std::string mesh_extensions();

}  // namespace rayfarm
