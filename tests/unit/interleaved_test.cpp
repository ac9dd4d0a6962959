// Interleaved work (thesis 4.4.4.2): which subpolygons are whose, how the sets move, and what the host makes
// of it.
#include <deque>
#include <set>

#include "host/farm/assignment.h"
#include "protocol/job_plan.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(Interleaved, SetsAreEvenlySpread) {
  for (const int processors : {1, 2, 3, 8, 13}) {
    const SubpolygonGrid grid = make_grid(0, 0, 1024, 1024, processors);
    std::vector<int> owners(static_cast<size_t>(grid.count()), -1);
    for (int p = 0; p < processors; ++p)
      for (const SubpolygonId s : interleaved_set(grid, SetPattern::lattice, processors, p))
        owners[s.place()] = p;
    EXPECT_EQ(std::count(owners.begin(), owners.end(), -1), 0);
    for (int p = 0; p < processors; ++p)
      EXPECT_NEAR(static_cast<double>(std::count(owners.begin(), owners.end(), p)),
                  double(grid.count()) / processors, 2);
    if (processors > 2)  // no column belongs to one processor
      for (int column = 0; column < grid.columns; ++column) {
        bool differs = false;
        for (int row = 1; row < grid.rows; ++row)
          differs = differs || owners[static_cast<size_t>(row * grid.columns + column)] !=
                                   owners[static_cast<size_t>(column)];
        EXPECT_TRUE(differs);
      }
  }
}

struct SetCase {
  SubpolygonGrid grid;
  int processors;
};
/// 2 × 2, 3 × 5, and the 64 N of the thesis.
std::vector<SetCase> set_cases() {
  std::vector<SetCase> cases{{{0, 0, 20, 20, 2, 2}, 4},  {{0, 0, 20, 20, 2, 2}, 3},
                             {{0, 0, 30, 50, 3, 5}, 15}, {{0, 0, 30, 50, 3, 5}, 4},
                             {{0, 0, 50, 30, 5, 3}, 5},  {{0, 0, 512, 512, 16, 16}, 4}};
  for (const int processors : {7, 13}) cases.push_back({make_grid(0, 0, 1024, 1024, processors), processors});
  return cases;
}

// Thesis 4.4.4.2: "Rather than tracing the same subpolygon, the processor will do the subvolume directly to
// the right. [...] If the current subpolygon was on the right edge of the main display polygon the processor
// indexes down a row and over to the left. If the current subpolygon is in the bottom right corner of the
// main display polygon the upper left hand corner should be used."
TEST(Interleaved, FromFrameToFrameAProcessorMovesToTheRight_4_4_4_2) {
  for (const auto& [grid, processors] : set_cases())
    for (const SetPattern pattern : {SetPattern::rows, SetPattern::lattice})
      for (const int frame : {0, 1, 2, grid.count() - 1, grid.count(), 1000003})
        for (SubpolygonId s; s.value() < grid.count(); ++s) {
          int column = s.value() % grid.columns, row = s.value() / grid.columns;
          if (column < grid.columns - 1) {
            ++column;  // directly to the right
          } else if (row < grid.rows - 1) {
            ++row;  // down a row and over to the left
            column = 0;
          } else {
            row = column = 0;  // the upper left hand corner
          }
          EXPECT_EQ(interleaved_owner(grid, pattern, processors, FrameIndex(frame + 1),
                                      SubpolygonId(row * grid.columns + column)),
                    interleaved_owner(grid, pattern, processors, FrameIndex(frame), s));
        }
}

// Thesis 4.4.4.2: "each processor will have rendered part of this section an equal number of times".
TEST(Interleaved, EachProcessorHasEachSubpolygonEquallyOften_4_4_4_2) {
  for (const auto& [grid, processors] : set_cases())
    for (const SetPattern pattern : {SetPattern::rows, SetPattern::lattice}) {
      if (grid.count() % processors != 0) continue;
      const SubpolygonId hard(grid.count() / 3);
      std::vector<int> times(static_cast<size_t>(processors));
      for (FrameIndex f; f.value() < grid.count(); ++f)
        ++times[static_cast<size_t>(interleaved_owner(grid, pattern, processors, f, hard))];
      EXPECT_EQ(times, std::vector<int>(times.size(), grid.count() / processors));
    }
}

// Thesis 4.4.4.2: "The distribution of the set of subpolygons rendered by a processor is such that they are
// evenly distributed across the scene": in rows, one in every N; where 64 N make the picture, 64 each.
TEST(Interleaved, RowsGiveAProcessorOneInEveryN_4_4_4_2) {
  for (const auto& [grid, processors] : set_cases())
    for (int p = 0; p < processors; ++p) {
      const auto set = interleaved_set(grid, SetPattern::rows, processors, p);
      for (size_t i = 0; i < set.size(); ++i) EXPECT_EQ(set[i].value(), p + processors * static_cast<int>(i));
      EXPECT_GE(static_cast<int>(set.size()), grid.count() / processors);
    }
  const SubpolygonGrid grid{0, 0, 64, 64, 16, 16};  // 64 for each of 4
  for (int p = 0; p < 4; ++p) EXPECT_EQ(interleaved_set(grid, SetPattern::rows, 4, p).size(), 64u);
  // By hand, of the sets of 2 × 2 subpolygons and 3 processors: 0 1 2 0, then 0 0 1 2, then 2 0 0 1.
  const SubpolygonGrid four{0, 0, 20, 20, 2, 2};
  const int owners[3][4]{{0, 1, 2, 0}, {0, 0, 1, 2}, {2, 0, 0, 1}};
  for (int frame = 0; frame < 3; ++frame)
    for (int s = 0; s < 4; ++s)
      EXPECT_EQ(interleaved_owner(four, SetPattern::rows, 3, FrameIndex(frame), SubpolygonId(s)),
                owners[frame][s]);
}

