#include "host/bake/glb_file.h"

#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <limits>
#include <span>

#include "common/errors/input_error.h"
#include "common/files/whole_file.h"

namespace rayfarm {
namespace {

// Numbers of the format.
constexpr uint32_t kGlb = 0x46546C67, kGltfVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr int kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementBuffer = 34963,
              kTriangles = 4;

/// What lies in the binary chunk, and what tells of it.
class GlbBuffer {
 public:
  /// Returns the accessor's number.
  template <typename T>
  size_t add(const std::vector<T>& values, int component, const char* type, int target) {
    const auto bytes = std::as_bytes(std::span(values));
    Json::Object view{{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes.size()}, {"target", target}};
    Json::Object accessor{{"bufferView", views_.size()},
                          {"componentType", component},
                          {"count", values.size()},
                          {"type", type}};
    views_.emplace_back(std::move(view));
    accessors_.emplace_back(std::move(accessor));
    parts_.push_back(bytes);
    size_ += bytes.size();  // of four bytes each: the next one is aligned
    return accessors_.size() - 1;
  }
  size_t add_positions(const std::vector<glm::vec3>& positions) {
    const size_t index = add(positions, kFloat, "VEC3", kArrayBuffer);
    glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
    for (const glm::vec3& p : positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    accessors_[index]["min"] = Json::Array{double{low.x}, double{low.y}, double{low.z}};
    accessors_[index]["max"] = Json::Array{double{high.x}, double{high.y}, double{high.z}};
    return index;
  }
  uint64_t size() const { return size_; }
  std::span<const std::span<const std::byte>> parts() const { return parts_; }
  void describe(Json& root) {
    if (size_ == 0) return;
    root["buffers"] = Json::Array{Json::Object{{"byteLength", size_}}};
    root["bufferViews"] = std::move(views_);
    root["accessors"] = std::move(accessors_);
  }

 private:
  Json::Array views_, accessors_;
  std::vector<std::span<const std::byte>> parts_;
  uint64_t size_ = 0;
};

Json mesh_of(const GlbMesh& mesh, GlbBuffer& buffer) {
  Json::Array primitives;
  for (const GlbSurface& surface : mesh.surfaces) {
    const Json::Object attributes{{"POSITION", buffer.add_positions(surface.positions)},
                                  {"COLOR_0", buffer.add(surface.colors, kFloat, "VEC4", kArrayBuffer)}};
    primitives.emplace_back(
        Json::Object{{"attributes", attributes},
                     {"indices", buffer.add(surface.indices, kUnsignedInt, "SCALAR", kElementBuffer)},
                     {"material", mesh.material},
                     {"mode", kTriangles}});
  }
  return Json::Object{{"name", mesh.name}, {"primitives", std::move(primitives)}};
}

/// A camera looks along -z, x to the right.
Json node_of(const GlbCamera& camera) {
  const Vec3 back = glm::cross(camera.right, camera.up);
  Json::Array matrix;
  for (const Vec4& column :
       {Vec4(camera.right, 0), Vec4(camera.up, 0), Vec4(back, 0), Vec4(camera.location, 1)})
    for (int i = 0; i < 4; ++i) matrix.emplace_back(column[i]);
  return Json::Object{{"name", "view"}, {"camera", 0}, {"matrix", std::move(matrix)}};
}

Json describe(const GlbScene& scene, GlbBuffer& buffer) {
  Json root;
  root["asset"] = Json::Object{{"version", "2.0"}, {"generator", "Rayfarm " RAYFARM_VERSION}};
  root["extensionsUsed"] = Json::Array{"KHR_materials_unlit"};
  root["scene"] = 0;
  Json::Array materials, meshes, nodes, of_scene;
  for (const std::string& name : scene.materials) {
    const Json::Object plain{{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
    materials.emplace_back(
        Json::Object{{"name", name},
                     {"pbrMetallicRoughness", plain},
                     {"extensions", Json::Object{{"KHR_materials_unlit", Json::Object()}}}});
  }
  for (const GlbMesh& mesh : scene.meshes) {
    nodes.emplace_back(Json::Object{{"name", mesh.name}, {"mesh", meshes.size()}});
    meshes.push_back(mesh_of(mesh, buffer));
  }
  if (scene.camera) {
    nodes.push_back(node_of(*scene.camera));
    const Json::Object perspective{{"yfov", scene.camera->field_of_view},
                                   {"aspectRatio", scene.camera->aspect},
                                   {"znear", scene.camera->near}};
    root["cameras"] =
        Json::Array{Json::Object{{"type", "perspective"}, {"name", "view"}, {"perspective", perspective}}};
  }
  for (size_t i = 0; i < nodes.size(); ++i) of_scene.emplace_back(i);
  root["scenes"] = Json::Array{
      Json::Object{{"nodes", std::move(of_scene)}, {"extras", Json::Object{{"rayfarm", scene.about}}}}};
  root["nodes"] = std::move(nodes);
  if (!materials.empty()) root["materials"] = std::move(materials);
  if (!meshes.empty()) root["meshes"] = std::move(meshes);
  buffer.describe(root);
  return root;
}

void write_words(std::FILE* file, std::initializer_list<uint32_t> words) {
  for (const uint32_t word : words)
    for (int i = 0; i < 4; ++i) std::fputc(static_cast<int>(word >> 8 * i & 0xff), file);
}

}  // namespace

void write_glb(const std::string& path, const GlbScene& scene) {
  GlbBuffer buffer;
  std::string text;
  try {
    text = describe(scene, buffer).dump();
  } catch (const JsonError& e) {
    throw IoError(fmt::format("{}: can't be written: a name in the scene is no text ({})", path, e.what()));
  }
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const uint64_t size = 12 + 8 + text.size() + (buffer.size() > 0 ? 8 + buffer.size() : 0);
  if (size > std::numeric_limits<uint32_t>::max())
    throw IoError(fmt::format("{}: would be {:.1f} GiB, and a .glb holds 4; a larger --zone-size is needed",
                              path, static_cast<double>(size) / 0x1p30));
  write_whole_file(path, [&](std::FILE* file) {  // what fails shows in the file's own mark
    write_words(file, {kGlb, kGltfVersion, static_cast<uint32_t>(size)});
    write_words(file, {static_cast<uint32_t>(text.size()), kJsonChunk});
    std::fwrite(text.data(), 1, text.size(), file);
    if (buffer.size() == 0) return;
    write_words(file, {static_cast<uint32_t>(buffer.size()), kBinaryChunk});
    for (const std::span<const std::byte> part : buffer.parts())
      std::fwrite(part.data(), 1, part.size(), file);
  });
}

}  // namespace rayfarm
