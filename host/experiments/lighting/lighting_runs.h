#pragma once
// Renders of the lighting experiment, and how their pictures differ.
#include <filesystem>

#include "common/lighting/ray_counts.h"
#include "host/experiments/experiment_options.h"
#include "host/experiments/renders.h"
#include "host/render/render_options.h"

namespace rayfarm {

/// What a render took.
struct Outcome {
  RayCounts rays;
  double trace_s = 0;
};

/// Where the lighting trees of the thesis's model are trimmed, for each diffuse ray of a surface: so that
/// what a diffuse ray meets sends out no further diffuse rays, as the times and ray counts that the thesis
/// gives imply.
inline constexpr double kTrimmedWeight = 0.41;

/// Rays through the corners of side × side subpixels (thesis 3.4.1).
void sample_corners(RenderSettings& settings, uint32_t side);
/// The thesis's model, with so many diffuse rays a surface.
void gather_diffuse_light(RenderSettings& settings, uint32_t rays);
/// As the thesis lays its directions out (3.3): bands of equal cones, one set for the whole picture.
void lay_out_as_in_thesis(RenderSettings& settings);

class LightingRuns {
 public:
  /// Makes the folder, and one in it for what is removed at the end. Throws IoError.
  LightingRuns(const ExperimentOptions& options, const RunRender& render);
  ~LightingRuns();
  LightingRuns(const LightingRuns&) = delete;

  /// A render of a scene at the size asked for, of this width and shape if none is.
  RenderOptions job(const std::string& scene, int width_px, int height_px) const;
  /// The folder of the page.
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  /// What is removed at the end.
  std::filesystem::path scratch(const std::string& name) const { return scratch_ / name; }
  std::string scene(const std::string& name) const;

  /// Renders to `output`. Throws RenderFailed.
  Outcome run(RenderOptions job, const std::filesystem::path& output) const;

 private:
  int width_px_;
  std::string scenes_;
  const RunRender& render_;
  std::filesystem::path folder_, scratch_;
};

/// A picture's channels, row-major, in the encoding of its file. Throws IoError.
std::vector<float> read_channels(const std::filesystem::path& file);

/// The level of 0 to 255 at which a screen shows linear light.
double display_level(float linear);
/// Their mean.
double mean_level(const std::vector<float>& channels);

struct ScreenDifference {
  double rms = 0;      ///< linear
  double visible = 0;  ///< share of pixels that a screen shows by more than two levels of 255 apart
};
ScreenDifference screen_difference(const std::vector<float>& a, const std::vector<float>& b);

}  // namespace rayfarm
