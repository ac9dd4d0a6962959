#pragma once
#include <cstdint>

namespace rayfarm {

/// Bytes that this process can still take: the least of what the machine has, what its control group leaves
/// and what its limit on address space allows.
uint64_t available_memory_bytes();

}  // namespace rayfarm
