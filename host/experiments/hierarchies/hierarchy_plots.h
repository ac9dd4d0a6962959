#pragma once
// The plots of the hierarchies' page.
#include <filesystem>

#include "host/experiments/hierarchies/hierarchies_page.h"

namespace rayfarm {

/// Writes data, gnuplot's script and, where gnuplot is there, tests.svg, times.svg, cuts.svg and growth.svg.
void write_plots(const std::filesystem::path& folder, const HierarchyStudy& study);

}  // namespace rayfarm
