// The four tests of points in polygons that the thesis compares (2.3.3): nanoseconds and operations, for
// polygons of 3 to 40 corners. Half of the points lie inside.
#include <benchmark/benchmark.h>

#include <numbers>
#include <random>

#include "tests/polygon_tests.h"

namespace {

using namespace rayfarm;

constexpr size_t kPoints = 1024;

/// A regular polygon, tilted; a quadrilateral with no two sides parallel.
std::vector<Vec3> make_polygon(size_t n) {
  const Vec3 u(2, 0.3, 0.5), v(-0.4, 1.7, 0.6);
  std::vector<Vec3> points;
  for (size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (static_cast<double>(i) + (n == 4 && i == 2 ? 0.2 : 0)) /
                         static_cast<double>(n);
    points.push_back(std::cos(angle) * u + std::sin(angle) * v);
  }
  return points;
}

std::vector<Vec3> make_targets(std::span<const Vec3> polygon) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1, 1);
  const test::Translation<double> judge(polygon);
  const Vec3 u(2, 0.3, 0.5), v(-0.4, 1.7, 0.6);
  std::vector<Vec3> targets;
  for (size_t inside = 0, outside = 0; targets.size() < kPoints;) {
    const Vec3 p = place(random) * u + place(random) * v;
    size_t& kind = judge.is_inside(p) ? inside : outside;
    if (kind == kPoints / 2) continue;
    ++kind;
    targets.push_back(p);
  }
  return targets;
}

template <template <typename> typename Test>
void measure(benchmark::State& state) {
  const std::vector<Vec3> polygon = make_polygon(static_cast<size_t>(state.range(0)));
  const std::vector<Vec3> targets = make_targets(polygon);
  const Test<double> test(polygon);
  for (auto _ : state)
    for (const Vec3& p : targets) benchmark::DoNotOptimize(test.is_inside(p));
  const Test<test::Counted> counting(polygon);
  test::Counted::operations = {};
  for (const Vec3& p : targets) benchmark::DoNotOptimize(counting.is_inside(p));
  const auto& o = test::Counted::operations;
  const auto each = [](long count) { return static_cast<double>(count) / kPoints; };
  state.counters["ns"] = benchmark::Counter(static_cast<double>(state.iterations()) * kPoints * 1e-9,
                                            benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["sums"] = each(o.sums);
  state.counters["products"] = each(o.products);
  state.counters["quotients"] = each(o.quotients);
  state.counters["roots"] = each(o.roots);
  state.counters["compares"] = each(o.comparisons);
}

void corners(benchmark::internal::Benchmark* benchmark) {
  for (const int n : {3, 4, 5, 6, 8, 12, 20, 40}) benchmark->Arg(n);
}
BENCHMARK_TEMPLATE(measure, test::EdgeCounting)->Apply(corners);
BENCHMARK_TEMPLATE(measure, test::EdgePlanes)->Apply(corners);
BENCHMARK_TEMPLATE(measure, test::Translation)->Apply(corners);
BENCHMARK_TEMPLATE(measure, test::Parametric)->Arg(4);

}  // namespace

BENCHMARK_MAIN();
