#pragma once
// OBJ, PLY, STL and NFF texts that are read in pieces, and all that they become: what unit tests and the
// fuzzer compare.
#include <fmt/core.h>

#include <stdexcept>

#include "common/description/formats/nff_scene.h"
#include "common/description/formats/obj_mesh.h"
#include "common/description/formats/ply_header.h"
#include "common/description/formats/stl_mesh.h"
#include "common/errors/input_error.h"

namespace rayfarm::test {

struct MeshOutcome {
  MeshShape mesh;
  std::vector<std::string> notes, materials;
  std::string error;
};

/// What read(scene) makes of a file.
template <typename Read>
MeshOutcome mesh_outcome(Read read) {
  SceneDescription scene;
  scene.materials.emplace_back("default");
  MeshOutcome outcome;
  try {
    outcome.mesh = read(scene);
  } catch (const InputError& e) {
    outcome.error = e.what();
  }
  outcome.notes = scene.notes.lines();
  for (const MaterialDescription& m : scene.materials) outcome.materials.push_back(m.name);
  return outcome;
}

inline MeshOutcome read_obj(std::string_view text, const std::string& path, std::span<const size_t> borders,
                            Smoothing smoothing = Smoothing::phong) {
  return mesh_outcome([&](SceneDescription& scene) {
    return read_obj_mesh(scene, text, {path, 0, smoothing, {}}, borders);
  });
}
inline MeshOutcome read_stl(std::string_view bytes, const std::string& path, std::span<const size_t> borders,
                            Smoothing smoothing = Smoothing::phong) {
  return mesh_outcome([&](SceneDescription& scene) {
    return read_stl_mesh(scene, bytes, {path, 0, smoothing, {}}, borders, {});
  });
}
inline MeshOutcome read_ply(std::string_view bytes, const std::string& path, std::span<const size_t> borders,
                            Smoothing smoothing = Smoothing::phong) {
  return mesh_outcome([&](SceneDescription& scene) {
    const MeshTables tables = read_ply_header(scene, bytes, path);
    return read_mesh_tables(scene, tables, {path, 0, smoothing, {}}, borders, {});
  });
}

inline bool is_same(const MeshShape& a, const MeshShape& b) {
  return a.positions == b.positions && a.normals == b.normals && a.uvs == b.uvs &&
         a.triangles == b.triangles && a.triangle_normals == b.triangle_normals &&
         a.triangle_uvs == b.triangle_uvs && a.colors == b.colors && a.materials == b.materials &&
         a.polygons.sides == b.polygons.sides && a.polygons.corners == b.polygons.corners &&
         a.polygons.normals == b.polygons.normals && a.polygons.uvs == b.polygons.uvs &&
         a.polygons.materials == b.polygons.materials;
}
/// What a mesh held before its error does not count.
inline bool is_same(const MeshOutcome& a, const MeshOutcome& b) {
  return a.error == b.error && a.notes == b.notes && a.materials == b.materials &&
         (!a.error.empty() || is_same(a.mesh, b.mesh));
}

inline std::string text_of(const Vec3& v) {
  return fmt::format("({} {} {})", v.x, v.y, v.z);
}

/// Each primitive as a line, each triangle of a mesh as one: where meshes end does not count.
inline std::vector<std::string> primitives_of(const SceneDescription& scene) {
  std::vector<std::string> lines;
  for (const PrimitiveDescription& p : scene.objects.at(scene.root).primitives) {
    const std::string material = fmt::format("of {}: ", p.material);
    if (const auto* mesh = std::get_if<MeshShape>(&p.shape)) {
      if (!mesh->polygons.sides.empty() || !mesh->normals.empty() || !mesh->materials.empty())
        throw std::logic_error("the meshes of NFF hold triangles alone");
      for (const glm::uvec3& t : mesh->triangles) {
        lines.push_back(material + "triangle");
        for (int k = 0; k < 3; ++k) lines.back() += text_of(Vec3(mesh->positions.at(t[k])));
      }
      continue;
    }
    lines.push_back(material + fmt::format("{}:{} ", p.place.line, p.place.column));
    if (const auto* s = std::get_if<SphereShape>(&p.shape))
      lines.back() += "sphere" + text_of(s->center) + fmt::format("{}", s->radius);
    if (const auto* c = std::get_if<ConeShape>(&p.shape))
      lines.back() +=
          "cone" + text_of(c->base) + text_of(c->apex) + fmt::format("{} {}", c->base_radius, c->apex_radius);
    if (const auto* polygon = std::get_if<PolygonShape>(&p.shape)) {
      lines.back() += "polygon";
      for (const Vec3& v : polygon->points) lines.back() += text_of(v);
      for (const Vec3& v : polygon->normals) lines.back() += text_of(v);
    }
  }
  return lines;
}

inline std::string text_of(const ViewDescription& view) {
  return text_of(Vec3(view.location.values[0])) + text_of(Vec3(view.look_at->values[0])) +
         text_of(Vec3(view.up.values[0])) +
         fmt::format("{} {} {}", view.field_of_view.values[0].x, view.size_px()[0], view.size_px()[1]);
}

/// All that a file becomes; its error alone if it has one.
inline std::vector<std::string> read_nff(std::string_view text, const std::string& path,
                                         std::span<const size_t> borders) {
  try {
    const SceneDescription scene = read_nff_scene(text, path, borders);
    std::vector<std::string> all = primitives_of(scene);
    all.push_back(text_of(scene.view) + text_of(scene.background) + text_of(scene.ambient));
    for (const MaterialDescription& m : scene.materials)
      all.push_back(
          fmt::format("{} {} {} {} {} {} ", m.name, m.diffuse, m.specular, m.shininess, m.transmit, m.index) +
          text_of(m.color));
    for (const Light& light : scene.lights) all.push_back(text_of(light.position) + text_of(light.color));
    for (const std::string& note : scene.notes.lines()) all.push_back(note);
    return all;
  } catch (const InputError& e) {
    return {e.what()};
  }
}

}  // namespace rayfarm::test
