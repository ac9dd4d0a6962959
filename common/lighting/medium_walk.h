#pragma once
// Random walks through media, whose means are what light does there: where a ray is scattered, and how much
// of a shadow ray's light gets through.
#include "common/lighting/participating_media.h"
#include "common/sampling/sampler.h"

namespace rayfarm {

/// Numbers of one ray, as many as its walk asks for: the sampler's own pair first, which is spread evenly
/// over the samples of a pixel, then those of a stream that (seed, frame, pixel, sample, dimension) begins.
class MediumNumbers {
 public:
  MediumNumbers(const Sampler& sampler, const SampleId& id, uint32_t dimension)
      : sampler_(sampler), id_(id), dimension_(dimension) {}
  double next();  ///< in [0, 1)

 private:
  const Sampler& sampler_;
  SampleId id_;
  uint32_t dimension_;
  uint64_t count_ = 0, key_ = 0;
  Vec2 pair_{0};
};

/// Where a ray is scattered.
struct MediumEvent {
  uint32_t medium = kNone;  ///< none: it gets through
  double t = 0;             ///< in lengths of the ray's direction
  bool is_scattered() const { return medium != kNone; }
};

/// Follows a ray from 0 to its t_max. `throughput`, its path's, is multiplied by what the medium does over
/// the probability of the event. Absorption only weakens, and in media that do not scatter light is weakened
/// as transmittance() says. Distances in a homogeneous medium are those of one channel, chosen by its
/// throughput, weighed by the mean density of all (Veach's balance heuristic). With a grid there are
/// collisions with the majorant of each block (Woodcock's delta tracking), scattering with a probability that
/// throughput weighs between channels (Kutz, Habel, Li and Novák 2017, "Spectral and decomposition
/// tracking"): so the sum of channels never grows.
MediumEvent walk_through_media(const Scene& scene, const Ray& ray, Color& throughput, MediumNumbers& numbers);

/// An estimate of transmittance(): exact where there is no grid or no scattering, elsewhere by ratio tracking
/// (Novák, Selle and Jarosz 2014), which stops by chance once little is left.
Color estimate_transmittance(const Scene& scene, const Ray& ray, MediumNumbers& numbers);

}  // namespace rayfarm
