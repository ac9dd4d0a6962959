#include "host/render/zone_solvers.h"

namespace rayfarm {

MakeZoneSolver zone_solvers_of(const RenderSettings&) {
  return {};
}

}  // namespace rayfarm
