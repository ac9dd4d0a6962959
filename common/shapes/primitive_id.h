#pragma once
// Which primitive: its kind and its index among those of that kind.
#include <cstdint>

#include "common/math/index.h"

namespace rayfarm {

/// A primitive of a part: three bits of kind and its index in the scene's array of that kind. A face is a
/// mesh's polygon of more than three corners. A collection answers rays as primitives do (Shirley, Sung and
/// Brown 1991, section 2.3), but with what they hit in it: no hit's primitive is one.
enum class PrimitiveKind : uint32_t { triangle, sphere, polygon, quadric, face, collection };
struct PrimitiveId {
  uint32_t bits = 0;
  PrimitiveKind kind() const { return static_cast<PrimitiveKind>(bits >> 29); }
  uint32_t index() const { return bits & 0x1fffffffu; }
  bool operator==(const PrimitiveId&) const = default;
};
constexpr PrimitiveId make_primitive_id(PrimitiveKind kind, uint32_t index) {
  return {static_cast<uint32_t>(kind) << 29 | index};
}

inline constexpr PrimitiveId kNoPrimitive{kNone};

}  // namespace rayfarm
