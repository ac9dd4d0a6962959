#pragma once
// What the thesis's chapter 3 says of sampling errors, of the ball of light, of bands and of times, measured.
// Each study is a section of the page, in Markdown.
#include "host/experiments/lighting/lighting_runs.h"

namespace rayfarm {

/// Errors over rays (3.5.1): a table, and the curve's points for the plot, a series after the other.
struct ErrorStudy {
  std::string section, csv, curves;
};
ErrorStudy study_errors(const LightingRuns& runs);

/// The ball of light without the cosine term (3.5.1).
std::string study_ball(const LightingRuns& runs);

/// Bands that share light or the volume of cones (3.3).
std::string study_bands(const LightingRuns& runs);

/// Why Plate 3.1b takes the time that it takes.
std::string study_times(const LightingRuns& runs);

}  // namespace rayfarm
