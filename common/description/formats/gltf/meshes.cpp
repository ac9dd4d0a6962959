#include "common/description/formats/gltf/meshes.h"

#include <fmt/core.h>

namespace rayfarm {
namespace {

/// Every vertex's mean of the normals of its triangles, weighed by their areas.
std::vector<Vec3> mean_normals(const MeshShape& mesh) {
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    const Vec3 normal = glm::cross(b - a, c - a);
    for (int k = 0; k < 3; ++k) sums[t[k]] += normal;
  }
  return sums;
}

}  // namespace

uint32_t GltfUsedVertices::place_of(uint32_t vertex) const {
  if (vertices.empty()) return vertex;
  const auto found = std::lower_bound(vertices.begin(), vertices.end(), vertex);
  return found == vertices.end() || *found != vertex ? kNone
                                                     : static_cast<uint32_t>(found - vertices.begin());
}

std::vector<PrimitiveDescription> GltfMeshes::primitives(uint32_t mesh, const GltfDeformer* deformer) {
  const GltfValue value = file_.item("meshes", mesh), all = value.at("primitives");
  std::vector<PrimitiveDescription> result;
  for (size_t i = 0; i < all.size(); ++i) {
    throw_if_stopped(file_.options().stop);
    if (auto primitive = read(all[i], deformer)) result.push_back(std::move(*primitive));
  }
  return result;
}

std::optional<GltfAccessor> GltfMeshes::attribute(const GltfValue& primitive, const std::string& name,
                                                  size_t count,
                                                  std::initializer_list<size_t> components) const {
  const GltfValue attributes = primitive.at("attributes");
  if (!attributes.has(name.c_str())) return std::nullopt;
  return GltfAccessor::of_vertices(file_, attributes, name.c_str(), count, components);
}

LargeVector<uint32_t> GltfMeshes::read_corners(const GltfValue& value, const GltfAccessor& positions) {
  const uint32_t index = value.index("indices", file_.count("accessors"));
  if (index == kNone) {
    positions.check_room();
    LargeVector<uint32_t> corners(positions.count());
    for (size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<uint32_t>(i);
    return corners;
  }
  const GltfAccessor indices(file_, index);
  indices.expect_components({1});
  LargeVector<uint32_t> corners = indices.all<uint32_t>();
  for (size_t i = 0; i < corners.size(); ++i)
    if (corners[i] >= positions.count())
      value.at("indices").fail(fmt::format("its {}. index is {}, but there are {} vertices, counted from 0",
                                           i + 1, corners[i], positions.count()));
  return corners;
}

LargeVector<glm::uvec3> GltfMeshes::make_triangles(const GltfValue& value, std::span<const uint32_t> corners,
                                                   Topology mode, bool is_copy) {
  const size_t count = mode == Topology::triangles ? corners.size() / 3
                       : corners.size() < 3        ? 0
                                                   : corners.size() - 2;
  if (count > limits::kPrimitives) value.fail("it has too many triangles");
  if (!is_copy) file_.take_elements(value, count);
  if (mode == Topology::triangles && corners.size() % 3 != 0) ++cut_off_;
  LargeVector<glm::uvec3> result;
  result.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const size_t odd = i % 2;
    const glm::uvec3 t = mode == Topology::triangles
                             ? glm::uvec3(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2])
                         : mode == Topology::triangle_strip
                             ? glm::uvec3(corners[i], corners[i + 1 + odd], corners[i + 2 - odd])
                             : glm::uvec3(corners[i + 1], corners[i + 2], corners[0]);
    // Strips are sewn together by triangles that are none.
    if (mode == Topology::triangles || (t.x != t.y && t.y != t.z && t.z != t.x)) result.push_back(t);
  }
  return result;
}

GltfUsedVertices GltfMeshes::keep_used(LargeVector<glm::uvec3>& triangles, size_t count) {
  GltfUsedVertices used{{}, count};
  if (count / 2 <= 3 * triangles.size()) return used;
  used.vertices.reserve(3 * triangles.size());
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) used.vertices.push_back(t[k]);
  std::sort(used.vertices.begin(), used.vertices.end());
  used.vertices.erase(std::unique(used.vertices.begin(), used.vertices.end()), used.vertices.end());
  used.count = used.vertices.size();
  for (glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) t[k] = used.place_of(t[k]);
  return used;
}

