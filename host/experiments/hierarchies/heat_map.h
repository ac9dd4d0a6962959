#pragma once
// Tests per pixel as pictures, one panel a hierarchy (`rayfarm experiment hierarchies --picture tests`).
#include <string>
#include <vector>

#include "common/description/scene_description.h"
#include "common/image/image.h"

namespace rayfarm {

/// A hierarchy to look at.
struct HeatPanel {
  std::string name;
  BuildOptions build;
};

/// The primitives that the rays of each pixel test.
struct HeatMap {
  std::string name;
  std::vector<double> tests;  ///< height × width, from the top left
  double mean = 0, most = 0;
};

/// Of eye rays through the middle of pixels and all rays that come of them, in Whitted's model.
std::vector<HeatMap> measure_tests(const SceneDescription& scene, const std::vector<HeatPanel>& panels,
                                   int width_px, int height_px);

/// The maps side by side on one scale, by powers of ten, with their names and means and a legend.
Image draw_heat_maps(const std::vector<HeatMap>& maps, int width_px, int height_px);

/// The colour of a share of the scale, 0 to 1: from black to white, lightness rising evenly (Green, A colour
/// scheme for the display of astronomical intensity images, 2011).
std::array<std::byte, 3> heat_colour(double share);

/// Writes `folder`/tests_NAME.png and returns its path. `cells`: of regular; 0: as it is without the option.
std::string draw_tests(const std::string& scene, const std::string& folder, int width_px, uint32_t cells);

}  // namespace rayfarm
