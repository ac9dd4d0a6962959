// What the host's state machine takes for a result, by the number of nodes: simulated ones, without a net, 64
// subpolygons for each in every frame, 10 frames. Items take one to three seconds, at one node in ten ten
// times as long: at the end of a job all that are at work are slow, and idle nodes help. One in a thousand is
// lost.
//   assignment [NODES ...]      default: 10 100 1000 16383
#include "host/farm/assignment.h"

#include <fmt/core.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <queue>
#include <vector>

#include "protocol/job_plan.h"

namespace {

using namespace rayfarm;

struct Measured {
  uint64_t results = 0, handed_out = 0;
  double seconds = 0;  ///< in the state machine
};

constexpr int kFrames = 10, kPerNode = 64;

/// What comes of an item when: nodes work through what they hold.
struct Coming {
  double at;
  NodeId node;
  ItemIndex item;
  bool operator>(const Coming& other) const { return at > other.at; }
};

void play(int nodes, bool interleaved, Measured& measured) {
  AssignmentOptions options;
  options.nodes = nodes;
  options.steps = kFrames;
  options.items_per_step = nodes * kPerNode;
  if (interleaved)
    options.owner_of = [nodes](ItemIndex item) { return NodeId(static_cast<int>(item.value() % nodes) + 1); };
  std::vector<double> free_at(static_cast<size_t>(nodes) + 1);
  std::priority_queue<Coming, std::vector<Coming>, std::greater<>> coming;
  uint64_t random = 1;
  const auto takes = [&](NodeId node) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    return (1 + 2 * static_cast<double>(random >> 40) / (1 << 24)) * (node.value() % 10 == 9 ? 10 : 1);
  };
  double now = 0;
  const auto begins = [&](NodeId node, ItemIndex item) {
    double& free = free_at[node.place()];
    free = std::max(free, now) + takes(node);
    coming.push({free, node, item});
  };
  StepIndex opened;
  const auto take_up = [&](const std::vector<Action>& actions, Assignment& machine) {
    for (const Action& action : actions) {
      if (const auto* assign = std::get_if<AssignItem>(&action)) {
        ++measured.handed_out;
        begins(assign->node, assign->item);
      } else if (const auto* open = std::get_if<OpenedSteps>(&action)) {
        for (; opened < open->end; ++opened)
          for (int64_t i = 0; i < options.items_per_step; ++i) {
            const ItemIndex item(int64_t{opened.value()} * options.items_per_step + i);
            begins(options.owner_of(item), item);
          }
      } else if (const auto* complete = std::get_if<StepComplete>(&action)) {
        machine.release(complete->step, now);
      }
    }
  };

  using Clock = std::chrono::steady_clock;
  const auto timed = [&](const auto& what) {
    const auto begin = Clock::now();
    what();
    measured.seconds += std::chrono::duration<double>(Clock::now() - begin).count();
  };
  std::unique_ptr<Assignment> machine;
  std::vector<Action> actions;
  timed([&] {
    machine = std::make_unique<Assignment>(options, now);
    actions = machine->take_actions();
  });
  take_up(actions, *machine);
  double ticked = 0;
  std::vector<Coming> batch;
  while (!machine->is_over()) {
    // As the host does: what has come, then the actions.
    batch.clear();
    while (!coming.empty() && batch.size() < 100) {
      batch.push_back(coming.top());
      coming.pop();
    }
    if (batch.empty()) {
      fmt::print(stderr, "assignment: nothing is at work, and the job is not over\n");
      std::exit(1);
    }
    now = std::max(now, batch.back().at);
    timed([&] {
      for (const Coming& c : batch) {
        if (c.node.value() % 1000 == 500 && c.at > 5) {
          machine->expel(c.node, now);
          continue;
        }
        machine->accept(c.node, c.item, now);
      }
      // All others are well: they say so once a second.
      if (now - ticked > 0.1) {
        for (NodeId node(1); node.value() <= nodes; ++node) machine->hear(node, now);
        machine->tick(now);
        ticked = now;
      }
      actions = machine->take_actions();
    });
    measured.results += batch.size();
    // Releasing is the machine's work, too, but also what begins the next frame.
    timed([&] { take_up(actions, *machine); });
    timed([&] { actions = machine->take_actions(); });
    take_up(actions, *machine);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> counts;
  for (int i = 1; i < argc; ++i) counts.push_back(std::atoi(argv[i]));
  if (counts.empty()) counts = {10, 100, 1000, 16383};
  fmt::print("{:>8} {:>12} {:>12} {:>14} {:>14}\n", "nodes", "policy", "results", "ns a result",
             "results a s");
  for (const bool interleaved : {false, true})
    for (const int nodes : counts) {
      Measured measured;
      do {
        play(nodes, interleaved, measured);
      } while (measured.results < 200'000);
      const double each = measured.seconds / static_cast<double>(measured.results);
      fmt::print("{:8} {:>12} {:12} {:14.0f} {:14.0f}\n", nodes, interleaved ? "interleaved" : "on demand",
                 measured.results, 1e9 * each, 1 / each);
    }
}
