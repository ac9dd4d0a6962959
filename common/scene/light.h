#pragma once
// Sources of light: plain data, as the compiled scene holds them.
#include <array>

#include "common/math/index.h"
#include "common/math/vector.h"
#include "common/shapes/primitive_id.h"

namespace rayfarm {

enum class LightKind : uint32_t {
  /// position, color; without falloff, as the thesis has it: color is what a white surface facing it shows
  point,
  bulb,         ///< position, color: radiant intensity, which falls with the square of the distance
  spot,         ///< a bulb that shines about `direction` only
  distant,      ///< direction, color: irradiance / π; from infinitely far
  environment,  ///< the image that is seen behind the scene
  luminaire     ///< a primitive of a luminous material
};

/// Where a source stands.
struct LightPlace {
  Vec3 position{0};
  Vec3 direction{0, -1, 0};  ///< unit; in which the light shines
  Vec3 zero{1, 0, 0};        ///< unit, across `direction`: where a diagram's horizontal angle is 0
  uint32_t is_mirrored = 0;  ///< 1: horizontal angles run the other way round
  uint32_t padding = 0;
};

/// Its place is in the world; that of a source that moves is the one at the scene's first frame, and `Pose`
/// has it for each moment.
struct Light : LightPlace {
  LightKind kind = LightKind::point;
  uint32_t instance = 0;  ///< of a luminaire, as the next three
  PrimitiveId primitive{};
  /// Of a luminous triangle or polygon, in luminaire_triangles.
  uint32_t first_triangle = 0, triangle_count = 0;
  uint32_t material = 0;
  uint32_t diagram = kNone;      ///< of a bulb whose intensity differs by direction
  uint32_t object_node = kNone;  ///< where it stands in the object tree; none: it belongs to the whole scene
  uint32_t moving = kNone;       ///< which of the moving lights it is; none: it never moves
  uint32_t reserved = 0;
  Color color{1};
  /// Of the angles up to which a spot is bright, and from which it is dark.
  double cosine_full = 1, cosine_none = 1;
};

/// A source that moves, as it stands in its object's space.
struct MovingLight {
  LightPlace place;
  uint32_t object_node = 0;
  uint32_t light = 0;
};

/// Of a luminous triangle or polygon as rays meet it, in its object's space.
struct LuminaireTriangle {
  std::array<Vec3, 3> corners{};
  Vec3 normal{0};           ///< unit
  double area_through = 0;  ///< of this triangle and the luminaire's before it
  double magnitude = 0;     ///< of the luminaire's coordinates
};

}  // namespace rayfarm
