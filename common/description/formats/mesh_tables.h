#pragma once
// Meshes that a file holds as tables, as PLY and OFF do: a row a vertex, a row a face, in text or in bytes.
// Rows are read by all cores, and the mesh is the same however they share them.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/description/formats/mesh_loaders.h"

namespace rayfarm {

enum class NumberType : uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// What becomes of a column's numbers.
enum class ColumnRole : uint8_t {
  unused,
  x,
  y,
  z,
  normal_x,
  normal_y,
  normal_z,
  u,
  v,
  red,
  green,
  blue,
  alpha,
  corners,    ///< a list of rows of the vertices; in strips -1 begins another
  corner_uvs  ///< a list of u and v for each corner
};
inline constexpr size_t kVertexRoles = static_cast<size_t>(ColumnRole::corners);  ///< of one number each

struct TableColumn {
  NumberType type = NumberType::float32;
  std::optional<NumberType> count_type;  ///< of a list, before whose numbers stands how many it has
  ColumnRole role = ColumnRole::unused;
};

enum class TableUse : uint8_t { unused, vertices, faces, strips };

struct MeshTable {
  std::string name;  ///< of a row: "vertex"
  TableUse use = TableUse::unused;
  uint64_t rows = 0;
  std::vector<TableColumn> columns;
  /// What may stand behind the columns in a row of text, for a note that it is not used.
  std::string rest = "what stands behind the numbers that the header tells of";

  bool has(ColumnRole role) const;
};

enum class TableEncoding : uint8_t { text, little_endian, big_endian };

/// One table of vertices; others in any order. In text each row stands on a line of its own, empty lines are
/// left out, and # begins a comment.
struct MeshTables {
  TableEncoding encoding = TableEncoding::text;
  std::vector<MeshTable> tables;
  std::string_view body;
  int lines_before = 0;     ///< the body, in the file
  size_t bytes_before = 0;  ///< the same
};

/// Reads the body of the file that is asked for; what is not used is noted in the scene. Text is cut at the
/// first rows behind `borders`, which rise. Where no smoothing is asked for, the mesh is smooth if its
/// vertices have normals. Colours are sRGB, as programs write them. Memory is bounded by the size of
/// the body, whatever the tables claim. Throws InputError and Stopped.
MeshShape read_mesh_tables(SceneDescription& scene, const MeshTables& tables, const MeshRequest& request,
                           std::span<const size_t> borders, const LoadOptions& options);

}  // namespace rayfarm
