#include "host/experiments/bounding-volumes/volume_factors.h"

#include <random>

#include "protocol/clock.h"

namespace rayfarm {
namespace {

struct TestRay {
  Vec3 origin, direction;
};

Vec3 point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = unit(random), y = unit(random);
  return {x, y, unit(random)};
}

VolumeFactor measure(const std::vector<BoundingVolume>& volumes, const std::vector<TestRay>& rays,
                     int rounds) {
  VolumeFactor factor{1e9, 0};
  for (int round = 0; round < rounds; ++round) {
    size_t hits = 0;
    const double begin_s = now_s();
    for (const TestRay& ray : rays)
      for (const BoundingVolume& volume : volumes)
        hits += entry_into(volume, ray.origin, ray.direction).has_value() ? 1 : 0;
    const double took_s = now_s() - begin_s;
    const auto tests = static_cast<double>(rays.size() * volumes.size());
    factor.ns = std::min(factor.ns, 1e9 * took_s / tests);
    factor.hit_share = static_cast<double>(hits) / tests;
  }
  return factor;
}

}  // namespace

std::array<VolumeFactor, kVolumeKinds> measure_volume_factors(int rounds) {
  std::mt19937_64 random(1);
  std::vector<std::vector<FitPoint>> sets(256);
  for (auto& points : sets) {
    const Vec3 size = Vec3(1.2) + point(random);
    for (int i = 0; i < 40; ++i) points.push_back({size * normalized(point(random)), 0});
  }
  std::vector<TestRay> rays(2000);
  for (TestRay& ray : rays) {
    ray.origin = 6.0 * normalized(point(random));
    ray.direction = normalized(2.0 * point(random) - ray.origin);
  }
  std::array<VolumeFactor, kVolumeKinds> factors;
  for (size_t kind = 0; kind < kVolumeKinds; ++kind) {
    std::vector<BoundingVolume> volumes;
    for (const auto& points : sets) volumes.push_back(fit_volume(static_cast<VolumeKind>(kind), points));
    factors[kind] = measure(volumes, rays, rounds);
  }
  return factors;
}

}  // namespace rayfarm
