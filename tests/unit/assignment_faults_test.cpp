// A thousand simulated nodes that hang, come back, die, fail, and say things twice: a million events, after
// each of which nothing may be done twice, forgotten, or kept longer than needed.
#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "host/farm/assignment.h"

namespace rayfarm {
namespace {

class FaultyFarm {
 public:
  FaultyFarm(bool interleaved, uint32_t seed) : random_(seed), nodes_(kNodes + 1) {
    options_.nodes = kNodes;
    options_.steps = kSteps;
    options_.items_per_step = kItems;
    if (interleaved)
      options_.owner_of = [](ItemIndex i) { return NodeId(static_cast<int>(i.value() * 7 % kNodes) + 1); };
    machine_ = std::make_unique<Assignment>(options_, now_);
    carry_out();
  }

  /// Until the job is over.
  void play() {
    while (!machine_->is_over() && !::testing::Test::HasFailure()) {
      now_ += 1.0 / 2000;
      ++events_;
      const uint32_t what = draw(10'000);
      const NodeId node(static_cast<int>(draw(kNodes)) + 1);
      Node& state = nodes_[node.place()];
      if (what < 3) {
        state.silent_until = now_ + (what == 0 ? 1e9 : 4 + static_cast<double>(draw(16)));
      } else if (what == 3 && expelled_ < kNodes / 4) {
        ++expelled_;
        state.silent_until = 1e9;
        machine_->expel(node, now_);
      } else if (what < 300 && !said_.empty()) {
        const auto& [who, item] = said_[draw(static_cast<uint32_t>(said_.size()))];
        come(who, item);  // again
      } else if (what < 310) {
        if (const auto item = next_of(node)) fail(node, *item);
      } else if (what < 320 && !complete_.empty()) {
        release(complete_.begin()->first);
      } else if (const auto item = next_of(node)) {
        if (item->value() % 100'003 == 7)  // one in some of the steps that nobody can do
          fail(node, *item);
        else
          come(node, *item);
      }
      if (now_ - beat_ > 0.5) beat();
      carry_out();
      if (events_ % 4096 == 0) audit();
    }
    audit();
  }

  /// Every item was done once, but for those of steps that failed.
  void check_end() {
    EXPECT_TRUE(machine_->is_over());
    for (int64_t i = 0; i < int64_t{kSteps} * kItems; ++i)
      ASSERT_TRUE(done_.contains(i) || failed_.contains(step_of(ItemIndex(i)))) << i;
  }
  uint64_t events() const { return events_; }
  int lost() const { return lost_; }
  int returned() const { return returned_; }
  size_t failed() const { return failed_.size(); }

 private:
  static constexpr int kNodes = 1000, kSteps = 80, kItems = 6400;
  struct Node {
    std::deque<ItemIndex> queue;  ///< what it will do, whatever the host thinks of it
    std::set<ItemIndex> held;     ///< what the host thinks that it does
    std::set<ItemIndex> given;    ///< of that, handed out by the host
    double silent_until = 0;
    bool is_lost = false;
  };

  uint32_t draw(uint32_t below) { return static_cast<uint32_t>(random_() % below); }
  static StepIndex step_of(ItemIndex i) { return StepIndex(static_cast<int>(i.value() / kItems)); }
  std::optional<ItemIndex> next_of(NodeId node) {
    Node& state = nodes_[node.place()];
    if (state.silent_until > now_ || state.queue.empty()) return std::nullopt;
    const ItemIndex item = state.queue.front();
    state.queue.pop_front();
    return item;
  }
  void let_go(NodeId node, ItemIndex item) {
    nodes_[node.place()].held.erase(item);
    nodes_[node.place()].given.erase(item);
  }
  void come(NodeId node, ItemIndex item) {
    if (said_.size() < 500) said_.emplace_back(node, item);
    said_[draw(static_cast<uint32_t>(said_.size()))] = {node, item};
    let_go(node, item);
    if (machine_->accept(node, item, now_)) {
      ASSERT_TRUE(done_.insert(item.value()).second) << "done twice";
      ASSERT_LT(step_of(item), opened_);
      ASSERT_FALSE(failed_.contains(step_of(item)));
    }
  }
  void fail(NodeId node, ItemIndex item) {
    let_go(node, item);
    machine_->fail(node, item, "it had no mind to", now_);
  }
  void release(StepIndex step) {
    complete_.erase(step);
    ++released_;
    machine_->release(step, now_);
  }
  void beat() {
    beat_ = now_;
    for (NodeId node(1); node.value() <= kNodes; ++node) {
      ++events_;
      if (nodes_[node.place()].silent_until <= now_) machine_->hear(node, now_);
    }
    machine_->tick(now_);
    while (complete_.size() > 1) release(complete_.begin()->first);
  }
  void hold(NodeId node, ItemIndex item, bool is_given) {
    Node& state = nodes_[node.place()];
    state.queue.push_back(item);
    state.held.insert(item);
    if (is_given) state.given.insert(item);
    ASSERT_LE(state.given.size(), 2u);
  }
  void carry_out() {
    for (auto actions = machine_->take_actions(); !actions.empty(); actions = machine_->take_actions())
      for (const Action& action : actions) {
        if (const auto* a = std::get_if<AssignItem>(&action)) {
          ASSERT_FALSE(nodes_[a->node.place()].is_lost);
          ASSERT_FALSE(done_.contains(a->item.value()));
          hold(a->node, a->item, true);
          opened_ = std::max(opened_, StepIndex(step_of(a->item).value() + 1));
        } else if (const auto* o = std::get_if<OpenedSteps>(&action)) {
          for (ItemIndex i(int64_t{opened_.value()} * kItems); step_of(i) < o->end; ++i)
            if (!nodes_[options_.owner_of(i).place()].is_lost) hold(options_.owner_of(i), i, false);
          opened_ = o->end;
        } else if (const auto* c = std::get_if<StepComplete>(&action)) {
          complete_[c->step] = true;
        } else if (const auto* f = std::get_if<StepFailed>(&action)) {
          failed_.insert(f->step);
          complete_[f->step] = false;
        } else if (const auto* l = std::get_if<NodeLost>(&action)) {
          Node& node = nodes_[l->node.place()];
          node.is_lost = true;
          node.held.clear();
          node.given.clear();
          ++lost_;
        } else if (const auto* r = std::get_if<NodeReturned>(&action)) {
          nodes_[r->node.place()].is_lost = false;
          ++returned_;
        }
        ASSERT_LE(opened_.value() - released_, options_.window_steps) << "more in memory than the window";
      }
  }
  /// Whatever is to do is in the hands of a node that is heard, unless all of these have their hands full.
  void audit() {
    std::set<ItemIndex> held;
    int with_room = 0;
    for (NodeId node(1); node.value() <= kNodes; ++node) {
      const Node& state = nodes_[node.place()];
      if (state.is_lost) continue;
      held.insert(state.held.begin(), state.held.end());
      with_room += state.given.size() < 2 ? 1 : 0;
    }
    if (with_room < 2) return;  // one may be the node at which the item failed
    const int64_t first = std::max(int64_t{0}, int64_t{opened_.value() - 8}) * kItems;
    for (ItemIndex i(first); step_of(i) < opened_; ++i)
      ASSERT_TRUE(done_.contains(i.value()) || failed_.contains(step_of(i)) || held.contains(i))
          << "forgotten";
  }

  std::mt19937 random_;
  AssignmentOptions options_;
  std::vector<Node> nodes_;
  std::unique_ptr<Assignment> machine_;
  double now_ = 0, beat_ = 0;
  uint64_t events_ = 0;
  std::set<int64_t> done_;
  std::vector<std::pair<NodeId, ItemIndex>> said_;
  std::map<StepIndex, bool> complete_;  ///< not yet released
  std::set<StepIndex> failed_;
  StepIndex opened_;
  int released_ = 0, lost_ = 0, returned_ = 0, expelled_ = 0;
};

void play_a_million_events(bool interleaved) {
  FaultyFarm farm(interleaved, interleaved ? 2 : 1);
  farm.play();
  farm.check_end();
  EXPECT_GT(farm.events(), 1'000'000u);
  EXPECT_GT(farm.lost(), 50);
  EXPECT_GT(farm.returned(), 20);
  EXPECT_GT(farm.failed(), 1u);
}

TEST(AssignmentFaults, AMillionEventsOnDemand) {
  play_a_million_events(false);
}

TEST(AssignmentFaults, AMillionEventsInterleaved) {
  play_a_million_events(true);
}

}  // namespace
}  // namespace rayfarm
