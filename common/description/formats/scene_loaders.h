#pragma once
// The loaders behind load_scene, one per file format. None of them writes anything. All throw Stopped soon
// after `stop` is requested, and count what they read, where `progress` is not null.
#include "common/description/scene_description.h"

namespace rayfarm {

/// Rayfarm's own format; scenes/README.md describes every key.
SceneDescription load_yaml_scene(const std::string& path, const std::stop_token& stop,
                                 ReadProgress* progress);
/// Haines's Neutral File Format: v, b, l, f, c, s, p, pp and comments.
SceneDescription load_nff_scene(const std::string& path, const std::stop_token& stop, ReadProgress* progress);
/// Compiled objects, to look at them; they are no text, and not counted.
SceneDescription load_part_scene(const std::string& path, const std::stop_token& stop,
                                 ReadProgress* progress);
/// Adds an OBJ file's triangles to an object; its MTL materials are appended to the scene's.
/// Without materials in the file every triangle gets `material`.
PrimitiveDescription load_obj_mesh(SceneDescription& scene, const std::string& path, uint32_t material,
                                   Smoothing smoothing, const Place& place, const std::stop_token& stop,
                                   ReadProgress* progress);

}  // namespace rayfarm
