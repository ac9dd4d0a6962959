#pragma once
// Which primitive: its kind and its index among those of that kind.
#include <cstdint>

#include "common/math/index.h"

namespace rayfarm {

/// A primitive of a part: two bits of kind and its index in the scene's array of that kind.
enum class PrimitiveKind : uint32_t { triangle, sphere, polygon, quadric };
struct PrimitiveId {
  uint32_t bits = 0;
  PrimitiveKind kind() const { return static_cast<PrimitiveKind>(bits >> 30); }
  uint32_t index() const { return bits & 0x3fffffffu; }
  bool operator==(const PrimitiveId&) const = default;
};
constexpr PrimitiveId make_primitive_id(PrimitiveKind kind, uint32_t index) {
  return {static_cast<uint32_t>(kind) << 30 | index};
}

inline constexpr PrimitiveId kNoPrimitive{kNone};

}  // namespace rayfarm