TEST(Interleaved, ANodeFindsWhatTheHostExpectsOfIt) {
  for (const SetPattern pattern : {SetPattern::rows, SetPattern::lattice})
    for (const bool rotates : {true, false}) {
      JobPlan plan;
      plan.processors = 3;
      plan.sets = pattern;
      plan.rotates = rotates;
      const PicturesPhase phase{std::vector<FrameNumber>(20), make_grid(0, 0, 40, 24, 3), {}};
      for (int p = 0; p < 3; ++p) {
        const auto set = interleaved_set(phase.grid, pattern, 3, p);
        for (FrameIndex f; f.value() < 20; ++f) {
          std::set<ItemIndex> expected, found;
          for (SubpolygonId s; s.value() < phase.grid.count(); ++s)
            if (owner_of(plan, phase, phase.item_of(f, s)) == NodeId(p + 1))
              expected.insert(phase.item_of(f, s));
          for (const SubpolygonId s : set) found.insert(phase.item_of(f, own_subpolygon(plan, phase, f, s)));
          EXPECT_EQ(found, expected);
        }
      }
    }
}

TEST(Interleaved, AnIdleNodeDoesWhatASlowOneHasNotBegun) {
  constexpr NodeId kNode1{1}, kNode2{2};
  AssignmentOptions options;
  options.nodes = 2;
  options.items_per_step = 64;
  options.owner_of = [](ItemIndex item) { return NodeId(static_cast<int>(item.value() % 2) + 1); };
  Assignment machine(options, 0);
  std::deque<ItemIndex> of_slow;
  for (ItemIndex i; i.value() < options.items_per_step; ++i) {
    if (options.owner_of(i) == kNode1)
      machine.accept(kNode1, i, 0.5);
    else
      of_slow.push_back(i);
  }
  machine.take_actions();
  machine.hear(kNode2, 0.9);
  machine.tick(0.9);
  EXPECT_TRUE(machine.take_actions().empty()) << "it has had its first for less than a second";
  machine.hear(kNode2, 1.6);
  machine.tick(1.6);
  while (!of_slow.empty()) {
    const auto actions = machine.take_actions();
    ASSERT_EQ(actions.size(), 1u);
    const auto& assign = std::get<AssignItem>(actions.front());
    EXPECT_EQ(assign.node, kNode1);
    EXPECT_EQ(assign.item, of_slow.front());
    machine.accept(kNode1, of_slow.front(), 1.7);
    of_slow.pop_front();
  }
  const auto actions = machine.take_actions();
  ASSERT_EQ(actions.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<StepComplete>(actions.front()));
}

// Thesis 4.4.4.2: 64 N subpolygons, of its 4,444 processors and 1024 × 1024 pixels. No result may cost a walk
// over all nodes or items, or this takes minutes.
TEST(Assignment, HoldsTheThesissNumbers_4_4_4_2) {
  constexpr int kProcessors = 4444;
  const SubpolygonGrid grid = make_grid(0, 0, 1024, 1024, kProcessors, kSubpolygonsPerProcessor, 1);
  EXPECT_NEAR(grid.count(), 64 * kProcessors, 0.1 * 64 * kProcessors);
  for (const AssignmentPolicy policy : {AssignmentPolicy::interleaved, AssignmentPolicy::on_demand}) {
    AssignmentOptions options;
    options.nodes = kProcessors;
    options.items_per_step = grid.count();
    if (policy == AssignmentPolicy::interleaved)
      options.owner_of = [&grid](ItemIndex item) {
        const SubpolygonId s(static_cast<int>(item.value()));
        return NodeId(interleaved_owner(grid, SetPattern::rows, kProcessors, FrameIndex(0), s) + 1);
      };
    Assignment machine(options, 0);
    int done = 0;
    const auto accept = [&](NodeId node, ItemIndex item) { done += machine.accept(node, item, 0.5) ? 1 : 0; };
    if (policy == AssignmentPolicy::interleaved) {
      for (ItemIndex i; i.value() < grid.count(); ++i) accept(options.owner_of(i), i);
    } else {
      for (std::deque<AssignItem> queue; done < grid.count();) {
        for (const Action& action : machine.take_actions())
          if (const auto* assign = std::get_if<AssignItem>(&action)) queue.push_back(*assign);
        ASSERT_FALSE(queue.empty());
        accept(queue.front().node, queue.front().item);
        queue.pop_front();
      }
    }
    EXPECT_EQ(done, grid.count());
    const auto actions = machine.take_actions();
    EXPECT_TRUE(std::any_of(actions.begin(), actions.end(),
                            [](const Action& a) { return std::holds_alternative<StepComplete>(a); }));
  }
}

}  // namespace
}  // namespace rayfarm