void GltfMeshes::read_normals(const GltfAccessor& accessor, const GltfUsedVertices& used, MeshShape& mesh) {
  mesh.normals.resize(used.count);
  accessor.read(std::span(&mesh.normals[0].x, 3 * used.count), used.vertices);
  std::vector<Vec3> means;
  for (size_t i = 0; i < used.count; ++i) {
    const Vec3 n(mesh.normals[i]);
    if (is_finite(n) && max_magnitude(n) > 0) continue;
    if (means.empty()) means = mean_normals(mesh);
    const Vec3 mean = normalized(means[i]);
    mesh.normals[i] = max_magnitude(mean) > 0 ? glm::vec3(mean) : glm::vec3(0, 0, 1);
    ++bad_normals_;
  }
  mesh.triangle_normals = mesh.triangles;
  mesh.smoothing = Smoothing::phong;
}

void GltfMeshes::read_colors(const GltfAccessor& accessor, const GltfUsedVertices& used, MeshShape& mesh) {
  const size_t parts = accessor.components();
  LargeVector<float> values(parts * used.count);
  accessor.read(std::span<float>(values), used.vertices);
  mesh.colors.resize(used.count);
  bool is_white = true;
  for (size_t i = 0; i < used.count; ++i) {
    const float* const v = &values[parts * i];
    bad_colors_ += std::any_of(v, v + parts, [](float x) { return !(x >= 0 && x <= 1); }) ? 1 : 0;
    mesh.colors[i] = make_vertex_color(Color(glm::vec3(v[0], v[1], v[2])), parts == 4 ? double{v[3]} : 1);
    is_white = is_white && mesh.colors[i] == kWhiteVertex;
  }
  if (is_white) mesh.colors.clear();
}

void GltfMeshes::read_uvs(const GltfAccessor& accessor, const GltfUsedVertices& used,
                          LargeVector<glm::vec2>& to) {
  to.resize(used.count);
  accessor.read(std::span(&to[0].x, 2 * used.count), used.vertices);
  for (glm::vec2& uv : to) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      uv = glm::vec2(0);
      ++bad_uvs_;
    }
    uv.y = 1 - uv.y;  // Rayfarm's v runs up
  }
}

void GltfMeshes::note_attributes(const GltfValue& primitive) {
  for (const std::string& name : primitive.at("attributes").keys()) {
    const bool is_known = name == "POSITION" || name == "NORMAL" || name == "TEXCOORD_0" ||
                          name == "TEXCOORD_1" || name == "COLOR_0" || name == "TANGENT" ||
                          name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") ||
                          name.starts_with("_");  // an application's own
    if (!is_known && unused_.size() < 20) unused_.insert(name.substr(0, 40));
  }
}

