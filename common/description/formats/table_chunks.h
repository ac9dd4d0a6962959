#pragma once
// Tables of a mesh's file, cut into chunks of rows that cores read by themselves.
#include "common/description/formats/mesh_tables.h"

namespace rayfarm {

/// Rows of one table, and all the bytes that they take.
struct TableChunk {
  size_t table = 0;
  uint64_t first_row = 0, rows = 0;
  std::string_view bytes;
  int lines_before = 0;     ///< in the file, of text
  size_t bytes_before = 0;  ///< in the file
};

/// The chunks in the order of the file, of tables that have columns. Notes what stands behind the last table.
/// Throws InputError if the body ends before the tables do, and Stopped.
std::vector<TableChunk> cut_tables(SceneDescription& scene, const MeshTables& tables, const std::string& path,
                                   std::span<const size_t> borders, const std::stop_token& stop);

}  // namespace rayfarm
