#include "host/instrument/table.h"

#include <fmt/format.h>

#include <cmath>

#include "host/files/json.h"

namespace rayfarm {
namespace {

std::string text_of(const TableCell& cell) {
  if (const auto* word = std::get_if<std::string>(&cell)) return *word;
  const double value = std::get<double>(cell);
  if (std::isinf(value)) return "never";
  if (std::abs(value) >= 1000 || (value == std::round(value) && std::abs(value) < 1000))
    return fmt::format("{:.0f}", value);
  return fmt::format("{:.4g}", value);
}

/// A CSV field: words with commas stand in quotes (RFC 4180).
std::string field(const TableCell& cell) {
  if (const auto* word = std::get_if<std::string>(&cell)) {
    if (word->find_first_of(",\"\n") == std::string::npos) return *word;
    std::string quoted = "\"";
    for (const char c : *word) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
  }
  return fmt::format("{}", std::get<double>(cell));
}

/// Columns of people's text: bytes that continue a character take no room.
size_t width_of(const std::string& text) {
  size_t n = 0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xc0) != 0x80 ? 1 : 0;
  return n;
}

void add_text(const Table& table, std::string& out) {
  std::vector<size_t> widths;
  for (const std::string& column : table.columns) widths.push_back(width_of(column));
  for (const auto& row : table.rows)
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(text_of(row[i])));
  const auto add_cell = [&](size_t i, const std::string& text) {
    out += std::string(widths[i] - width_of(text) + (i > 0 ? 2 : 0), ' ') + text;
  };
  out += table.name + "\n";
  for (size_t i = 0; i < table.columns.size(); ++i) add_cell(i, table.columns[i]);
  out += "\n";
  for (const auto& row : table.rows) {
    for (size_t i = 0; i < row.size(); ++i) add_cell(i, text_of(row[i]));
    out += "\n";
  }
}

}  // namespace

std::string format_tables(const std::vector<Table>& tables, TableFormat format) {
  std::string out;
  if (format == TableFormat::json) {
    Json j;
    for (const Table& table : tables)
      for (const auto& row : table.rows) {
        Json line;
        for (size_t i = 0; i < row.size(); ++i)
          std::visit([&](const auto& value) { line[table.columns[i]] = value; }, row[i]);
        j[table.name].push_back(line);
      }
    return j.dump(1) + "\n";
  }
  for (const Table& table : tables) {
    if (!out.empty()) out += "\n";
    if (format == TableFormat::text) {
      add_text(table, out);
      continue;
    }
    out += "# " + table.name + "\n";
    for (size_t i = 0; i < table.columns.size(); ++i) out += (i > 0 ? "," : "") + table.columns[i];
    out += "\n";
    for (const auto& row : table.rows) {
      for (size_t i = 0; i < row.size(); ++i) out += (i > 0 ? "," : "") + field(row[i]);
      out += "\n";
    }
  }
  return out;
}

}  // namespace rayfarm
