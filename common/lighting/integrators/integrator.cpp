#include "common/lighting/integrators/integrator.h"

namespace rayfarm {

std::unique_ptr<Integrator> make_integrator(LightingModel model) {
  switch (model) {
    case LightingModel::phong:
      return make_phong();
    case LightingModel::torrance_sparrow:
      return make_torrance_sparrow();
    case LightingModel::whitted:
      return make_whitted();
    case LightingModel::thesis:
      return make_thesis();
    case LightingModel::path:
    case LightingModel::radiosity:  // paths that end at zones
    case LightingModel::zonal:
      return make_path();
  }
  return nullptr;
}

}  // namespace rayfarm
