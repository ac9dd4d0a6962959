#pragma once
// The compiled scene: flat arrays inside one contiguous, relocatable block of bytes, traversed in place by
// every node of a machine. Indices, never pointers. A Scene is a view: it owns nothing and is cheap to copy.
#include <array>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "common/materials/material.h"
#include "common/materials/principled.h"
#include "common/math/affine.h"
#include "common/memory/large_vector.h"
#include "common/scene/animation.h"
#include "common/scene/deformation.h"
#include "common/scene/goniometry.h"
#include "common/scene/hierarchy_records.h"
#include "common/scene/light.h"
#include "common/scene/participating_medium.h"
#include "common/scene/projection.h"
#include "common/scene/spectral_color.h"
#include "common/shapes/polygon.h"
#include "common/shapes/quadric.h"
#include "common/shapes/sphere.h"
#include "common/textures/texture.h"

namespace rayfarm {

struct TriangleShading {
  uint32_t material = 0;
  uint32_t smoothing = 0;  ///< enum Smoothing
  std::array<uint32_t, 3> normals{kNone, kNone, kNone};
};

/// A mesh's polygon of more than three corners. It is planar, and tested as the triangles that it is cut
/// into; corners and normals are shared with its neighbours.
/// Stands for the coordinates (u, v) of a mesh without any, where others of the scene have some.
inline constexpr glm::vec2 kNoUv{std::numeric_limits<float>::quiet_NaN()};

struct MeshFace {
  uint32_t first_corner = 0;  ///< in face_corners
  uint32_t corner_count = 0;
  uint32_t first_normal = kNone;  ///< in face_normals; none: flat
  uint32_t smoothing = 0;         ///< enum Smoothing
  uint32_t material = 0;
};

struct CurveRecord {
  uint32_t interpolation = 0;
  uint32_t first_key = 0;  ///< in key_frames
  uint32_t key_count = 0;
  uint32_t first_value = 0;  ///< in key_values
  size_t value_count() const { return key_count * values_per_key(static_cast<Interpolation>(interpolation)); }
};

struct TransformStepRecord {
  uint32_t kind = 0;
  uint32_t curve = 0;
  Vec3 axis{0};
  Affine matrix;
};

/// A node of the object tree, expanded to a tree (thesis 4.3.2: graphs would cost a matrix product per
/// visit). A parent stands before its children.
struct ObjectNode {
  uint32_t parent = kNone;
  uint32_t first_step = 0, step_count = 0;
  uint32_t visible = kNone;  ///< a curve: 0 in frames from which the node and all below it are left out
};

/// Primitives in one space, and what finds those that a ray meets.
struct Collection {
  Box bounds;
  Structure structure = Structure::volumes;
  uint32_t grid = kNone;     ///< of a regular one
  uint32_t octree = kNone;   ///< of an adaptive one
  uint32_t has_mailbox = 0;  ///< 1: what rays were tested with in a cell is not tested in others
  uint32_t tree = kNone;     ///< of bounding volumes, of one by objects
  uint32_t octants = kNone;  ///< the octant tree of one in octants
  ChildRef root;             ///< of volumes; those of a list are one node at most
  // Its own primitives; those of a collection in it are not among them.
  uint32_t first_triangle_block = 0, triangle_block_count = 0;
  uint32_t first_sphere_block = 0, sphere_block_count = 0;
  uint32_t first_leaf_primitive = 0, leaf_primitive_count = 0;
};

/// Primitives that never move against each other, and the hierarchy below them (thesis 4.2.1.1).
struct Part {
  Collection collection;
  // All its primitives, those of collections in its collection too.
  uint32_t first_triangle_block = 0, triangle_block_count = 0;
  uint32_t first_sphere_block = 0, sphere_block_count = 0;
  uint32_t first_leaf_primitive = 0, leaf_primitive_count = 0;
  uint32_t triangle_count = 0, sphere_count = 0, quadric_count = 0;
  uint32_t polygon_count = 0;  ///< of more than three corners, meshes' too
  size_t primitive_count() const {
    return size_t{triangle_count} + sphere_count + quadric_count + polygon_count;
  }
};

/// A part at its place in the world.
struct Instance {
  uint32_t object_node = 0;
  uint32_t part = 0;
  uint32_t moving = kNone;  ///< which of those that move, or come and go, it is; kNone: it never does
};

/// Where an instance stands in one frame.
struct InstancePose {
  Affine world_from_object;
  Affine object_from_world;
  Box bounds;  ///< in the world
  uint32_t is_identity = 0;
  uint16_t is_hidden = 0;    ///< 1: the frame is without it
  uint16_t is_deformed = 0;  ///< 1: its part is what the frame makes of it, Pose::shapes

