#include "host/farm/roll_call.h"

#include <fmt/core.h>
#include <unistd.h>

#include "host/process/exit_code.h"
#include "host/process/interrupt.h"
#include "protocol/build_identity.h"
#include "protocol/clock.h"

namespace rayfarm {

RollCall::RollCall(Transport& transport, JobResult& result) : transport_(transport), result_(result) {
  for (NodeId id(1); id.value() <= transport.node_count(); ++id) {
    result_.nodes.push_back({});
    result_.nodes.back().id = id;
  }
  heard_.assign(result_.nodes.size(), -1);
  if (!transport.is_one_process()) signs_.resize(result_.nodes.size());
  transport_.broadcast(Channel::control, encode_control(Hello{machine_name(), static_cast<uint32_t>(getpid()),
                                                              build_identity()}));
}

void RollCall::serve() {
  listening_.turn(now_s());
  while (auto message = transport_.try_receive()) {
    const auto i = message->source.place() - 1;
    if (heard_[i] < 0) ++reported_;
    heard_[i] = listening_.now();
    if (message->channel != Channel::control) continue;
    const Control control = decode_control(message->bytes);
    if (const auto* hello = std::get_if<Hello>(&control)) {
      result_.nodes[i].machine = hello->machine;
      result_.nodes[i].pid = hello->pid;
      if (!signs_.empty()) signs_[i] = ProcessSign(hello->machine, hello->pid);
      if (hello->build != build_identity())
        throw JobError(
            kRenderFailure,
            fmt::format("node {} on {} runs another build of rayfarm than the host; install the same on "
                        "every machine, for images of two builds may differ",
                        message->source.value(), hello->machine));
    }
  }
  if (interrupted_by() != 0) throw JobError(kStopped, "stopped before the scene was loaded");
  if (signs_.empty() || now_s() - looked_s_ < liveness::kLook_s) return;
  looked_s_ = now_s();
  for (size_t i = 0; i < heard_.size(); ++i) judge(i);
}

void RollCall::judge(size_t i) {
  const NodeResult& node = result_.nodes[i];
  if (heard_[i] < 0) {
    if (listening_.now() > liveness::kLoadingStep_s)
      throw JobError(kRenderFailure, fmt::format("node {} was lost before it reported; the job ends", i + 1));
    return;
  }
  const bool is_gone = signs_[i].is_gone();
  if (is_gone || listening_.now() - heard_[i] > liveness::kLoadingStep_s)
    throw JobError(
        kRenderFailure,
        fmt::format(
            "node {} on {} (process {}) was lost while loading: {}; the job ends. Start it "
            "again, without the machine that failed",
            i + 1, node.machine, node.pid,
            is_gone ? "its process is gone" : fmt::format("silent for {:g} s", liveness::kLoadingStep_s)));
}

std::function<std::string()> RollCall::make_node_witness() const {
  std::vector<std::pair<std::string, ProcessSign>> watched;
  for (size_t i = 0; i < signs_.size(); ++i) watched.emplace_back(fmt::format("node {}", i + 1), signs_[i]);
  return make_witness(std::move(watched), 0);
}

}  // namespace rayfarm
