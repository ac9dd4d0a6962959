#pragma once
// A table of numbers as text, CSV or JSON.
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rayfarm {

enum class TableFormat { text, csv, json };

using TableCell = std::variant<double, std::string>;

struct Table {
  std::string name;
  std::vector<std::string> columns;
  std::vector<std::vector<TableCell>> rows;
};

/// Text: every number with four significant digits, or whole. CSV and JSON: all digits that tell it apart.
std::string format_tables(const std::vector<Table>& tables, TableFormat format);

}  // namespace rayfarm
