#include "host/experiments/zones/zones_experiment.h"

#include <fmt/core.h>

#include "host/experiments/renders.h"
#include "host/experiments/zones/zone_costs.h"
#include "host/experiments/zones/zone_errors.h"
#include "host/experiments/zones/zone_farms.h"
#include "host/experiments/zones/zone_rounds.h"
#include "host/experiments/zones/zone_scenes.h"
#include "host/experiments/zones/zones_page.h"
#include "host/process/exit_code.h"

namespace rayfarm {

int run_zones_experiment(const ExperimentOptions& options, const RunRender& render) {
  const ZoneWork work(options);
  try {
    write_zones_page(work, {study_zone_errors(work), study_zone_costs(work, render), study_rounds(work),
                            study_zone_farms(work, render), study_matrix(work), study_zone_figures(work),
                            study_known_light(work)});
  } catch (const RenderFailed& failed) {
    return failed.code;
  }
  fmt::print("{}\n", work.file("README.md").string());
  return kComplete;
}

}  // namespace rayfarm
