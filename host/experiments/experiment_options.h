#pragma once
// What every experiment is asked for.
#include <cstdint>
#include <optional>
#include <string>

#include "host/render/run_render.h"

namespace rayfarm {

struct ExperimentOptions {
  std::string output;                              ///< folder of page, pictures and numbers
  std::string scenes = "scenes";                   ///< the folder that holds them
  std::optional<uint32_t> samples, seeds;          ///< of the sampling experiment; empty: 256 and 5
  int width_px = 0;                                ///< of the pictures; 0: as the scenes have it
  bool is_picture_of_tests = false;                ///< of the hierarchies experiment: pictures and no page
  std::string scene;                               ///< of those pictures; empty: the thesis's images
  std::string cluster = "deploy/virtual-cluster";  ///< the program that makes one
};

}  // namespace rayfarm
