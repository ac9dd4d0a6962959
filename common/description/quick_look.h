#pragma once
// What shows a model that comes without a scene: a camera that sees all of it from the front, the right and
// above, ground just below it, a soft lamp on the left and a grey sky. Up is y.
#include "common/description/scene_description.h"

namespace rayfarm {

struct QuickLook {
  Vec3 location{0}, look_at{0};
  double field_of_view = 32;  ///< degrees
  std::array<Vec3, 4> ground{};
  Vec3 lamp{0};  ///< its centre
  double lamp_radius = 1;
  bool is_too_small = false;  ///< the model is a speck in it, or nothing

  static constexpr double kSky = 0.4;       ///< radiance
  static constexpr double kEmission = 9.5;  ///< of the lamp
  /// Classical, so that it has ambient light in the models that know of no other from all sides.
  static constexpr double kAmbient = 0.5;
  static constexpr double kGroundColor = 0.55;
  static constexpr double kModelColor = 0.6;  ///< of a model that has no colours of its own
  static constexpr double kModelDiffuse = 0.94, kModelSpecular = 0.05, kModelShininess = 30;
  static constexpr const char* kLighting = "path";
  static constexpr int kSamples = 32;
};

/// For a model in these bounds, which are not empty.
QuickLook make_quick_look(const Box& bounds);

/// Of a model whose file gives no material; coloured ones are white under their colours.
MaterialDescription quick_look_material(bool is_coloured);

/// Gives the scene of a model what it lacks: the camera where it has no view; ground, lamp, sky and how they
/// are rendered where it has no light. Ground and lamp, in this order, are added to the root's children.
void add_quick_look(SceneDescription& scene, const QuickLook& look);

}  // namespace rayfarm
