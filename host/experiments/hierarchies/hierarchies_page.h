#pragma once
// The page of the hierarchies.
#include <optional>
#include <string>
#include <vector>

#include "host/experiments/hierarchies/construction.h"
#include "host/experiments/hierarchies/hierarchy_runs.h"
#include "host/experiments/hierarchies/profile.h"
#include "host/experiments/hierarchies/thesis_tables.h"
#include "host/instrument/table.h"

namespace rayfarm {

/// A hierarchy with its setting on a scene.
struct HierarchyRow {
  int image = 0;          ///< of the thesis, from 1; 0: another scene
  std::string scene;      ///< "Image 1", or its name
  std::string hierarchy;  ///< as on the command line
  std::string setting;    ///< its cut, cells, order
  uint32_t cut = 0;       ///< of regular: the thesis's for as many cells; 0: it has none
  HierarchyRun run;
};

/// How a tree of cells of one depth does.
struct DepthStep {
  uint32_t depth;
  HierarchyRun run;
};

/// A hierarchy at one number of primitives, of a scene or of a leaf.
struct GrowthPoint {
  std::string scene;
  std::string hierarchy;
  double number = 0;  ///< the cut, or primitives in the scene
  double tests_per_ray = 0, volumes_per_ray = 0;
  double ns_per_ray = 0;
  double build_cpu_s = 0;
};

/// A column of another program (tests/bench/same_rays), by scenes.
struct PeerTime {
  std::string scene;
  double rayfarm_ns = 0, peer_ns = 0;
};

/// What is measured of an image of the thesis besides.
struct ImageStudy {
  SceneFacts facts;
  RayCounts kinds;
  size_t rays = 0;
  std::vector<DepthStep> depths;  ///< of adaptive at 25, from flat to deep
  std::vector<GrowthPoint> cuts;
  UpdateTime update;
  RenderProfile profile;
};

struct HierarchyStudy {
  int side_px = 256;  ///< the thesis's
  std::vector<HierarchyRow> rows;
  std::vector<ImageStudy> images;
  std::vector<GrowthPoint> growth;
  std::vector<std::string> missing;  ///< files of today's scenes that were not there
  std::vector<PeerTime> peer;        ///< Embree's; empty: not measured

  /// Throws std::logic_error if there is none.
  const HierarchyRun& run(int image, const std::string& hierarchy, uint32_t cut) const;
  const HierarchyRun& run(int image, Scheme scheme, int cut) const {
    return run(image, kSchemeNames[static_cast<size_t>(scheme)], static_cast<uint32_t>(cut));
  }
};

Table hierarchies_table(const std::vector<HierarchyRow>& rows);
std::string hierarchies_page(const HierarchyStudy& study);
/// Its sections of Table 4.6 with Equations 4.1 to 4.3, and of Tables 4.8 to 4.12 with Figure 4.6.
std::string construction_text(const HierarchyStudy& study);
std::string profile_text(const HierarchyStudy& study);
/// Scenes of today, growth, and which hierarchy one would choose now.
std::string today_text(const HierarchyStudy& study);

}  // namespace rayfarm
