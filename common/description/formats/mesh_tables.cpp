#include "common/description/formats/mesh_tables.h"

#include <numeric>

#include "common/description/formats/mesh_faces.h"
#include "common/description/formats/mesh_normals.h"
#include "common/description/formats/table_values.h"
#include "common/image/pixel_format.h"
#include "common/parallel/parallel_for.h"

namespace rayfarm {
namespace {

constexpr uint64_t kRowsPerLook = 1 << 12;

/// What numbers of a column are multiplied by to be colours: the largest whole number becomes 1.
double color_scale_of(NumberType type) {
  switch (type) {
    case NumberType::int8:
      return 1.0 / 127;
    case NumberType::uint8:
      return 1.0 / 255;
    case NumberType::int16:
      return 1.0 / 32767;
    case NumberType::uint16:
      return 1.0 / 65535;
    case NumberType::int32:
      return 1.0 / 2147483647;
    case NumberType::uint32:
      return 1.0 / 4294967295;
    default:
      return 1;
  }
}

/// What the rows of a chunk hold.
struct ChunkCounts {
  FacePlace faces;
  size_t corner_uvs = 0;
  uint64_t too_small = 0;    ///< faces of fewer than three corners
  uint64_t without_uvs = 0;  ///< faces whose coordinates are not one for each corner
  uint64_t bad_normals = 0, bad_uvs = 0, bad_colors = 0;
  std::vector<uint64_t> rests;  ///< by table: rows with more than their columns

  void add(const ChunkCounts& o) {
    faces.triangle += o.faces.triangle;
    faces.polygon += o.faces.polygon;
    faces.polygon_corner += o.faces.polygon_corner;
    corner_uvs += o.corner_uvs;
    too_small += o.too_small;
    without_uvs += o.without_uvs;
    bad_normals += o.bad_normals;
    bad_uvs += o.bad_uvs;
    bad_colors += o.bad_colors;
    for (size_t i = 0; i < o.rests.size(); ++i) rests[i] += o.rests[i];
  }
};

float finite_or_zero(float v, uint64_t& bad) {
  if (std::isfinite(v)) return v;
  ++bad;
  return 0;
}

/// The numbers of a vertex's row, by role.
struct VertexNumbers {
  std::array<float, kVertexRoles> all{};
  float& operator[](ColumnRole role) { return all[static_cast<size_t>(role)]; }
  glm::vec3 three_from(ColumnRole first) const {
    const float* const p = &all[static_cast<size_t>(first)];
    return {p[0], p[1], p[2]};
  }
};

class MeshTableReader {
 public:
  MeshTableReader(const MeshTables& tables, const MeshRequest& request, const std::stop_token& stop,
                  std::vector<TableChunk> chunks);

  MeshShape read(ReadProgress* progress);
  const ChunkCounts& counts() const { return all_; }

 private:
  template <typename Visit>
  void visit(const TableChunk& chunk, Visit visit) const {
    const MeshTable& table = tables_.tables[chunk.table];
    switch (tables_.encoding) {
      case TableEncoding::text:
        return visit(table, TextValues(table, chunk, path_));
      case TableEncoding::little_endian:
        return visit(table, BinaryValues<std::endian::little>(table, chunk, path_));
      case TableEncoding::big_endian:
        return visit(table, BinaryValues<std::endian::big>(table, chunk, path_));
    }
  }

  template <typename Values>
  void read_vertices(const MeshTable& table, Values& values, const TableChunk& chunk, ChunkCounts& counts);
  void set_vertex(size_t row, VertexNumbers& numbers, ChunkCounts& counts);

  /// Calls add(corners, uvs) for each face of three corners or more, and counts other things.
  template <typename Values, typename Add>
  void for_each_face(const MeshTable& table, Values& values, const TableChunk& chunk, ChunkCounts& counts,
                     Add add) const;
  template <typename Values>
  uint32_t read_corner(Values& values, NumberType type) const;
  template <typename Values, typename Add>
  void read_strip(Values& values, NumberType type, uint64_t size, Add add) const;

  void count_faces(size_t chunk);
  void set_faces(size_t chunk);

