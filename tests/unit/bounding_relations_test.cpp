// The tables of Weghorst, Hooper and Greenberg 1984 as they are set beside ours, and what is asked of both.
#include "host/experiments/bounding-volumes/bounding_relations.h"

#include <gtest/gtest.h>

#include "host/experiments/bounding-volumes/weghorst_tables.h"

namespace rayfarm {
namespace {

using weghorst::Environment;
using weghorst::kEnvironments;

// Tables II to VIII: phases are "shown as a percentage of total time". Three columns were misprinted by up to
// 0.3.
TEST(WeghorstTables, PhasesAddUpToTheWhole) {
  for (const Environment& e : kEnvironments)
    for (size_t c = 0; c < weghorst::kCombinationCount; ++c) {
      if (e.total[c] == 0) continue;
      EXPECT_NEAR(e.tree[c] + e.shadow[c] + e.buffer[c] + e.colour[c] + e.miscellaneous[c], 100, 0.31)
          << e.title << ' ' << weghorst::kCombinations[c];
      EXPECT_EQ(e.buffer[c] > 0, weghorst::has_buffer(c));
    }
}

// Equation 1: T = b·B + i·I.
TEST(WeghorstTables, CostIsThatOfVolumesAndOfItems) {
  WalkCounts counts;
  counts.bounds = {3, 2, 1, 0};
  counts.quadrics = 4;
  counts.polygons = 1;
  EXPECT_DOUBLE_EQ(cost_ns(counts, 5),
                   3 * kVolumeFactors[0] + 2 * kVolumeFactors[1] + kVolumeFactors[2] + 25);
}

/// What we would have measured if it had been what they did.
BoundingResults results_of_1984() {
  BoundingResults results;
  for (const Environment& e : kEnvironments) {
    EnvironmentRun& run = results.environments.emplace_back();
    for (size_t c = 0; c < weghorst::kCombinationCount; ++c) {
      CombinationRun& r = run.runs.emplace_back();
      r.name = weghorst::kCombinations[c];
      const double total = e.total[c] > 0 ? e.total[c] : 1;
      r.write_s = total * e.miscellaneous[c] / 100;
      r.render_s = total - r.write_s;
      r.buffer_s = total * e.buffer[c] / 100;
      r.eye.s = total * e.tree[c] / 100;
      r.shadow.s = total * e.shadow[c] / 100;
    }
  }
  results.front = {1, 0.88, 1, 0.88};
  results.side = {0.47, 1, 0.47, 1};
  return results;
}

TEST(BoundingRelations, HoldOfTheNumbersThatTheyWereDrawnFrom) {
  std::vector<std::string> failing;
  for (const BoundingRelation& r : bounding_relations(results_of_1984()))
    if (!r.holds) failing.push_back(r.what);
  // CZ's shadows took 13 % longer than C's in Table II; view C of Table V has 5.0 %, which is not below 5.
  EXPECT_EQ(failing, (std::vector<std::string>{"Pencils I: Z leaves the time of shadows, CZ over C",
                                               "Polygons, view C: the buffer's share of SHZ"}));
}

TEST(BoundingRelations, FailWhereNumbersSayOtherwise) {
  BoundingResults results = results_of_1984();
  for (EnvironmentRun& e : results.environments)
    for (CombinationRun& r : e.runs) {
      r.render_s = r.shadow.s = 1;  // nothing saves anything
      r.eye.s = 0.1;
      r.secondary.s = 0.2;
      r.buffer_s = 0.2;
    }
  results.front = {1, 1, 1, 1};
  size_t held = 0, all = 0;
  for (const BoundingRelation& r : bounding_relations(results)) {
    ++all;
    held += r.holds ? 1 : 0;
    EXPECT_FALSE(r.why.empty());
  }
  EXPECT_GT(all, 70u);
  EXPECT_LT(held, all / 3);
}

}  // namespace
}  // namespace rayfarm
