#pragma once
// What the pages of experiments are made of.
#include <filesystem>
#include <string>

#include "host/instrument/table.h"

namespace rayfarm {

/// The experiment's folder, made if it is not there. Throws IoError.
std::filesystem::path make_page_folder(const std::string& output);

/// The table in Markdown; numbers have four significant digits.
std::string markdown(const Table& table);

}  // namespace rayfarm
