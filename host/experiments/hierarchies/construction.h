#pragma once
// What moving objects cost between frames (thesis, Table 4.6 and Equation 4.2).
#include "common/description/scene_description.h"

namespace rayfarm {

/// Of a copy of a scene in which every object moves.
struct UpdateTime {
  size_t nodes = 0;       ///< of the object tree, N_O
  size_t links = 0;       ///< from object nodes to children
  double matrices_s = 0;  ///< N_O · T_M: composing and inverting transforms
  double whole_s = 0;     ///< with the boxes over the objects
};

/// The median of many frames.
UpdateTime measure_update(SceneDescription scene);

}  // namespace rayfarm
