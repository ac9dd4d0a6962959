// Chooses the role: rank 0 is the host, every other rank a node; without mpirun both live in this process.
#include <future>
#include <optional>
#include <system_error>
#include <thread>

#include "common/errors/input_error.h"
#include "common/memory/address_space.h"
#include "host/commands/commands.h"
#include "host/process/console.h"
#include "host/process/exit_code.h"
#include "host/process/interrupt.h"
#include "host/process/launch.h"
#include "host/render/render_job.h"
#include "node/node.h"
#include "protocol/liveness.h"
#include "protocol/local_transport.h"
#include "protocol/mpi_session.h"

using namespace rayfarm;

namespace {

constexpr int kThreadsOfHost = 2;  ///< beside nodes: they write pictures and journals

int render_locally(const RenderOptions& options) {
  catch_interrupts();
  if (is_lone_slurm_task()) return report_lone_slurm_task();
  const int nodes =
      options.local_nodes > 0 ? options.local_nodes : std::max(1, int(std::thread::hardware_concurrency()));
  std::promise<std::span<const std::byte>> block;  // nodes wait for it when load code has come
  const std::shared_future loaded = block.get_future().share();
  bool is_loaded = false;
  std::promise<std::vector<std::unique_ptr<Transport>>> net;
  const std::shared_future ends = net.get_future().share();
  std::vector<std::thread> threads;
  int granted = nodes;
  try {
    for (int i = 1; i <= nodes; ++i)
      threads.emplace_back([ends, loaded, i] {
        if (static_cast<size_t>(i) < ends.get().size())
          run_node(
              *ends.get()[static_cast<size_t>(i)], NodeId(i), [&loaded](const auto&) { return loaded.get(); },
              make_workers());
      });
  } catch (const std::system_error& e) {
    if (threads.empty()) throw;
    granted = std::max(1, static_cast<int>(threads.size()) - kThreadsOfHost);
    say("rayfarm: the system refuses {} threads ({}); {} work\n", nodes, e.what(), granted);
  }
  net.set_value(make_local_transports(granted));
  for (; std::cmp_greater(threads.size(), granted); threads.pop_back()) threads.back().join();
  const auto load = [&](std::span<const std::byte> bytes) {
    if (!std::exchange(is_loaded, true)) block.set_value(bytes);
  };
  Farm farm{*ends.get()[0], 1,
            [&](std::span<const std::byte> bytes, const auto&, const auto&, const auto&) { load(bytes); },
            [&] {
              load({});  // whatever happened, no node waits for ever
              for (std::thread& thread : threads) thread.join();
            }};
  return run_render(options, farm).exit_code;
}

[[noreturn]] void render_on_mpi(const RenderOptions& options, int argc, char** argv) {
  MpiSession session(&argc, &argv);
  if (session.size() == 1)
    session.finish(is_lone_slurm_task() ? report_lone_slurm_task() : render_locally(options),
                   Parting::together);
  if (session.size() - 1 > kMostProcessors) {
    if (session.rank() == 0) report_too_many_nodes(session.size() - 1);
    session.finish(kUsageError, Parting::together);
  }
  const auto transport = session.make_transport();
  std::optional<Heart> heart(*transport);
  if (session.rank() == 0) {
    catch_interrupts();
    std::unique_ptr<SharedBlock> shared;
    Farm farm{*transport, session.size(),
              [&](std::span<const std::byte> block, const auto& is_sent, const auto& warn,
                  const auto& names_the_gone) {
                shared = session.load_data(block, is_sent, transport->meter(), warn, names_the_gone);
              }};
    const Ending ending = run_render(options, farm);
    heart.reset();
    session.finish(ending.exit_code, ending.has_hung_nodes ? Parting::ending_the_hung
                                     : ending.has_losses   ? Parting::without_the_lost
                                                           : Parting::together);
  }
  std::unique_ptr<SharedBlock> shared;
  const auto load_scene_block = [&](const ProcessSign& host) {
    shared = session.load_data(
        {}, [](size_t) {}, nullptr, [](const std::string& text) { say("rayfarm: {}\n", text); },
        make_witness({{"the host", host}}, liveness::kGraceForHost_s));
    return shared->bytes();
  };
  const NodeEnding ending = run_node(*transport, NodeId(session.rank()), load_scene_block, make_workers());
  heart.reset();
  session.finish(ending == NodeEnding::failed ? kRenderFailure : kComplete,
                 ending == NodeEnding::finished ? Parting::together : Parting::without_the_lost);
}

int run(const Request& request, int argc, char** argv) {
  // All but a render are one process's work, and one process's words.
  const bool is_for_all_ranks = request.verb && request.verb->is_for_all_ranks;
  if (!is_for_all_ranks && launched_rank() != 0) return request.exit_code;
  if (!request.verb) {
    request.exit_code == 0 ? fmt::print("{}", request.message) : say("{}", request.message);
    return request.exit_code;
  }
  const auto render = [&](const RenderOptions& options) {
    if (MpiSession::is_launched()) render_on_mpi(options, argc, argv);
    return render_locally(options);
  };
  return request.verb->run({render, render_locally});
}

}  // namespace

int main(int argc, char** argv) {
  share_heap_if_limited();
  hold_standard_streams();
  leave_warnings_to_the_host();
  int code = kRenderFailure;
  try {
    code = run(read_command_line(argc, argv), argc, argv);
    if (!flush_results() && code == kComplete) code = kRenderFailure;
  } catch (const std::exception& e) {
    say("rayfarm: {}\n", e.what());
    if (dynamic_cast<const InputError*>(&e) || dynamic_cast<const IoError*>(&e)) code = kSceneError;
  }
  if (code != 0 && launched_rank() == 0) {
    std::fflush(nullptr);
    end_job(code);
  }
  return code;
}