std::optional<PrimitiveDescription> GltfMeshes::read(const GltfValue& value, const GltfDeformer* deformer) {
  const GltfValue attributes = value.at("attributes");
  const uint32_t position = attributes.index("POSITION", file_.count("accessors"));
  if (position == kNone) {
    ++empty_;
    return std::nullopt;
  }
  const GltfAccessor positions(file_, position);
  positions.expect_components({3});
  if (value.extension("KHR_draco_mesh_compression") && positions.is_mostly_zero())
    value.fail(
        "it is compressed with KHR_draco_mesh_compression, which is not read here; export the file without "
        "it (gltf-transform and Blender can)");
  const uint64_t number = value.whole_number("mode", uint64_t{4});
  if (number > 6) value.at("mode").fail("a mode from 0 to 6 was expected");
  const auto mode = static_cast<Topology>(number);
  const LargeVector<uint32_t> corners = read_corners(value, positions);
  if (mode == Topology::points) points_ += corners.size();
  if (mode == Topology::lines) lines_ += corners.size() / 2;
  if (mode == Topology::line_loop) lines_ += corners.size();
  if (mode == Topology::line_strip) lines_ += corners.size() - 1;
  if (mode < Topology::triangles) return std::nullopt;

  MeshShape mesh;
  mesh.triangles = make_triangles(value, corners, mode, deformer && deformer->is_copy);
  if (mesh.triangles.empty()) {
    ++empty_;
    return std::nullopt;
  }
  const size_t count = positions.count();
  const GltfUsedVertices used = keep_used(mesh.triangles, count);
  mesh.positions.resize(used.count);
  positions.read(std::span(&mesh.positions[0].x, 3 * used.count), used.vertices);
  for (size_t i = 0; i < used.count; ++i)
    if (!(max_magnitude(Vec3(mesh.positions[i])) <= limits::kCoordinate) ||
        !is_finite(Vec3(mesh.positions[i])))
      attributes.at("POSITION")
          .fail(fmt::format("vertex {} has coordinates that are no numbers, or too large",
                            used.vertices.empty() ? i : used.vertices[i]));
  if (const auto normals = attribute(value, "NORMAL", count, {3})) read_normals(*normals, used, mesh);
  if (const auto colors = attribute(value, "COLOR_0", count, {3, 4})) read_colors(*colors, used, mesh);
  const bool has_opacity = std::any_of(mesh.colors.begin(), mesh.colors.end(),
                                       [](const VertexColor& c) { return c.w < kWhiteVertex.w; });
  const uint32_t material =
      materials_.material(value.index("material", file_.count("materials")), has_opacity);
  if (const auto uvs = attribute(value, "TEXCOORD_0", count, {2})) {
    read_uvs(*uvs, used, mesh.uvs);
    mesh.triangle_uvs = mesh.triangles;
  }
  const auto& sources = scene_.principled[scene_.materials[material].principled].sources;
  if (std::any_of(sources.begin(), sources.end(), [](const PrincipledSource& s) { return s.uv_set == 1; }))
    if (const auto uvs = attribute(value, "TEXCOORD_1", count, {2})) read_uvs(*uvs, used, mesh.second_uvs);
  const auto needs = [&](uint32_t set) {
    return std::any_of(sources.begin(), sources.end(),
                       [set](const PrincipledSource& s) { return s.texture != kNone && s.uv_set == set; });
  };
  without_uvs_ += mesh.uvs.empty() && needs(0) ? 1 : 0;
  without_second_uvs_ += mesh.second_uvs.empty() && needs(1) ? 1 : 0;
  const auto has_normal_map = [&](PrincipledInput input) {
    return sources[static_cast<size_t>(input)].texture != kNone;
  };
  tangents_ += attributes.has("TANGENT") && (has_normal_map(PrincipledInput::normal) ||
                                             has_normal_map(PrincipledInput::clearcoat_normal))
                   ? 1
                   : 0;
  note_attributes(value);
  if (deformer)
    mesh.deformation =
        read_deformation(file_, value, count, used, *deformer, !mesh.normals.empty(), notes_of_deformation_);
  return PrimitiveDescription{std::move(mesh), material, place_};
}

void GltfMeshes::add_notes() const {
  const auto add = [&](size_t count, const char* one, const char* several, const char* what) {
    if (count > 0)
      scene_.notes.add({file_.path()}, fmt::format("{} {} {}", count, count == 1 ? one : several, what));
  };
  add(points_, "point", "points", "left out: only triangles are rendered");
  add(lines_, "line", "lines", "left out: only triangles are rendered");
  add(cut_off_, "primitive", "primitives", "whose corners are no multiple of three: the rest is left out");
  add(empty_, "primitive", "primitives", "without a single triangle or without POSITION, left out");
  add(bad_normals_, "normal", "normals", "without a direction, replaced by those of the faces around");
  add(bad_colors_, "colour", "colours",
      "of vertices that are not from 0 to 1, taken for the nearest that are");
  add(without_uvs_, "primitive", "primitives",
      "with textures but without TEXCOORD_0: every triangle shows a triangle of its textures");
  add(without_second_uvs_, "primitive", "primitives",
      "with textures for TEXCOORD_1 but without that: they are laid out by TEXCOORD_0");
  add(tangents_, "primitive", "primitives",
      "whose TANGENT is not read: maps of normals lie along the directions of the texture coordinates, as "
      "where a file has no tangents");
  add(bad_uvs_, "texture coordinate", "texture coordinates", "that are no numbers, taken for 0");
  std::string names;
  for (const std::string& name : unused_) names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
  if (!names.empty()) scene_.notes.add({file_.path()}, fmt::format("not used of vertices: {}", names));
  notes_of_deformation_.add_to(scene_.notes, {file_.path()});
}

}  // namespace rayfarm
