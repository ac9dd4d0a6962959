#pragma once
// Meshes of a glTF file.
#include "common/description/formats/gltf/deformation.h"
#include "common/description/formats/gltf/materials.h"

namespace rayfarm {

class GltfMeshes {
 public:
  /// All must outlive it. `place`: of what is made.
  GltfMeshes(const GltfFile& file, SceneDescription& scene, GltfMaterials& materials, const Place& place)
      : file_(file), scene_(scene), materials_(materials), place_(place) {}

  /// What a mesh has of triangles. `deformer` may be null: it keeps its shape. Throws InputError.
  std::vector<PrimitiveDescription> primitives(uint32_t mesh, const GltfDeformer* deformer);
  /// Says what was left out.
  void add_notes() const;

 private:
  /// What a primitive's corners make.
  enum class Topology : uint64_t {
    points,
    lines,
    line_loop,
    line_strip,
    triangles,
    triangle_strip,
    triangle_fan
  };

  std::optional<PrimitiveDescription> read(const GltfValue& value, const GltfDeformer* deformer);
  LargeVector<uint32_t> read_corners(const GltfValue& value, const GltfAccessor& positions);
  LargeVector<glm::uvec3> make_triangles(const GltfValue& value, std::span<const uint32_t> corners,
                                         Topology mode, bool is_copy);
  static GltfUsedVertices keep_used(LargeVector<glm::uvec3>& triangles, size_t count);
  std::optional<GltfAccessor> attribute(const GltfValue& primitive, const std::string& name, size_t count,
                                        std::initializer_list<size_t> components) const;
  void read_normals(const GltfAccessor& normals, const GltfUsedVertices& used, MeshShape& mesh);
  void read_colors(const GltfAccessor& colors, const GltfUsedVertices& used, MeshShape& mesh);
  void read_uvs(const GltfAccessor& uvs, const GltfUsedVertices& used, LargeVector<glm::vec2>& to);
  void note_attributes(const GltfValue& primitive);

  const GltfFile& file_;
  SceneDescription& scene_;
  GltfMaterials& materials_;
  Place place_;
  size_t points_ = 0, lines_ = 0, cut_off_ = 0, bad_normals_ = 0, bad_uvs_ = 0, empty_ = 0;
  size_t bad_colors_ = 0, without_uvs_ = 0, without_second_uvs_ = 0, tangents_ = 0;
  std::set<std::string> unused_;
  GltfDeformationNotes notes_of_deformation_;
};

}  // namespace rayfarm
