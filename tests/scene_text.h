#pragma once
// All that tests compare of two readings of one scene.
#include <fmt/core.h>

#include <cstring>
#include <string>

#include "common/description/scene_description.h"

namespace rayfarm::test {

/// Objects with names, places, shapes and children, values of textures, lights' places, and notes; numbers as
/// their bytes.
inline std::string text_of_scene(const SceneDescription& scene) {
  std::string text;
  const auto put = [&text](const auto& values) {
    text += fmt::format("\n{}: ", values.size());
    if (values.empty()) return;
    const size_t begin = text.size(), bytes = values.size() * sizeof(values[0]);
    text.resize(begin + bytes);
    std::memcpy(text.data() + begin, values.data(), bytes);
  };
  const auto put_place = [&text](const Place& place) {
    text += fmt::format("\n{}:{}:{} ", place.file, place.line, place.column);
  };
  for (const ObjectDescription& object : scene.objects) {
    put_place(object.place);
    text += object.name;
    for (const PrimitiveDescription& p : object.primitives) {
      put_place(p.place);
      text += fmt::format("shape {} of {}", p.shape.index(), p.material);
      if (const auto* polygon = std::get_if<PolygonShape>(&p.shape)) {
        put(polygon->points);
        put(polygon->normals);
      } else if (const auto* mesh = std::get_if<MeshShape>(&p.shape)) {
        put(mesh->positions);
        put(mesh->normals);
        put(mesh->triangles);
        put(mesh->triangle_normals);
        put(mesh->polygons.sides);
        put(mesh->polygons.corners);
        put(mesh->polygons.normals);
      } else if (const auto* sphere = std::get_if<SphereShape>(&p.shape)) {
        text += fmt::format(" {} {} {}, {}", sphere->center.x, sphere->center.y, sphere->center.z,
                            sphere->radius);
      }
    }
    for (const ChildDescription& child : object.children) {
      put_place(child.place);
      text += fmt::format("child {}", child.object);
    }
    for (const LightDescription& light : object.lights) put_place(light.place);
  }
  for (const MaterialDescription& material : scene.materials) text += "\n" + material.name;
  for (const TextureDescription& texture : scene.textures) {
    text += "\n" + texture.name;
    put(texture.texels);
  }
  for (const std::string& note : scene.notes.lines()) text += "\n" + note;
  return text;
}

}  // namespace rayfarm::test
