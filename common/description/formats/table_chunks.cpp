#include "common/description/formats/table_chunks.h"

#include "common/description/formats/table_values.h"
#include "common/description/formats/text_pieces.h"

namespace rayfarm {
namespace {

/// Enough that a thread's start does not count.
constexpr uint64_t kRowsPerChunk = 1 << 16;
constexpr uint64_t kRowsPerLook = 1 << 14;

/// Lines of a text, and those of them that are rows.
struct LineCount {
  uint64_t rows = 0;
  int lines = 0;
};

/// Counts until `most` rows have ended, or the text; returns where that is.
size_t count_lines(std::string_view text, uint64_t most, const std::stop_token& stop, LineCount& count) {
  size_t at = 0;
  while (at < text.size() && count.rows < most) {
    if (count.lines % kRowsPerLook == 0) throw_if_stopped(stop);
    while (at < text.size() && is_blank(text[at])) ++at;
    if (at < text.size() && !is_line_end(text[at]) && text[at] != '#') ++count.rows;
    while (at < text.size() && !is_line_end(text[at])) ++at;
    while (at < text.size() && !ends_line(text, at)) ++at;
    count.lines += at < text.size();
    at = std::min(at + 1, text.size());
  }
  return at;
}

class TableCutter {
 public:
  TableCutter(const MeshTables& tables, const std::string& path, const std::stop_token& stop)
      : tables_(tables), path_(path), stop_(stop) {}

  void cut_text_at(std::span<const size_t> borders) {
    const std::vector<std::string_view> pieces = cut_text(tables_.body, borders, begins_line);
    std::vector<LineCount> counts(pieces.size());
    parallel_for(pieces.size(), [&](size_t i) { count_lines(pieces[i], UINT64_MAX, stop_, counts[i]); });
    int lines = tables_.lines_before;
    for (size_t i = 0; i < pieces.size(); ++i) {
      std::string_view rest = pieces[i];
      while (counts[i].rows > 0 && find_table_with_rows()) {
        LineCount taken{counts[i].rows, counts[i].lines};
        size_t bytes = rest.size();
        if (taken.rows > rows_left()) {
          taken = {};
          bytes = count_lines(rest, rows_left(), stop_, taken);
        }
        add(rest.substr(0, bytes), taken.rows, lines);
        rest.remove_prefix(bytes);
        lines += taken.lines;
        counts[i].rows -= taken.rows;
        counts[i].lines -= taken.lines;
      }
      rows_behind_ += counts[i].rows;
      lines += counts[i].lines;
    }
    if (find_table_with_rows())
      throw InputError({path_, lines},
                       fmt::format("the file ends after {} of the {} rows of `{}` that it tells "
                                   "of; it was cut off, or rows share lines",
                                   row_, table().rows, table().name));
  }

  template <std::endian endian>
  void cut_bytes() {
    while (find_table_with_rows()) {
      throw_if_stopped(stop_);
      const std::optional<size_t> row_bytes = bytes_of_row();
      if (row_bytes) {
        if (rows_left() > bytes_left() / *row_bytes)
          throw InputError(
              {path_}, fmt::format("the file tells of {} rows of `{}` with {} bytes each, but ends "
                                   "after {}; it was cut off",
                                   table().rows, table().name, *row_bytes, row_ + bytes_left() / *row_bytes));
        const uint64_t rows = std::min(rows_left(), kRowsPerChunk);
        add(tables_.body.substr(at_, rows * *row_bytes), rows, 0);
        continue;
      }
      const uint64_t rows = std::min(rows_left(), kRowsPerChunk);
      const TableChunk all{table_, row_, rows, tables_.body.substr(at_), 0, tables_.bytes_before + at_};
      BinaryValues<endian> values(table(), all, path_);
      for (uint64_t i = 0; i < rows; ++i) {
        values.next_row();
        for (const TableColumn& column : table().columns) {
          int64_t count = 1;
          if (column.count_type) count = values.whole(*column.count_type);
          if (count < 0) values.fail(fmt::format("a list can't have {} numbers", count));
          values.skip(column.type, static_cast<uint64_t>(count));
        }
      }
      add(all.bytes.substr(0, values.bytes_read()), rows, 0);
    }
    bytes_behind_ = bytes_left();
  }

  void add_notes(Notes& notes) const {
    if (rows_behind_ > 0)
      notes.add({path_}, fmt::format("{} lines behind the last row that the header tells of are not used",
                                     rows_behind_));
    if (bytes_behind_ > 0)
      notes.add({path_}, fmt::format("{} bytes behind the last row that the header tells of are not used",
                                     bytes_behind_));
  }

  std::vector<TableChunk> chunks;

 private:
  const MeshTable& table() const { return tables_.tables[table_]; }
  uint64_t rows_left() const { return table().rows - row_; }
  size_t bytes_left() const { return tables_.body.size() - at_; }

  /// Goes on to the next table of which there are rows left; rows without columns take no room.
  bool find_table_with_rows() {
    while (table_ < tables_.tables.size() && (rows_left() == 0 || table().columns.empty())) {
      ++table_;
      row_ = 0;
    }
    return table_ < tables_.tables.size();
  }

  /// If all rows of the table have the same size.
  std::optional<size_t> bytes_of_row() const {
    size_t bytes = 0;
    for (const TableColumn& column : table().columns) {
      if (column.count_type) return std::nullopt;
      bytes += bytes_of(column.type);
    }
    return bytes;
  }

  void add(std::string_view bytes, uint64_t rows, int lines_before) {
    chunks.push_back({table_, row_, rows, bytes, lines_before,
                      tables_.bytes_before + static_cast<size_t>(bytes.data() - tables_.body.data())});
    at_ += bytes.size();
    row_ += rows;
  }

  const MeshTables& tables_;
  const std::string& path_;
  const std::stop_token& stop_;
  size_t table_ = 0;
  uint64_t row_ = 0;  ///< of the table
  size_t at_ = 0;     ///< bytes that were cut
  uint64_t rows_behind_ = 0, bytes_behind_ = 0;
};

}  // namespace

std::vector<TableChunk> cut_tables(SceneDescription& scene, const MeshTables& tables, const std::string& path,
                                   std::span<const size_t> borders, const std::stop_token& stop) {
  TableCutter cutter(tables, path, stop);
  switch (tables.encoding) {
    case TableEncoding::text:
      cutter.cut_text_at(borders);
      break;
    case TableEncoding::little_endian:
      cutter.cut_bytes<std::endian::little>();
      break;
    case TableEncoding::big_endian:
      cutter.cut_bytes<std::endian::big>();
      break;
  }
  cutter.add_notes(scene.notes);
  return std::move(cutter.chunks);
}

}  // namespace rayfarm
