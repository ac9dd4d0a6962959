#pragma once
// Who traces rays lets its caller look after other things now and then.
#include <cstdint>

namespace rayfarm {

/// Rays between two calls of a `pulse`: some ten microseconds.
inline constexpr uint64_t kRaysPerPulse = 64;

}  // namespace rayfarm
