#pragma once
// Loops whose steps do not depend on each other, on all cores.
#include <cstddef>
#include <functional>

namespace rayfarm {

/// Calls step(i) for every i below `count`, from as many threads as the machine has cores and the system
/// grants; with one step or core from this one alone. Of what steps throw, the exception of the smallest i
/// comes out when all have ended; steps after it may be left out.
void parallel_for(size_t count, const std::function<void(size_t)>& step);

/// How many steps run at once at most.
size_t core_count();

}  // namespace rayfarm
