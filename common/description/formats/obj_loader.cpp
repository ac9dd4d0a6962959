// Wavefront OBJ through tinyobjloader. The library takes what it doesn't understand for nothing and cuts
// names at spaces, so ObjRecords looks at the file before it.
#include <tiny_obj_loader.h>

#include <filesystem>
#include <istream>

#include "common/description/formats/mesh_faces.h"
#include "common/description/formats/obj_records.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/formats/stoppable_text.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

/// The line of an `f` record, for an error's place.
int line_of_face(std::string_view text, size_t face) {
  Records records(text, "", {});
  size_t seen = 0;
  while (records.next())
    if (records.keyword() == "f" && seen++ == face) return records.line_place().line;
  return 0;
}

/// What the library finds. Its indices are as the file has them: from 1, below 0 from the end, 0 for none.
struct Found {
  MeshShape& mesh;
  std::vector<tinyobj::index_t> corners;
  std::vector<uint32_t> sides;  ///< of each face

  void add_face(const tinyobj::index_t* indices, size_t count) {
    const auto from_0 = [](int& index, size_t so_far) {
      index = index > 0 ? index - 1 : index < 0 ? static_cast<int>(static_cast<int64_t>(so_far) + index) : -1;
    };
    for (size_t i = 0; i < count; ++i) {
      tinyobj::index_t corner = indices[i];
      from_0(corner.vertex_index, mesh.positions.size());
      from_0(corner.normal_index, mesh.normals.size());
      from_0(corner.texcoord_index, mesh.uvs.size());
      corners.push_back(corner);
    }
    sides.push_back(static_cast<uint32_t>(count));
  }
};

void read_mesh(const std::string& path, std::string_view text, const std::stop_token& stop, Found& found) {
  tinyobj::callback_t callback;
  callback.vertex_cb = [](void* to, float x, float y, float z, float) {
    static_cast<Found*>(to)->mesh.positions.emplace_back(x, y, z);
  };
  callback.normal_cb = [](void* to, float x, float y, float z) {
    static_cast<Found*>(to)->mesh.normals.emplace_back(x, y, z);
  };
  callback.texcoord_cb = [](void* to, float u, float v, float) {
    static_cast<Found*>(to)->mesh.uvs.emplace_back(u, v);
  };
  callback.index_cb = [](void* to, tinyobj::index_t* indices, int count) {
    static_cast<Found*>(to)->add_face(indices, static_cast<size_t>(count));
  };
  StoppableText buffer(text, stop);
  std::istream in(&buffer);
  in.exceptions(std::ios::badbit);  // what the buffer throws is not swallowed
  std::string error;
  if (!tinyobj::LoadObjWithCallback(in, callback, &found, nullptr, nullptr, &error))
    throw InputError({path}, error.empty() ? "not a readable OBJ file" : error);
}

}  // namespace

PrimitiveDescription load_obj_mesh(SceneDescription& scene, const std::string& path, uint32_t material,
                                   Smoothing smoothing, const Place& place, const std::stop_token& stop) {
  const std::string text = read_text_file(path, limits::kFileBytes, stop);
  scene.files.push_back(path);
  ObjRecords records(scene, text, path, material, stop);
  MeshShape mesh;
  mesh.smoothing = smoothing;
  Found found{mesh, {}, {}};
  const ObjRecords::Counts& counts = records.counts();
  mesh.positions.reserve(counts.vertices);
  mesh.normals.reserve(counts.normals);
  mesh.uvs.reserve(counts.uvs + 1);
  found.corners.reserve(counts.corners);
  found.sides.reserve(counts.faces);
  read_mesh(path, text, stop, found);

  for (size_t i = 0; i < mesh.positions.size(); ++i)
    if (!is_finite(Vec3(mesh.positions[i])) || max_magnitude(Vec3(mesh.positions[i])) > limits::kCoordinate)
      throw InputError({path},
                       fmt::format("vertex {} is not finite or beyond {:g}", i + 1, limits::kCoordinate));
  const size_t vertex_count = mesh.positions.size(), normal_count = mesh.normals.size(),
               uv_count = mesh.uvs.size();
  if (uv_count > 0) mesh.uvs.emplace_back(0);  // of corners that have none
  const auto exists = [](int index, size_t count) {
    return index >= 0 && static_cast<size_t>(index) < count;
  };
  reserve_faces(found.sides, uv_count > 0, mesh);
  std::vector<FaceCorner> corners;
  const tinyobj::index_t* corner = found.corners.data();
  for (size_t face = 0; face < found.sides.size(); corner += found.sides[face++]) {
    throw_if_stopped(stop);
    const size_t sides = found.sides[face];
    const uint32_t of_face = records.next_material();
    if (sides > limits::kPolygonPoints)
      throw InputError({path, line_of_face(text, face)},
                       fmt::format("a face has at most {} corners", limits::kPolygonPoints));
    corners.clear();
    for (size_t i = 0; i < sides; ++i) {
      const int v = corner[i].vertex_index, n = corner[i].normal_index, uv = corner[i].texcoord_index;
      if (!exists(v, vertex_count) || (n >= 0 && !exists(n, normal_count)))
        throw InputError(
            {path, line_of_face(text, face)},
            fmt::format("the face names vertex {} and normal {}, but the file has {} vertices and {} normals",
                        v + 1, n + 1, vertex_count, normal_count));
      corners.push_back({static_cast<uint32_t>(v), n >= 0 ? static_cast<uint32_t>(n) : ~0u,
                         static_cast<uint32_t>(exists(uv, uv_count) ? static_cast<size_t>(uv) : uv_count)});
    }
    if (sides >= 3) add_face(mesh, corners, of_face);
  }
  const size_t face_count = mesh.triangles.size() + mesh.polygons.sides.size();
  if (face_count == 0) throw InputError({path}, "the file has no faces");
  if (face_count > limits::kPrimitives) throw InputError({path}, "the mesh has too many faces");

  if (smoothing != Smoothing::flat && mesh.normals.empty()) {
    if (records.has_smoothing_groups())
      scene.notes.add({path}, "`s` is not used: a smooth mesh without normals is smooth everywhere");
    average_normals(mesh, stop);
  }
  return {std::move(mesh), material, place};
}

}  // namespace rayfarm
