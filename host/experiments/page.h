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

/// Writes NAME.gp and lets gnuplot draw what it says, in the folder; tells on stderr where it can't.
void draw_plots(const std::filesystem::path& folder, const std::string& name, const std::string& script);

}  // namespace rayfarm
