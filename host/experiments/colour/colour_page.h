#pragma once
// What came of the colour experiment, and its page.
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/scene/render_settings.h"

namespace rayfarm {

/// One of the scenes, and how it is rendered.
struct ColourPicture {
  const char* name;
  LightingModel lighting;
  uint32_t samples, max_depth;
  int width_px, height_px;
  const char* what;
};

struct ColourChoice {
  const char* name;  ///< as --colour has it
  ColourModel model;
  bool is_reference = false;
};

/// How different two pictures look, in CIEDE2000.
struct PictureDifference {
  double mean = 0, most_of_95 = 0, largest = 0;
  double share_over_1 = 0;  ///< of the pixels
};

struct ColourOutcome {
  const ColourChoice* choice = nullptr;
  size_t nodes = 0, passes = 0;
  double trace_s = 0, rays = 0;
  std::vector<Vec3> looks;  ///< L*a*b* of each pixel as a screen shows it
  PictureDifference from_reference;
};

/// What one ray's colours take: the light times what reflects it, added to another such product.
struct ColourCost {
  double nodes = 0;  ///< of the sum, in the mean
  double list_s = 0, rgb_s = 0;
};

struct ColourScene {
  const ColourPicture* picture = nullptr;
  std::vector<ColourOutcome> models;
  PictureDifference from_20_to_4;
  ColourCost cost;
};

/// README.md with the verdicts, colour.csv, and the plot. All scenes have the same models: RGB, 4 nodes, 20,
/// the scene's own, the reference.
void write_colour_page(const std::filesystem::path& folder, std::span<const ColourScene> scenes);

}  // namespace rayfarm
