#pragma once
// What the environment tells of how this process was started.

namespace rayfarm {

/// Standard streams that are closed lead nowhere from now on. Else the next file that is opened would be one
/// of them, and texts would be written into a picture. Reading and standard output fail, as they would.
void hold_standard_streams();

/// This process's rank, 0 without a launcher; known before MPI starts.
int launched_rank();

/// Several Slurm tasks that know nothing of each other would each render the whole image over the same files.
bool is_lone_slurm_task();
/// Says so, and what to do. Returns the exit code.
int report_lone_slurm_task();
/// Says that a command's processor id can't address so many nodes.
void report_too_many_nodes(int nodes);

}  // namespace rayfarm
