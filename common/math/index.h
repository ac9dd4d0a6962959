#pragma once
// Indices into the scene's arrays.
#include <cstdint>

namespace rayfarm {

/// In place of an index: there is none.
inline constexpr uint32_t kNone = ~0u;

}  // namespace rayfarm
