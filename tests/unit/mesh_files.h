#pragma once
// OBJ and MTL files that tests write, and what becomes of them.
#include "tests/unit/test_scene.h"

namespace rayfarm::test {

inline const std::string kMeshYaml = view_text() + "scene: [{mesh: {file: mesh.obj}}]\n";

/// Loads mesh.obj with its library mesh.mtl.
inline SceneDescription load_mesh(const std::string& obj, const std::string& mtl = "") {
  write_temporary("mesh.mtl", mtl);
  write_temporary("mesh.obj", obj);
  return load_yaml(kMeshYaml);
}
inline std::string error_of_mesh(const std::string& obj, const std::string& mtl = "") {
  write_temporary("mesh.mtl", mtl);
  write_temporary("mesh.obj", obj);
  return error_of(kMeshYaml);
}
inline std::string notes_of(const SceneDescription& scene) {
  std::string text;
  for (const std::string& line : scene.notes.lines()) text += line + "\n";
  return text;
}
inline void expect_note(const SceneDescription& scene, const std::string& place, const std::string& text) {
  for (const std::string& line : scene.notes.lines())
    if (line.find(place) != std::string::npos && line.find(text) != std::string::npos) return;
  ADD_FAILURE() << "no note '" << text << "' at " << place << " in:\n" << notes_of(scene);
}
inline const MeshShape& mesh_of(const SceneDescription& scene) {
  return std::get<MeshShape>(scene.objects.at(scene.root).primitives.at(0).shape);
}

inline const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
inline const std::string kFace = "f 1/1 2/2 3/3\n";

/// An image of two pixels, red and green.
inline void write_two_colours(const std::string& name) {
  Image image{2, 1, {0, 0, 2, 1}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (const int value : {255, 0, 0, 0, 255, 0}) image.pixels.push_back(static_cast<std::byte>(value));
  write_image(write_temporary(name, ""), image, {});
}

}  // namespace rayfarm::test
