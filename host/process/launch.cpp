#include "host/process/launch.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>

#include "host/process/console.h"
#include "host/process/exit_code.h"
#include "protocol/messages.h"

namespace rayfarm {

void hold_standard_streams() {
  // The lowest free number is taken, so that each finds its own.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
}

int launched_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
    if (const char* rank = std::getenv(name)) return std::atoi(rank);
  return 0;
}

bool is_lone_slurm_task() {
  const char* tasks = std::getenv("SLURM_NTASKS");
  return tasks && std::atoi(tasks) > 1;
}

int report_lone_slurm_task() {
  say("rayfarm: Slurm started {} tasks, but MPI sees one process; start with `srun --mpi=pmix rayfarm …` or "
      "`mpirun rayfarm …` inside the allocation\n",
      std::getenv("SLURM_NTASKS"));
  return kUsageError;
}

void report_too_many_nodes(int nodes) {
  say("rayfarm: {} nodes are more than the {} that a command's 14 bits can address; start fewer processes\n",
      nodes, kMostProcessors);
}

}  // namespace rayfarm
