#pragma once
// The loaders behind load_scene, one per file format. None of them writes anything.
#include "common/scene/scene_description.h"

namespace rayfarm {

/// Rayfarm's own format; scenes/README.md describes every key.
SceneDescription load_yaml_scene(const std::string& path);
/// Haines's Neutral File Format: v, b, l, f, c, s, p, pp and comments.
SceneDescription load_nff_scene(const std::string& path);
/// Adds an OBJ file's triangles to an object; its MTL materials are appended to the scene's.
/// Without materials in the file every triangle gets `material`.
PrimitiveDescription load_obj_mesh(SceneDescription& scene, const std::string& path, uint32_t material,
                                   Smoothing smoothing, const Place& place);

/// The whole file as text; throws IoError if it can't be read and InputError if it is larger than
/// `max_bytes`.
std::string read_text_file(const std::string& path, uintmax_t max_bytes);

}  // namespace rayfarm
