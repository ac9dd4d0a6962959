#pragma once
// The compiled scene: flat arrays inside one contiguous, relocatable block of bytes, traversed in place by
// every node of a machine. Indices, never pointers. A Scene is a view: it owns nothing and is cheap to copy.
#include <array>
#include <span>

#include "common/materials/material.h"
#include "common/math/affine.h"
#include "common/scene/goniometry.h"
#include "common/scene/hierarchy_records.h"
#include "common/scene/light.h"
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

struct CurveRecord {
  uint32_t interpolation = 0;
  uint32_t first_key = 0;
  uint32_t key_count = 0;
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
};

/// Primitives that never move against each other, and the volume hierarchy below them (thesis 4.2.1.1).
struct Part {
  Box bounds;
  ChildRef root;
  uint32_t first_triangle_block = 0, triangle_block_count = 0;
  uint32_t first_sphere_block = 0, sphere_block_count = 0;
  uint32_t first_leaf_primitive = 0, leaf_primitive_count = 0;
  uint32_t triangle_count = 0, sphere_count = 0, polygon_count = 0, quadric_count = 0;
};

/// A part at its place in the world.
struct Instance {
  uint32_t object_node = 0;
  uint32_t part = 0;
};

/// Where an instance stands in one frame.
struct InstancePose {
  Affine world_from_object;
  Affine object_from_world;
  Box bounds;  ///< in the world
  uint32_t is_identity = 0;
  uint32_t padding = 0;
};

struct ViewRecord {
  uint32_t location = 0, direction = 0, look_at = kNone, up = 0, field_of_view = 0, focus = 0;  ///< curves
  double aspect = 1;
  double lens_radius = 0;
};

/// What there is one of.
struct SceneHeader {
  ViewRecord view;
  Color background{0};  ///< times the environment's image, if there is one
  Color ambient{1};
  ChildRef object_root;      ///< of the object part's boxes, in object_part_nodes
  uint32_t is_animated = 0;  ///< 1 if any object moves: poses are then set per frame
  uint32_t first_luminaire = 0;
  uint32_t environment = kNone;  ///< the texture that is seen behind the scene
  uint32_t padding = 0;
  double environment_turn = 0;  ///< about y, in whole turns
  Mat3 channels_from_rgb{1};  ///< of the colour pass; for what is only known while rays are traced: textures
  double far_away = 1;        ///< a distance that leads out of the scene from anywhere in it
};

/// Every array of the block. The order here is the order in the block.
struct Scene {
  std::span<const SceneHeader> header;  ///< one element
  std::span<const VolumeNode> nodes;
  std::span<const TriangleBlock> triangle_blocks;
  std::span<const SphereBlock> sphere_blocks;
  std::span<const PrimitiveId> leaf_primitives;
  std::span<const SphereRecord> spheres;
  std::span<const Polygon> polygons;
  std::span<const Vec3> polygon_points;
  std::span<const Vec3> polygon_normals;
  std::span<const Quadric> quadrics;
  std::span<const Vec4> quadric_planes;
  std::span<const TriangleShading> triangle_shading;
  std::span<const glm::vec3> normals;
  std::span<const glm::vec2> triangle_uvs;  ///< three for each triangle, or none at all
  std::span<const Texture> textures;
  std::span<const uint16_t> texels;  ///< of all images: three halves each
  std::span<const Material> materials;
  std::span<const Light> lights;  ///< luminaires last, by (instance, primitive); before them the environment
  std::span<const GoniometricDiagram> goniometric_diagrams;
  std::span<const double> goniometric_values;
  std::span<const double> environment_shares;  ///< by which texels of the environment are chosen
  std::span<const double> light_shares;        ///< cumulative: with which lights are chosen
  std::span<const LuminaireTriangle> luminaire_triangles;
  std::span<const CurveRecord> curves;
  std::span<const double> key_frames;
  std::span<const Vec4> key_values;
  std::span<const TransformStepRecord> steps;
  std::span<const ObjectNode> object_nodes;
  std::span<const Part> parts;
  std::span<const Instance> instances;
  std::span<const uint32_t> leaf_instances;
  std::span<const VolumeNode> object_part_nodes;  ///< at the first frame's poses
  std::span<const InstancePose> poses;            ///< at the first frame

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
  Vec4 eval(uint32_t curve, double frame) const;
};

/// Calls visitor(name, span) for every array in the block's order.
template <typename SceneType, typename Visitor>
void for_each_array(SceneType& s, Visitor visit) {
  visit("header", s.header);
  visit("nodes", s.nodes);
  visit("triangle_blocks", s.triangle_blocks);
  visit("sphere_blocks", s.sphere_blocks);
  visit("leaf_primitives", s.leaf_primitives);
  visit("spheres", s.spheres);
  visit("polygons", s.polygons);
  visit("polygon_points", s.polygon_points);
  visit("polygon_normals", s.polygon_normals);
  visit("quadrics", s.quadrics);
  visit("quadric_planes", s.quadric_planes);
  visit("triangle_shading", s.triangle_shading);
  visit("normals", s.normals);
  visit("triangle_uvs", s.triangle_uvs);
  visit("textures", s.textures);
  visit("texels", s.texels);
  visit("materials", s.materials);
  visit("lights", s.lights);
  visit("goniometric_diagrams", s.goniometric_diagrams);
  visit("goniometric_values", s.goniometric_values);
  visit("environment_shares", s.environment_shares);
  visit("light_shares", s.light_shares);
  visit("luminaire_triangles", s.luminaire_triangles);
  visit("curves", s.curves);
  visit("key_frames", s.key_frames);
  visit("key_values", s.key_values);
  visit("steps", s.steps);
  visit("object_nodes", s.object_nodes);
  visit("parts", s.parts);
  visit("instances", s.instances);
  visit("leaf_instances", s.leaf_instances);
  visit("object_part_nodes", s.object_part_nodes);
  visit("poses", s.poses);
}

}  // namespace rayfarm