  const MeshTables& tables_;
  const std::string& path_;
  const std::stop_token& stop_;
  std::vector<TableChunk> chunks_;
  std::vector<ChunkCounts> counts_;  ///< by chunk; then of all chunks before
  ChunkCounts all_;
  uint64_t vertices_ = 0;
  bool has_uvs_ = false, has_corner_uvs_ = false;
  double color_scale_ = 1, opacity_scale_ = 1;
  bool has_colors_ = false, has_opacity_ = false;
  MeshShape mesh_;
};

MeshTableReader::MeshTableReader(const MeshTables& tables, const MeshRequest& request,
                                 const std::stop_token& stop, std::vector<TableChunk> chunks)
    : tables_(tables), path_(request.path), stop_(stop), chunks_(std::move(chunks)), counts_(chunks_.size()) {
  all_.rests.resize(tables.tables.size());
  bool has_normals = false;
  for (const MeshTable& table : tables.tables) {
    has_corner_uvs_ |= table.use != TableUse::vertices && table.has(ColumnRole::corner_uvs);
    if (table.use != TableUse::vertices) continue;
    vertices_ = table.rows;
    has_uvs_ = table.has(ColumnRole::u);
    has_normals = table.has(ColumnRole::normal_x);
    has_colors_ = table.has(ColumnRole::red);
    has_opacity_ = table.has(ColumnRole::alpha);
    for (const TableColumn& column : table.columns) {
      if (column.role == ColumnRole::red) color_scale_ = color_scale_of(column.type);
      if (column.role == ColumnRole::alpha) opacity_scale_ = color_scale_of(column.type);
    }
  }
  mesh_.smoothing = !request.is_smoothing_asked_for && has_normals ? Smoothing::phong : request.smoothing;
  mesh_.positions.resize(vertices_);
  if (has_normals && mesh_.smoothing != Smoothing::flat) mesh_.normals.resize(vertices_);
  if (has_colors_) mesh_.colors.resize(vertices_);
}

MeshShape MeshTableReader::read(ReadProgress* progress) {
  parallel_for(chunks_.size(), [this](size_t i) { count_faces(i); });
  for (ChunkCounts& counts : counts_) {
    ChunkCounts before = all_;
    all_.add(counts);
    counts = std::move(before);
  }
  if (has_corner_uvs_)
    mesh_.uvs.resize(all_.corner_uvs + 1);  // the last: of corners that have none
  else if (has_uvs_)
    mesh_.uvs.resize(vertices_);
  resize_faces(mesh_, all_.faces);
  std::vector<ChunkCounts> of_vertices(chunks_.size());
  parallel_for(chunks_.size(), [&](size_t i) {
    const TableChunk& chunk = chunks_[i];
    const TableUse use = tables_.tables[chunk.table].use;
    if (use == TableUse::vertices)
      visit(chunk, [&](const MeshTable& table, auto values) {
        read_vertices(table, values, chunk, of_vertices[i]);
      });
    else if (use != TableUse::unused)
      set_faces(i);
    count_read(progress, chunk.bytes.size());
  });
  for (const ChunkCounts& counts : of_vertices) all_.add(counts);
  return std::move(mesh_);
}

template <typename Values>
uint64_t list_size(Values& values, const TableColumn& column) {
  const int64_t size = values.whole(*column.count_type);
  if (size < 0) values.fail(fmt::format("a list can't have {} numbers", size));
  return static_cast<uint64_t>(size);
}

template <typename Values>
void MeshTableReader::read_vertices(const MeshTable& table, Values& values, const TableChunk& chunk,
                                    ChunkCounts& counts) {
  counts.rests.resize(tables_.tables.size());
  VertexNumbers numbers;
  for (uint64_t i = 0; i < chunk.rows; ++i) {
    if (i % kRowsPerLook == 0) throw_if_stopped(stop_);
    values.next_row();
    for (const TableColumn& column : table.columns) {
      if (column.count_type)
        values.skip(column.type, list_size(values, column));
      else if (column.role == ColumnRole::unused)
        values.skip(column.type, 1);
      else
        numbers[column.role] = values.real(column.type);
    }
    counts.rests[chunk.table] += values.has_more();
    if (!is_position(numbers.three_from(ColumnRole::x)))
      values.fail(fmt::format("the vertex is not finite or beyond {:g}", limits::kCoordinate));
    set_vertex(chunk.first_row + i, numbers, counts);
  }
}

void MeshTableReader::set_vertex(size_t row, VertexNumbers& numbers, ChunkCounts& counts) {
  mesh_.positions[row] = numbers.three_from(ColumnRole::x);
  if (!mesh_.normals.empty()) {
    const glm::vec3 n = numbers.three_from(ColumnRole::normal_x);
    mesh_.normals[row] = is_finite(Vec3(n)) ? n : glm::vec3(0);
    counts.bad_normals += !is_finite(Vec3(n)) || n == glm::vec3(0);
  }
  if (has_uvs_ && !has_corner_uvs_) {
    const float u = finite_or_zero(numbers[ColumnRole::u], counts.bad_uvs);
    mesh_.uvs[row] = {u, finite_or_zero(numbers[ColumnRole::v], counts.bad_uvs)};
  }
  if (!has_colors_) return;
  const glm::vec3 stored = numbers.three_from(ColumnRole::red);
  Color color;
  for (int k = 0; k < 3; ++k) {
    color[k] = decode_srgb(
        std::max(0.0, color_scale_ * static_cast<double>(finite_or_zero(stored[k], counts.bad_colors))));
  }
  const double opacity = has_opacity_ ? opacity_scale_ * static_cast<double>(finite_or_zero(
                                                             numbers[ColumnRole::alpha], counts.bad_colors))
                                      : 1;
  mesh_.colors[row] = make_vertex_color(color, opacity);
}

template <typename Values>
uint32_t MeshTableReader::read_corner(Values& values, NumberType type) const {
  const int64_t vertex = values.whole(type);
  if (vertex < 0 || static_cast<uint64_t>(vertex) >= vertices_)
    values.fail(
        fmt::format("it names vertex {}, but the file has {} vertices, counted from 0", vertex, vertices_));
  return static_cast<uint32_t>(vertex);
}

template <typename Values, typename Add>
void MeshTableReader::read_strip(Values& values, NumberType type, uint64_t size, Add add) const {
  glm::uvec3 last(0);  // corners
  uint64_t length = 0;
  for (uint64_t i = 0; i < size; ++i) {
    if (i % kRowsPerLook == 0) throw_if_stopped(stop_);
    if (values.try_restart(type)) {
      length = 0;
      continue;
    }
    last = {last.y, last.z, read_corner(values, type)};
    if (++length < 3 || last.x == last.y || last.y == last.z || last.z == last.x) continue;
    // Every second triangle of a strip is turned over.
    const std::array<uint32_t, 3> t =
        length % 2 == 1 ? std::array{last.x, last.y, last.z} : std::array{last.y, last.x, last.z};
    add(std::array{FaceCorner{t[0], t[0], t[0]}, FaceCorner{t[1], t[1], t[1]}, FaceCorner{t[2], t[2], t[2]}},
        std::span<const glm::vec2>());
  }
}

template <typename Values, typename Add>
void MeshTableReader::for_each_face(const MeshTable& table, Values& values, const TableChunk& chunk,
                                    ChunkCounts& counts, Add add) const {
  std::vector<FaceCorner> corners;
  std::vector<glm::vec2> uvs;
  for (uint64_t i = 0; i < chunk.rows; ++i) {
    if (i % kRowsPerLook == 0) throw_if_stopped(stop_);
    values.next_row();
    corners.clear();
    uvs.clear();
    for (const TableColumn& column : table.columns) {
      const uint64_t size = column.count_type ? list_size(values, column) : 1;
      if (column.role == ColumnRole::corners && table.use == TableUse::strips) {
        read_strip(values, column.type, size, add);
      } else if (column.role == ColumnRole::corners) {
        if (size > limits::kPolygonPoints)
          values.fail(fmt::format("a face has at most {} corners", limits::kPolygonPoints));
        for (uint64_t k = 0; k < size; ++k) {
          const uint32_t vertex = read_corner(values, column.type);
          corners.push_back({vertex, vertex, vertex});
        }
      } else if (column.role == ColumnRole::corner_uvs) {
        if (size > 2 * limits::kPolygonPoints) values.fail("there are more coordinates than corners");
        for (uint64_t k = 0; k < size / 2; ++k) {
          const float u = finite_or_zero(values.real(column.type), counts.bad_uvs);
          uvs.emplace_back(u, finite_or_zero(values.real(column.type), counts.bad_uvs));
        }
        values.skip(column.type, size % 2);
      } else {
        values.skip(column.type, size);
      }
    }
    counts.rests[chunk.table] += values.has_more();
    if (table.use == TableUse::strips) continue;
    if (corners.size() < 3) {
      ++counts.too_small;
      continue;
    }
    counts.without_uvs += has_corner_uvs_ && uvs.size() != corners.size();
    add(corners, uvs);
  }
}

void MeshTableReader::count_faces(size_t i) {
  const TableChunk& chunk = chunks_[i];
  ChunkCounts& counts = counts_[i];
  counts.rests.resize(tables_.tables.size());
  if (tables_.tables[chunk.table].use < TableUse::faces) return;
  visit(chunk, [&](const MeshTable& table, auto values) {
    for_each_face(table, values, chunk, counts,
                  [&](std::span<const FaceCorner> corners, std::span<const glm::vec2>) {
                    const bool is_triangle = corners.size() == 3;
                    counts.faces.triangle += is_triangle;
                    counts.faces.polygon += !is_triangle;
                    counts.faces.polygon_corner += is_triangle ? 0 : corners.size();
                    if (has_corner_uvs_) counts.corner_uvs += corners.size();
                  });
  });
}

void MeshTableReader::set_faces(size_t i) {
  const TableChunk& chunk = chunks_[i];
  ChunkCounts& at = counts_[i];
  std::vector<FaceCorner> with_uvs;
  visit(chunk, [&](const MeshTable& table, auto values) {
    for_each_face(
        table, values, chunk, at, [&](std::span<const FaceCorner> corners, std::span<const glm::vec2> uvs) {
          if (has_corner_uvs_) {
            with_uvs.assign(corners.begin(), corners.end());
            const bool has_all = uvs.size() == corners.size();
            for (size_t k = 0; k < corners.size(); ++k)
              with_uvs[k].uv = static_cast<uint32_t>(has_all ? at.corner_uvs + k : mesh_.uvs.size() - 1);
            if (has_all)
              std::copy(uvs.begin(), uvs.end(), mesh_.uvs.begin() + static_cast<ptrdiff_t>(at.corner_uvs));
            at.corner_uvs += corners.size();
            corners = with_uvs;
          }
          set_face(mesh_, at.faces, corners);
        });
  });
}

void add_table_notes(Notes& notes, const MeshTables& tables, const std::string& path,
                     const ChunkCounts& counts) {
  const auto note = [&](uint64_t count, const std::string& what) {
    if (count > 0) notes.add({path}, fmt::format("{}, {} times", what, count));
  };
  note(counts.too_small, "a face of fewer than three corners is not used");
  note(counts.without_uvs, "a face whose coordinates of textures are not two for each corner has none");
  note(counts.bad_normals, "a vertex's normal that is not finite or has no direction is not used");
  note(counts.bad_uvs, "a coordinate of textures that is not finite is 0");
  note(counts.bad_colors, "a number of a vertex's colour that is not finite is 0");
  for (size_t i = 0; i < counts.rests.size(); ++i)
    note(counts.rests[i],
         fmt::format("{} of a {} is not used", tables.tables[i].rest, tables.tables[i].name));
}

}  // namespace

bool MeshTable::has(ColumnRole role) const {
  return std::any_of(columns.begin(), columns.end(), [&](const TableColumn& c) { return c.role == role; });
}

MeshShape read_mesh_tables(SceneDescription& scene, const MeshTables& tables, const MeshRequest& request,
                           std::span<const size_t> borders, const LoadOptions& options) {
  count_opened(options.progress, tables.body.size());
  MeshTableReader reader(tables, request, options.stop,
                         cut_tables(scene, tables, request.path, borders, options.stop));
  MeshShape mesh = reader.read(options.progress);
  add_table_notes(scene.notes, tables, request.path, reader.counts());
  check_faces(mesh, request.path);
  if (mesh.normals.empty()) add_asked_normals(mesh, request, options.stop);
  return mesh;
}

}  // namespace rayfarm