  /// Of a point of the world.
  Vec3 in_object(const Vec3& p_world) const {
    return is_identity ? p_world : object_from_world.point(p_world);
  }
};

struct ViewRecord {
  uint32_t location = 0, direction = 0, look_at = kNone, up = 0, field_of_view = 0, focus = 0;  ///< curves
  uint32_t width = 0;  ///< a curve: of an orthographic view, in the world
  Projection projection = Projection::perspective;
  double aspect = 1;
  double lens_radius = 0;
  std::array<double, 2> shift{0, 0};  ///< of the picture to the right and up, in widths of the view
  double near = 0, far = std::numeric_limits<double>::infinity();  ///< nothing is seen but between these
};

/// What there is one of.
struct SceneHeader {
  ViewRecord view;
  Color background{0};  ///< times the environment's image, if there is one
  Color ambient{1};
  ChildRef fixed_root;   ///< of the object part's boxes over instances that never move, in fixed_nodes
  ChildRef moving_root;  ///< over those that move, in moving_nodes
  uint32_t first_luminaire = 0;
  uint32_t environment = kNone;  ///< the texture that is seen behind the scene
  /// Of bounding volumes over the instances that never move, in place of the boxes of fixed_root; kNone: none
  uint32_t object_tree = kNone;
  uint32_t has_last_hit = 0;  ///< 1: rays are first tested with what the last one hit
  uint32_t has_holes = 0;     ///< 1: a material is pierced
  uint32_t padding = 0;
  double ray_coherence =
      0;  ///< the half angle of the cones for which candidates are listed, in radians; 0: none
  double environment_turn = 0;  ///< about y, in whole turns
  Mat3 channels_from_rgb{1};  ///< of the colour pass; for what is only known while rays are traced: textures
  double far_away = 1;        ///< a distance that leads out of the scene from anywhere in it
};

/// Every array of the block, as `Array<element>`: a view's spans, or vectors while a scene is compiled.
template <template <typename> typename Array>
struct SceneArrays {
#define RAYFARM_ARRAY(element, name, role) Array<element> name;
#include "common/scene/scene_arrays.inc"
#undef RAYFARM_ARRAY
};

template <typename T>
using ArrayView = std::span<const T>;
template <typename T>
using GrowingArray = LargeVector<T>;

struct RayLog;
struct TracingState;

/// A view of the block.
struct Scene : SceneArrays<ArrayView> {
  RayLog* ray_log = nullptr;  ///< where rays are written down as they are traced; seldom anywhere
  /// What this process makes of the scene as rays are traced, the same for all copies; null where nothing is.
  std::shared_ptr<TracingState> tracing;

  const SceneHeader& head() const { return header.front(); }
  std::span<const Vec3> points_of(const Polygon& p) const {
    return polygon_points.subspan(p.first_point, p.point_count);
  }
  std::span<const Vec3> normals_of(const Polygon& p) const {
    return polygon_normals.subspan(p.first_normal, p.point_count);
  }
  std::span<const Vec4> planes_of(const Quadric& q) const {
    return quadric_planes.subspan(q.first_plane, q.plane_count);
  }
  std::span<const SpectrumNode> spectrum_of(const SpectralColor& c) const {
    return spectrum_nodes.subspan(c.first_node, c.node_count);
  }
  /// The deltas and joints of a vertex that changes its place.
  std::span<const MorphDelta> deltas_of(uint32_t vertex) const {
    const uint32_t first = deforming_vertices[vertex].first_delta;
    return morph_deltas.subspan(first, deforming_vertices[vertex + 1].first_delta - first);
  }
  std::span<const JointWeight> joints_of(uint32_t vertex) const {
    const uint32_t first = deforming_vertices[vertex].first_influence;
    return joint_weights.subspan(first, deforming_vertices[vertex + 1].first_influence - first);
  }
  Vec4 eval(uint32_t curve, double frame) const;
  /// A transform of several steps.
  Affine eval_steps(uint32_t first, uint32_t count, double frame) const;
  /// Of object nodes or bones, which stand behind their parents: what leads from each to the root's space.
  template <typename Node>
  std::vector<Affine> transforms_to_root(std::span<const Node> chain, double frame) const {
    std::vector<Affine> all(chain.size());
    for (size_t i = 0; i < all.size(); ++i) {
      const Affine local = eval_steps(chain[i].first_step, chain[i].step_count, frame);
      all[i] = chain[i].parent == kNone ? local : all[chain[i].parent] * local;
    }
    return all;
  }
};

/// Calls visit(name, array) for every array in the block's order.
template <typename Arrays, typename Visitor>
void for_each_array(Arrays& arrays, Visitor visit) {
#define RAYFARM_ARRAY(element, name, role) visit(#name, arrays.name);
#include "common/scene/scene_arrays.inc"
#undef RAYFARM_ARRAY
}

/// Valid until an array grows.
inline Scene view_of(const SceneArrays<GrowingArray>& arrays) {
  Scene scene;
#define RAYFARM_ARRAY(element, name, role) scene.name = arrays.name;
#include "common/scene/scene_arrays.inc"
#undef RAYFARM_ARRAY
  return scene;
}

}  // namespace rayfarm
