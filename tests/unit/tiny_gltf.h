#pragma once
// glTF files that tests make: bytes become bufferViews and accessors, the rest is JSON that the test writes.
#include <fmt/core.h>

#include <cstring>
#include <span>

#include "tests/unit/test_scene.h"

namespace rayfarm::test {

class TinyGltf {
 public:
  std::string asset;  ///< JSON that joins its `asset`, as `"generator": "me"`

  /// Adds the values' bytes as a bufferView; `more` is JSON that joins it, as `"byteStride": 8`.
  template <typename T>
  size_t view(const std::vector<T>& values, const std::string& more = "") {
    bytes_.resize(size_after_padding());
    const size_t begin = bytes_.size();
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    views_ +=
        fmt::format(R"({}{{"buffer": 0, "byteOffset": {}, "byteLength": {}{}{}}})",
                    views_.empty() ? "" : ", ", begin, bytes_.size() - begin, more.empty() ? "" : ", ", more);
    return view_count_++;
  }
  /// Where the next view begins.
  size_t size_after_padding() const { return (bytes_.size() + 3) / 4 * 4; }
  /// `more`: as `"bufferView": 3, "normalized": true`.
  size_t accessor(int component_type, const char* type, size_t count, const std::string& more) {
    accessors_ += fmt::format(R"({}{{"componentType": {}, "type": "{}", "count": {}{}{}}})",
                              accessors_.empty() ? "" : ", ", component_type, type, count,
                              more.empty() ? "" : ", ", more);
    return accessor_count_++;
  }
  size_t floats(const char* type, const std::vector<float>& values, size_t parts) {
    const size_t v = view(values);
    return accessor(5126, type, values.size() / parts, fmt::format(R"("bufferView": {})", v));
  }
  size_t vectors(const std::vector<float>& values) { return floats("VEC3", values, 3); }
  size_t scalars(const std::vector<float>& values) { return floats("SCALAR", values, 1); }
  template <typename T>
  size_t indices(const std::vector<T>& values) {
    const size_t v = view(values);
    return accessor(sizeof(T) == 1   ? 5121
                    : sizeof(T) == 2 ? 5123
                                     : 5125,
                    "SCALAR", values.size(), fmt::format(R"("bufferView": {})", v));
  }
  /// The square from (0, 0) to (1, 1) in z = 0, which is seen from +z.
  size_t square() { return vectors({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}); }

  /// All of it; `rest` is JSON of the other lists, as `"nodes": […]`.
  std::string json(const std::string& rest, const std::string& uri) const {
    std::string text =
        fmt::format(R"({{"asset": {{"version": "2.0"{}{}}})", asset.empty() ? "" : ", ", asset);
    if (!bytes_.empty()) {
      const std::string where = uri.empty() ? "" : fmt::format(R"(, "uri": "{}")", uri);
      text += fmt::format(R"(, "buffers": [{{"byteLength": {}{}}}])", bytes_.size(), where);
    }
    if (!views_.empty()) text += fmt::format(R"(, "bufferViews": [{}])", views_);
    if (!accessors_.empty()) text += fmt::format(R"(, "accessors": [{}])", accessors_);
    return text + (rest.empty() ? "" : ", ") + rest + "}";
  }
  std::string write(const std::string& rest, const std::string& name = "tiny.bin",
                    const std::string& uri = "tiny.bin") const {
    write_temporary(name, bytes_);
    return write_temporary("tiny.gltf", json(rest, uri));
  }
  std::string write_glb(const std::string& rest) const {
    std::string text = json(rest, ""), bytes = bytes_;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4);
    const auto word = [](size_t n) {
      const auto w = static_cast<uint32_t>(n);
      return std::string(reinterpret_cast<const char*>(&w), 4);
    };
    return write_temporary("tiny.glb", "glTF" + word(2) + word(12 + 8 + text.size() + 8 + bytes.size()) +
                                           word(text.size()) + "JSON" + text + word(bytes.size()) +
                                           std::string("BIN\0", 4) + bytes);
  }
  SceneDescription load(const std::string& rest, const LoadOptions& options = {}) const {
    return load_scene(write(rest), options);
  }
  /// Without the ground and lamp that files without lights get.
  SceneDescription load_alone(const std::string& rest, const LoadOptions& options = {}) const {
    SceneDescription scene = load(rest, options);
    for (auto& children = scene.objects[scene.root].children; children.size() > 1; children.pop_back())
      scene.objects.pop_back();
    return scene;
  }
  /// The message of the error that it ends in; "" if there is none.
  std::string error(const std::string& rest) const {
    try {
      compile(load(rest));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

 private:
  std::string bytes_, views_, accessors_;
  size_t view_count_ = 0, accessor_count_ = 0;
};

/// Nodes that show one mesh with one primitive: `primitive` is its JSON without the braces.
inline std::string shows(const std::string& primitive) {
  return fmt::format(R"("nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{{{}}}]}}])", primitive);
}

/// The square as mesh 0, with `material`, and the lists of nodes and what else `rest` has.
inline std::string square_and(TinyGltf& file, const std::string& rest, const std::string& more = "") {
  return fmt::format(
      R"("meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}, "mode": 6{}}}]}}], {})",
      file.square(), more, rest);
}

/// The meshes of all objects, in the objects' order.
inline std::vector<const MeshShape*> meshes_of(const SceneDescription& scene) {
  std::vector<const MeshShape*> meshes;
  for (const ObjectDescription& object : scene.objects)
    for (const PrimitiveDescription& p : object.primitives)
      if (const auto* mesh = std::get_if<MeshShape>(&p.shape)) meshes.push_back(mesh);
  return meshes;
}

inline double area_of(const MeshShape& mesh, Vec3* direction = nullptr) {
  double area = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    const Vec3 normal = glm::cross(b - a, c - a) / 2.0;
    area += glm::length(normal);
    if (direction) *direction += normal;
  }
  return area;
}

}  // namespace rayfarm::test
