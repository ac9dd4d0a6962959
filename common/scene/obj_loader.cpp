// Wavefront OBJ through tinyobjloader. The library skips what it doesn't understand, so everything it returns
// is checked here before it becomes part of the scene.
#include <tiny_obj_loader.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/scene/scene_loaders.h"

namespace rayfarm {
namespace {

MaterialDescription convert(const tinyobj::material_t& m) {
  MaterialDescription material;
  material.name = m.name;
  material.color = Color(m.diffuse[0], m.diffuse[1], m.diffuse[2]);
  material.specular = (m.specular[0] + m.specular[1] + m.specular[2]) / 3.0;
  material.shininess = m.shininess;
  // MTL: illum 3 and above ask for reflection, 4, 6, 7 and 9 for glass; d is the opacity.
  material.reflect = m.illum >= 3 ? material.specular : 0;
  material.transmit = m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9 ? 1.0 - m.dissolve : 0;
  material.index = m.ior > 0 ? m.ior : 1;
  return material;
}

/// The first line on which an `f` record names a vertex index that does not exist, for the error's place.
int line_of_face(const std::string& text, size_t face) {
  int line = 0;
  size_t seen = 0;
  std::istringstream in(text);
  for (std::string row; std::getline(in, row);) {
    ++line;
    const size_t first = row.find_first_not_of(" \t");
    if (first != std::string::npos && row[first] == 'f' && first + 1 < row.size() &&
        std::isspace(static_cast<unsigned char>(row[first + 1])))
      if (seen++ == face) return line;
  }
  return 0;
}

/// The library takes what it can't read for 0. Every number of a vertex or normal must be one, and finite.
void check_numbers(const std::string& path, const std::string& text) {
  int line = 0;
  for (size_t begin = 0; begin < text.size();) {
    ++line;
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view row(text.data() + begin, end - begin);
    size_t at = row.find_first_not_of(" \t");
    begin = end + 1;
    if (at == std::string_view::npos || row[at] != 'v') continue;
    const size_t space = row.find_first_of(" \t", at);
    const std::string_view record = row.substr(at, space == std::string_view::npos ? space : space - at);
    if (record != "v" && record != "vn") continue;
    at += record.size();
    for (int i = 0; i < 3; ++i) {
      at = std::min(row.find_first_not_of(" \t\r", at), row.size());
      const size_t stop = std::min(row.find_first_of(" \t\r", at), row.size());
      double value = 0;
      const auto [last, error] = std::from_chars(row.data() + at, row.data() + stop, value);
      if (error != std::errc{} || last != row.data() + stop || !std::isfinite(value))
        throw InputError({path, line, static_cast<int>(at) + 1},
                         fmt::format("expected a finite number, found '{}'",
                                     row.substr(at, std::min<size_t>(stop - at, 40))));
      at = stop;
    }
  }
}

class RecordingMaterialReader : public tinyobj::MaterialReader {
 public:
  RecordingMaterialReader(std::string folder, SceneDescription& scene)
      : folder_(std::move(folder)), scene_(scene) {}
  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* ids, std::string* warning, std::string* error) override {
    const std::string path = (std::filesystem::path(folder_) / name).string();
    std::istringstream text(
        read_text_file(path, limits::kFileBytes));  // a missing library is an error, not a warning
    scene_.files.push_back(path);
    tinyobj::LoadMtl(ids, materials, &text, warning, error);
    return true;
  }

 private:
  std::string folder_;
  SceneDescription& scene_;
};

}  // namespace

