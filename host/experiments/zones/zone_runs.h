#pragma once
// Zones that are solved and shown in this process, as the experiment does it again and again.
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host/experiments/experiment_options.h"
#include "host/experiments/pictures.h"
#include "host/instrument/table.h"

namespace rayfarm {

/// What is done, and how much: all that the page shows, or less in a smaller picture.
class ZoneWork {
 public:
  /// Makes the folder, and one in it for what is removed at the end. Throws IoError.
  explicit ZoneWork(const ExperimentOptions& options);
  ~ZoneWork();
  ZoneWork(const ZoneWork&) = delete;

  int width_px() const { return width_px_; }
  uint32_t rays(double count) const { return static_cast<uint32_t>(std::max(1000.0, count * share_)); }
  uint32_t samples(double count) const {
    return static_cast<uint32_t>(std::max(4.0, count * std::min(1.0, std::sqrt(share_))));
  }
  /// Zones are larger in the same measure.
  double size(double length) const { return length / std::sqrt(share_); }

  /// Of the scenes' folder.
  PicturedScene scene(const std::string& name) const;
  PicturedScene scene_of(const std::string& text) const;
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  std::filesystem::path scratch(const std::string& name) const { return scratch_ / name; }
  std::string path_of(const std::string& scene) const;

 private:
  static constexpr int kWidth_px = 128;

  int width_px_;
  double share_;  ///< of the pixels that the page has
  std::string scenes_;
  std::filesystem::path folder_, scratch_;
};

/// What stands in the spec of what was found: a line of the page's first table.
struct ZoneCheck {
  std::string what, asked, reached;
  bool holds = false;
};

/// A part of the page, and what it is made of.
struct ZoneStudy {
  std::string section;
  std::vector<ZoneCheck> checks;
  std::vector<Table> tables;
  std::map<std::string, std::string> data;  ///< files of gnuplot's
};

struct UnsentPower {
  double rounds = 0, rays = 0;
  double unsent = 0;  ///< of all primary power
};

struct SolvedZoneLight {
  std::vector<std::byte> bytes;  ///< as pictures take it
  RayCounts rays;
  double cpu_s = 0, seconds = 0;
  std::vector<UnsentPower> course;  ///< before each round, and at the end
};

/// Processor time of this process, all threads together, in seconds.
double cpu_time();

/// On all cores.
SolvedZoneLight solve_zone_light(const Scene& scene, const RenderSettings& settings);

/// Of `path` and of zones, the depth as long as `path` has it.
RenderSettings zone_experiment_settings(LightingModel model, uint32_t samples);

/// By pixel: whether it counts among blocks. Empty: all do.
using CountedPixels = std::vector<bool>;

/// A picture by `path` that others are compared with: the mean of two with seeds of their own, which tell its
/// own noise.
struct PathReference {
  FloatPicture picture;
  CountedPixels counted;
  double mean = 0;                          ///< of all channels
  double block_noise = 0, pixel_noise = 0;  ///< RMS over the mean
};
PathReference make_path_reference(const PicturedScene& scene, uint32_t samples, int frame = 0,
                                  const CountedPixels& counted = {});

/// RMS over the mean: of blocks of 16 × 16 pixels, and of pixels.
struct PictureError {
  double blocks = 0, pixels = 0;
};
PictureError picture_error(const PicturedScene& scene, const FloatPicture& picture,
                           const PathReference& reference);

/// Tells on stderr what is being done.
void tell_zones(const std::string& what);

std::string percent(double part);

/// What a sum of a zone's power weighs: three integers.
inline constexpr double kZoneSumBytes = 24;

}  // namespace rayfarm
