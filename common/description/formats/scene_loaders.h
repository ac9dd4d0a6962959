#pragma once
// The loaders behind load_scene, one per file format. None of them writes anything.
#include "common/description/scene_description.h"

namespace rayfarm {

/// Rayfarm's own format; scenes/README.md describes every key.
SceneDescription load_yaml_scene(const std::string& path, const LoadOptions& options);
/// Haines's Neutral File Format: v, b, l, f, c, s, p, pp and comments.
SceneDescription load_nff_scene(const std::string& path, const LoadOptions& options);
/// glTF 2.0, .gltf or .glb, with its camera, or seen from the front.
SceneDescription load_gltf_scene(const std::string& path, const LoadOptions& options);
/// Compiled objects, to look at them; they are no text, and not counted.
SceneDescription load_part_scene(const std::string& path, const LoadOptions& options);
/// A file of a mesh (mesh_loaders.h), as quick_look.h shows it.
SceneDescription load_mesh_scene(const std::string& path, const LoadOptions& options);

}  // namespace rayfarm
