// Chooses the role: rank 0 is the host, every other rank a node; without mpirun both live in this process.
#include <fmt/core.h>

#include <cstdlib>
#include <thread>

#include "common/scene/input_error.h"
#include "host/exit_code.h"
#include "host/interrupt.h"
#include "host/lighting_experiment.h"
#include "host/net/net_commands.h"
#include "host/net/net_load_experiment.h"
#include "host/net/working_sets.h"
#include "host/render_command.h"
#include "host/scene_commands.h"
#include "node/node.h"
#include "protocol/local_transport.h"
#include "protocol/mpi_session.h"

using namespace rayfarm;

namespace {

int launched_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
    if (const char* rank = std::getenv(name)) return std::atoi(rank);
  return 0;
}

/// Several Slurm tasks that know nothing of each other would each render the whole image over the same files.
bool is_lone_slurm_task() {
  const char* tasks = std::getenv("SLURM_NTASKS");
  return tasks && std::atoi(tasks) > 1;
}

int report_lone_slurm_task() {
  fmt::print(
      stderr,
      "rayfarm: Slurm started {} tasks, but MPI sees one process; start with `srun --mpi=pmix rayfarm …` or "
      "`mpirun rayfarm …` inside the allocation\n",
      std::getenv("SLURM_NTASKS"));
  return kUsageError;
}

int render_locally(const RenderOptions& options) {
  catch_interrupts();
  if (is_lone_slurm_task()) return report_lone_slurm_task();
  const int nodes = options.local_nodes > 0
                        ? options.local_nodes
                        : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const auto ends = make_local_transports(nodes);
  std::span<const std::byte> block;  // set before load code is sent, read by nodes after it came
  std::vector<std::thread> threads;
  for (int i = 1; i <= nodes; ++i)
    threads.emplace_back([&ends, &block, i] {
      run_node(
          *ends[static_cast<size_t>(i)], i, [&block] { return block; }, make_scene_tracer);
    });
  Farm farm{*ends[0], 1, [&block](std::span<const std::byte> bytes, const auto&) { block = bytes; }};
  const Ending ending = run_render(options, farm);
  for (std::thread& thread : threads) thread.join();
  return ending.exit_code;
}

[[noreturn]] void render_on_mpi(const RenderOptions& options, int argc, char** argv) {
  MpiSession session(&argc, &argv);
  if (session.size() == 1)
    session.finish(is_lone_slurm_task() ? report_lone_slurm_task() : render_locally(options),
                   Parting::together);
  if (session.size() - 1 > kMostProcessors) {
    if (session.rank() == 0)
      fmt::print(stderr,
                 "rayfarm: {} nodes are more than the {} that a command's 14 bits can address; start fewer "
                 "processes\n",
                 session.size() - 1, kMostProcessors);
    session.finish(kUsageError, Parting::together);
  }
  const auto transport = session.make_transport();
  if (session.rank() == 0) {
    catch_interrupts();
    std::unique_ptr<SharedBlock> shared;
    Farm farm{*transport, session.size(), [&](std::span<const std::byte> block, const auto& warn) {
                shared = session.load_data(block, transport->meter(), warn);
              }};
    const Ending ending = run_render(options, farm);
    session.finish(ending.exit_code, ending.has_hung_nodes ? Parting::ending_the_hung
                                     : ending.has_losses   ? Parting::without_the_lost
                                                           : Parting::together);
  }
  std::unique_ptr<SharedBlock> shared;
  const auto load_scene_block = [&] {
    shared = session.load_data({}, nullptr,
                               [](const std::string& text) { fmt::print(stderr, "rayfarm: {}\n", text); });
    return shared->bytes();
  };
  const NodeEnding ending = run_node(*transport, session.rank(), load_scene_block, make_scene_tracer);
  session.finish(ending == NodeEnding::failed ? kRenderFailure : kComplete,
                 ending == NodeEnding::finished ? Parting::together : Parting::without_the_lost);
}

int run(const CommandLine& line, int argc, char** argv) {
  switch (line.kind) {
    case CommandKind::none:
      if (launched_rank() == 0) fmt::print(line.exit_code == 0 ? stdout : stderr, "{}", line.message);
      return line.exit_code;
    case CommandKind::render:
      if (MpiSession::is_launched()) render_on_mpi(line.render, argc, argv);
      return render_locally(line.render);
    case CommandKind::check:
      return launched_rank() == 0 ? run_check(line.scene) : kComplete;
    case CommandKind::info:
      return launched_rank() == 0 ? run_info(line.scene) : kComplete;
    case CommandKind::experiment:
      if (launched_rank() != 0) return kComplete;
      if (line.experiment.name == "net-load") return run_net_load_experiment(line.experiment, render_locally);
      if (line.experiment.name == "working-sets") return run_working_set_experiment(line.experiment);
      return run_lighting_experiment(line.experiment, render_locally);
    case CommandKind::model:
      return launched_rank() == 0 ? run_model(line.model) : kComplete;
    case CommandKind::simulate:
      return launched_rank() == 0 ? run_simulate(line.simulate) : kComplete;
    case CommandKind::compare:
      return launched_rank() == 0 ? run_compare(line.compare) : kComplete;
  }
  return kComplete;
}

}  // namespace

int main(int argc, char** argv) {
  int code = kRenderFailure;
  try {
    code = run(parse_command_line(argc, argv), argc, argv);
  } catch (const InputError& e) {
    fmt::print(stderr, "rayfarm: {}\n", e.what());
    code = kSceneError;
  } catch (const IoError& e) {
    fmt::print(stderr, "rayfarm: {}\n", e.what());
    code = kSceneError;
  } catch (const std::exception& e) {
    fmt::print(stderr, "rayfarm: {}\n", e.what());
  }
  if (code != 0 && launched_rank() == 0) {
    std::fflush(nullptr);
    end_job(code);
  }
  return code;
}
