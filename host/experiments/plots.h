#pragma once
// Plots of the experiments' pages.
#include <filesystem>
#include <string>

namespace rayfarm {

/// Writes the script and runs gnuplot on it, in the folder; says so if gnuplot is not there or can't.
void draw_plots(const std::filesystem::path& folder, const std::string& file, const std::string& script);

}  // namespace rayfarm
