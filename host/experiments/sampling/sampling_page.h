#pragma once
// The page of the sampling experiment.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rayfarm {

/// RMS errors of one pattern's pictures with so many samples per pixel, one for each seed.
using ErrorsOfSeeds = std::vector<double>;

struct SampledScene {
  std::string name, what;
  double reference_error = 0;                      ///< of what the others are compared with, estimated
  std::vector<std::vector<ErrorsOfSeeds>> errors;  ///< by pattern and number of samples
};

struct SamplingPage {
  std::vector<std::string> patterns;  ///< kContemporaries of them were there in 1991
  std::vector<uint32_t> samples;      ///< per pixel, ascending
  uint32_t reference_samples = 0;
  std::vector<SampledScene> scenes;

  static constexpr size_t kContemporaries = 5;
};

/// Numbers, plots and README.md.
void write_sampling_page(const SamplingPage& page, const std::filesystem::path& folder);

}  // namespace rayfarm
