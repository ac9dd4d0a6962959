#include "host/experiments/page.h"

#include <fmt/core.h>

#include "common/errors/input_error.h"

namespace rayfarm {

std::filesystem::path make_page_folder(const std::string& output) {
  std::error_code error;
  std::filesystem::create_directories(output, error);
  if (error) throw IoError(fmt::format("{}: can't be made: {}", output, error.message()));
  return output;
}

std::string markdown(const Table& table) {
  std::string out = "|", line = "|";
  for (size_t i = 0; i < table.columns.size(); ++i) {
    out += " " + table.columns[i] + " |";
    line += !table.rows.empty() && std::holds_alternative<double>(table.rows[0][i]) ? "---:|" : "---|";
  }
  out += "\n" + line + "\n";
  for (const auto& row : table.rows) {
    out += "|";
    for (const TableCell& cell : row)
      out += " " +
             (std::holds_alternative<double>(cell) ? fmt::format("{:.4g}", std::get<double>(cell))
                                                   : std::get<std::string>(cell)) +
             " |";
    out += "\n";
  }
  return out;
}

}  // namespace rayfarm
