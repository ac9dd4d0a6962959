#pragma once
// Where a picture's time and memory go, by the headings of the thesis's profile (4.4.2, Tables 4.8 to 4.11).
#include <filesystem>
#include <string>

#include "common/description/scene_description.h"
#include "host/experiments/hierarchies/hierarchy_runs.h"

namespace rayfarm {

/// Of one picture on one core, object/volume at 15.
struct RenderProfile {
  // Calls.
  uint64_t polygon_leaves = 0, curved_leaves = 0;  ///< ptrace, qtrace
  uint64_t polygons = 0, curved = 0;               ///< tested in them
  uint64_t nodes = 0, boxes = 0;                   ///< vtrace
  uint64_t eye_rays = 0, secondary_rays = 0, shadow_rays = 0;
  uint64_t object_nodes = 0, pixels = 0;
  // Seconds, the least of some runs.
  double load_s = 0;     ///< reading the scene's file
  double compile_s = 0;  ///< with the hierarchy
  double place_s = 0;    ///< of the objects in the frame: matrices
  double frame_s = 0;    ///< from the first eye ray to the last pixel
  double search_s = 0;   ///< the same rays through the hierarchy alone, in packets
  double write_s = 0;    ///< of the picture's file
  // Bytes.
  double formula_bytes = 0;    ///< of the primitives by Table 4.4, without sharing of corners and edges
  double hierarchy_bytes = 0;  ///< of object/volume by Table 4.5
  double block_bytes = 0;      ///< of all of the scene here
  double code_bytes = 0;       ///< of the program's file
  double raster_bytes = 0;     ///< 3 a pixel
};

/// `scratch`: a folder for a picture that is taken away again.
RenderProfile measure_profile(const std::string& scene, const PictureRays& rays, int side_px,
                              const HierarchyRun& run, const std::filesystem::path& scratch);

}  // namespace rayfarm
