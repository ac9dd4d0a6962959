#include "host/render/zone_solvers.h"

namespace rayfarm {

MakeZoneSolver zone_solvers_of(const RenderSettings& settings) {
  if (!has_zones(settings.lighting)) return {};
  return make_zone_solver;
}

}  // namespace rayfarm
