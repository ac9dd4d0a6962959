#pragma once
// Form factors: "For each projected object a form factor is calculated" (the thesis's 2.2.5). A zone's row
// tells which part of the light that may come to it from all round is each other zone's: the same part of the
// light that it sends goes there.
#include <functional>

#include "common/lighting/ray_counts.h"
#include "common/lighting/zones/hemicube.h"
#include "common/lighting/zones/power.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/sampling/sampler.h"

namespace rayfarm {

/// What one side of a zone sees. F to a zone is its weight over the total.
struct FormFactorRow {
  uint64_t total = 0;    ///< rays, or a hemicube's sum; 0: light that comes here is of no use
  uint64_t escaped = 0;  ///< of that, what sees nothing
  struct Seen {
    uint64_t slot = 0, weight = 0;
  };
  std::vector<Seen> seen;  ///< slots rise
};

void write(PackedWriter& out, const FormFactorRow& row);
/// Throws std::runtime_error.
FormFactorRow read_form_factors(PackedReader& in, uint64_t slots);

/// Rays of a row: as settings ask for.
uint64_t form_factor_rays(const ZoneSettings& settings, uint64_t slots);

class FormFactorTracer {
 public:
  /// `zones` and `sampler` must outlive it. The zones have diffuse sums alone.
  FormFactorTracer(const ZoneScene& zones, const Sampler& sampler, const RenderSettings& settings);

  FormFactorRow trace(uint64_t slot, const std::function<void()>& pulse, RayCounts& counts) const;

 private:
  struct Sighted;
  void trace_rays(const SlotPlace& place, uint64_t slot, const std::function<void()>& pulse,
                  Sighted& sighted) const;
  void trace_hemicube(const SlotPlace& place, uint64_t slot, const std::function<void()>& pulse,
                      Sighted& sighted) const;
  void see(Sighted& sighted) const;

  const ZoneScene& zones_;
  const Sampler& sampler_;
  RenderSettings settings_;
  uint64_t rays_;
};

}  // namespace rayfarm
