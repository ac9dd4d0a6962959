#include "host/farm/dismissal.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "protocol/build_identity.h"
#include "protocol/clock.h"
#include "protocol/watchdog.h"

namespace rayfarm {

void mark_silent_nodes(Transport& transport, std::span<const ProcessSign> signs, JobResult& result) {
  if (signs.empty()) return;
  std::set<NodeId> asked;
  for (const NodeResult& node : result.nodes)
    if (!node.is_lost) asked.insert(node.id);
  for (const NodeId node : asked) transport.send(node, AskPresent{});
  const auto lose = [&result](NodeId node) { return result.node(node).is_lost = true; };
  ListeningClock listening;
  Backoff backoff;
  for (; !asked.empty() && listening.turn(now_s()) < liveness::kLastWord_s; backoff.wait()) {
    while (const auto message = transport.try_receive()) {
      if (message->channel != Channel::control) continue;
      try {
        // A beating heart is not enough: who does not answer would not hear that the job is over, either.
        if (std::holds_alternative<Present>(decode_control(message->bytes))) asked.erase(message->source);
      } catch (const ProtocolError&) {
        // The pictures are whole: a node that sends nonsense now is as good as silent.
      }
    }
    std::erase_if(asked, [&](NodeId node) { return signs[node.place() - 1].is_gone() && lose(node); });
  }
  for (const NodeId node : asked) lose(node);
}

bool end_hung_nodes(Transport& transport, const JobResult& result) {
  bool is_any_left = false;
  const std::string here = machine_name();
  for (const NodeResult& lost : result.nodes) {
    if (!lost.is_lost || lost.pid == static_cast<uint32_t>(getpid())) continue;
    if (lost.machine == here) {
      end_hung_process(lost.pid);
      continue;
    }
    const auto neighbour = std::find_if(result.nodes.begin(), result.nodes.end(), [&](const NodeResult& n) {
      return !n.is_lost && n.machine == lost.machine;
    });
    if (neighbour != result.nodes.end())
      transport.send(neighbour->id, EndProcess{lost.pid});
    else
      is_any_left = true;
  }
  return is_any_left;
}

void dismiss_nodes(Transport& transport, bool has_losses) {
  transport.broadcast(Channel::control, encode_control(Finish{has_losses}));
  if (transport.is_one_process()) return;  // they hear it as it is said
  // The last messages leave before the process does; nodes end within a poll.
  constexpr int kTurns = 20;
  for (int i = 0; i < kTurns; ++i) {
    while (transport.try_receive()) {
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(liveness::kFarewell_s / kTurns));
  }
}

}  // namespace rayfarm
