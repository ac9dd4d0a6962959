#include "host/experiments/renders.h"

namespace rayfarm {

void render_or_throw(const RunRender& render, const RenderOptions& job) {
  if (const int code = render(job); code != 0) throw RenderFailed{code};
}

RayCounts read_ray_counts(const JsonView& stats) {
  const JsonView rays = stats.at("rays");
  RayCounts counts;
  for (size_t kind = 0; kind < kRayKinds; ++kind) counts.by_kind[kind] = rays.at(kRayKindNames[kind]).count();
  return counts;
}

}  // namespace rayfarm
