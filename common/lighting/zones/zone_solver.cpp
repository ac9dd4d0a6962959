#include "common/lighting/zones/zone_solver.h"

namespace rayfarm {

std::unique_ptr<ZoneSolver> make_zone_solver(const Scene& scene, const RenderSettings& settings, int frame) {
  return settings.lighting == LightingModel::radiosity ? make_matrix_solver(scene, settings, frame)
                                                       : make_zonal_solver(scene, settings, frame);
}

std::unique_ptr<ZoneTracer> make_zone_tracer(const Scene& scene, const RenderSettings& settings, int frame) {
  return settings.lighting == LightingModel::radiosity ? make_matrix_tracer(scene, settings, frame)
                                                       : make_zonal_tracer(scene, settings, frame);
}

}  // namespace rayfarm
