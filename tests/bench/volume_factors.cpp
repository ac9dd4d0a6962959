// What a test of each kind of bounding volume costs: the factors by which `--bounds best` chooses (Weghorst,
// Hooper and Greenberg 1984, section 2: "a factor that is indicative of the relative complexity of its
// intersection test"). Each kind is fitted to the same 256 sets of points, and met by the same rays, of which
// about half hit the sphere.
//
//   volume_factors
#include <fmt/format.h>

#include <chrono>
#include <random>

#include "common/hierarchy/bounding_volumes.h"

namespace {

using namespace rayfarm;

struct TestRay {
  Vec3 origin, direction;
};

Vec3 point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = unit(random), y = unit(random);
  return {x, y, unit(random)};
}

/// Nanoseconds of a test, the least of several rounds.
double measure(const std::vector<BoundingVolume>& volumes, const std::vector<TestRay>& rays,
               double& hit_share) {
  constexpr int kRounds = 15;
  double least = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    size_t hits = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (const TestRay& ray : rays)
      for (const BoundingVolume& volume : volumes)
        hits += entry_into(volume, ray.origin, ray.direction).has_value() ? 1 : 0;
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    const auto tests = static_cast<double>(rays.size() * volumes.size());
    least = std::min(least, took.count() / tests);
    hit_share = static_cast<double>(hits) / tests;
  }
  return least;
}

}  // namespace

int main() {
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
  constexpr std::array names{"sphere", "box", "cylinder", "slabs"};
  for (size_t kind = 0; kind < kVolumeKinds; ++kind) {
    std::vector<BoundingVolume> volumes;
    for (const auto& points : sets) volumes.push_back(fit_volume(static_cast<VolumeKind>(kind), points));
    double hit_share = 0;
    const double ns = measure(volumes, rays, hit_share);
    fmt::print("{:<9} {:5.1f} ns, {:2.0f} % of tests hit; the factor in use is {}\n", names[kind], ns,
               100 * hit_share, kVolumeFactors[kind]);
  }
}