PrimitiveDescription load_obj_mesh(SceneDescription& scene, const std::string& path, uint32_t material,
                                   Smoothing smoothing, const Place& place) {
  const std::string text = read_text_file(path, limits::kFileBytes);
  scene.files.push_back(path);
  check_numbers(path, text);
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  std::istringstream in(text);
  RecordingMaterialReader reader(std::filesystem::path(path).parent_path().string(), scene);
  if (!tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &in, &reader,
                        /*triangulate=*/false))
    throw InputError({path}, error.empty() ? "not a readable OBJ file" : error);

  MeshShape mesh;
  mesh.smoothing = smoothing;
  const size_t vertex_count = attributes.vertices.size() / 3, normal_count = attributes.normals.size() / 3;
  mesh.positions.resize(vertex_count);
  for (size_t i = 0; i < vertex_count; ++i) {
    mesh.positions[i] = {attributes.vertices[3 * i], attributes.vertices[3 * i + 1],
                         attributes.vertices[3 * i + 2]};
    if (!is_finite(Vec3(mesh.positions[i])) || max_magnitude(Vec3(mesh.positions[i])) > limits::kCoordinate)
      throw InputError({path},
                       fmt::format("vertex {} is not finite or beyond {:g}", i + 1, limits::kCoordinate));
  }
  mesh.normals.resize(normal_count);
  for (size_t i = 0; i < normal_count; ++i)
    mesh.normals[i] = {attributes.normals[3 * i], attributes.normals[3 * i + 1],
                       attributes.normals[3 * i + 2]};

  const auto first_material = static_cast<uint32_t>(scene.materials.size());
  for (const tinyobj::material_t& m : materials) {
    scene.materials.push_back(convert(m));
    const MaterialDescription& last = scene.materials.back();
    if (!is_finite(last.color) || !std::isfinite(last.specular) || !std::isfinite(last.shininess))
      throw InputError({path}, fmt::format("material '{}' has a number that is not finite", m.name));
  }

  const size_t uv_count = attributes.texcoords.size() / 2;
  for (size_t i = 0; i < uv_count; ++i)
    mesh.uvs.emplace_back(attributes.texcoords[2 * i], attributes.texcoords[2 * i + 1]);
  mesh.uvs.emplace_back(0);  // of corners that have none

  size_t face = 0;
  for (const tinyobj::shape_t& shape : shapes) {
    size_t first = 0;
    for (size_t f = 0; f < shape.mesh.num_face_vertices.size(); ++f, ++face) {
      const size_t sides = shape.mesh.num_face_vertices[f];
      const auto corner = [&](size_t i) { return shape.mesh.indices[first + i]; };
      for (size_t i = 0; i < sides; ++i) {
        const int v = corner(i).vertex_index, n = corner(i).normal_index;
        if (v < 0 || static_cast<size_t>(v) >= vertex_count ||
            (n >= 0 && static_cast<size_t>(n) >= normal_count))
          throw InputError(
              {path, line_of_face(text, face)},
              fmt::format(
                  "the face names vertex {} and normal {}, but the file has {} vertices and {} normals",
                  v + 1, n + 1, vertex_count, normal_count));
      }
      // A fan from the first corner: faces of OBJ files are convex by convention.
      for (size_t i = 1; i + 1 < sides; ++i) {
        const std::array<size_t, 3> fan{0, i, i + 1};
        glm::uvec3 v, n, uv;
        bool has_normals = smoothing != Smoothing::flat;
        for (int k = 0; k < 3; ++k) {
          const tinyobj::index_t index = corner(fan[static_cast<size_t>(k)]);
          v[k] = static_cast<uint32_t>(index.vertex_index);
          n[k] = static_cast<uint32_t>(index.normal_index);
          const bool has_uv =
              index.texcoord_index >= 0 && static_cast<size_t>(index.texcoord_index) < uv_count;
          uv[k] = static_cast<uint32_t>(has_uv ? static_cast<size_t>(index.texcoord_index) : uv_count);
          has_normals = has_normals && index.normal_index >= 0;
        }
        mesh.triangles.push_back(v);
        if (uv_count > 0) mesh.triangle_uvs.push_back(uv);
        mesh.triangle_normals.push_back(has_normals ? n : glm::uvec3(~0u));
        const int m = shape.mesh.material_ids[f];
        mesh.materials.push_back(m >= 0 ? first_material + static_cast<uint32_t>(m) : material);
      }
      first += sides;
    }
  }
  if (mesh.triangles.empty())
    throw InputError({path},
                     "the file has no faces" + (warning.empty() ? std::string{} : " (" + warning + ")"));
  if (mesh.triangles.size() > limits::kPrimitives)
    throw InputError({path}, "the mesh has too many triangles");

  // A smooth mesh without normals gets the average of its faces' normals at each vertex (Gouraud,
  // thesis 2.3.5).
  if (smoothing != Smoothing::flat && normal_count == 0) {
    std::vector<Vec3> sums(vertex_count, Vec3(0));
    for (const glm::uvec3& t : mesh.triangles) {
      const Vec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
      const Vec3 normal = normalized(glm::cross(b - a, c - a));
      for (int k = 0; k < 3; ++k) sums[t[k]] += normal;
    }
    for (const Vec3& s : sums) mesh.normals.emplace_back(normalized(s));
    mesh.triangle_normals = mesh.triangles;
  }
  return {std::move(mesh), material, place};
}

}  // namespace rayfarm
