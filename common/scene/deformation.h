#pragma once
// Parts that change their shape from frame to frame, by morph targets and skins: what their vertices are made
// of. They come first in the scene: their records are the first of the arrays that a frame makes anew (parts,
// nodes, triangle_blocks, normals), so that what a node holds of them for a frame has the indices that the
// block has.
#include <cstdint>
#include <glm/glm.hpp>

#include "common/math/affine.h"
#include "common/math/index.h"

namespace rayfarm {

/// One of the spaces that skins hang on. A parent stands before its children.
struct Bone {
  uint32_t parent = kNone;
  uint32_t first_step = 0, step_count = 0;
};

/// A bone as a skin knows it.
struct Joint {
  Affine bone_from_mesh;  ///< at rest
  uint32_t bone = 0;
  uint32_t padding = 0;
};

struct JointWeight {
  uint32_t joint = 0;
  float weight = 0;  ///< 0 or more; a vertex's are divided by their sum
};

/// What a morph target adds to a vertex, times its weight.
struct MorphDelta {
  uint32_t target = 0;  ///< in morph_weights
  glm::vec3 position{0}, normal{0};
};

/// A vertex at rest. The ranges that begin with it end where the next vertex's begin; one more stands behind
/// the last.
struct DeformingVertex {
  glm::vec3 position{0}, normal{0};
  uint32_t first_delta = 0;      ///< in morph_deltas
  uint32_t first_influence = 0;  ///< in joint_weights; without any it has no skin
};

/// By part. Its triangles are a range of triangle_shading as well as of deforming_triangles.
struct DeformingPart {
  uint32_t first_triangle = 0, triangle_count = 0;
  uint32_t first_node = 0, node_count = 0;
  double cost =
      0;  ///< of its volumes as built: nodes and blocks that a random ray through their bounds meets
};

}  // namespace rayfarm
