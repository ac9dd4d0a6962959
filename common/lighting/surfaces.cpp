#include "common/lighting/surfaces.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/lighting/surfaces.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/math/lanes-inl.h"

#ifndef RAYFARM_COMMON_LIGHTING_SURFACES_CPP_
#define RAYFARM_COMMON_LIGHTING_SURFACES_CPP_
namespace rayfarm {

/// What is read from the scene, ray by ray, before all rays go on at once.
struct SurfaceInputs {
  SurfaceInputs() {}
  alignas(64) VectorLanes vertices[3];  ///< of triangles
  alignas(64) VectorLanes normals[3];   ///< of smooth triangles
  alignas(64) VectorLanes normal;       ///< of flat polygons; of spheres the centre
  alignas(64) double t[kMostPacketRays];
  alignas(64) double weights[3][kMostPacketRays];
  /// The largest of the numbers that describe the primitive, as far as they are read ray by ray.
  alignas(64) double magnitude[kMostPacketRays];
  alignas(64) VectorLanes object_from_world[4];            ///< of moved instances: its columns
  alignas(64) double three_times_matrix[kMostPacketRays];  ///< three times the largest of world_from_object's
                                                           ///< matrix
  alignas(64) double translation[kMostPacketRays];         ///< the largest magnitude of its translation
  uint32_t triangles = 0, smooth = 0, spheres = 0, polygons = 0;  ///< bits of the rays
  uint32_t moved = 0;                                             ///< by an instance
};

}  // namespace rayfarm
#endif

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The lanes of a vector: those of a packet from `first` on.
struct SomeLanes {
  size_t first;
  bool any(uint32_t bits) const { return lanes_from(bits, first) != 0; }
  HWY_INLINE Truth operator()(uint32_t bits) const { return truth_of(lanes_from(bits, first)); }
  HWY_INLINE Real load(const double* lanes) const { return hn::Load(RealTag(), lanes + first); }
  HWY_INLINE Real3 load(const VectorLanes& axes) const { return load3(axes, first); }
  HWY_INLINE Real3 normalized(const Real3& v, Truth wanted) const {
    return HWY_NAMESPACE::normalized(select(wanted, v, all(real(1))));  // others may hold anything
  }
};

struct LocalSurfaceLanes {
  Real3 geometric_normal, shading_normal;
  Real magnitude;
};

/// What primitives tell in their objects' space.
HWY_INLINE void eval_local(const SurfaceInputs& in, const Real3& p, const SomeLanes& lanes,
                           LocalSurfaceLanes& s) {
  s.magnitude = lanes.load(in.magnitude);
  s.geometric_normal = lanes.load(in.normal);
  const Truth is_polygon = lanes(in.polygons);
  if (lanes.any(in.polygons))
    s.magnitude = select(is_polygon, hn::Max(s.magnitude, max_magnitude(p)), s.magnitude);
  if (lanes.any(in.triangles | in.spheres)) {
    Real3 n = p - s.geometric_normal;  // of spheres
    if (lanes.any(in.triangles)) {
      const Real3 a = lanes.load(in.vertices[0]), b = lanes.load(in.vertices[1]),
                  c = lanes.load(in.vertices[2]);
      const Truth is_triangle = lanes(in.triangles);
      n = select(is_triangle, cross(b - a, c - a), n);
      s.magnitude = select(
          is_triangle, hn::Max(max_magnitude(a), hn::Max(max_magnitude(b), max_magnitude(c))), s.magnitude);
    }
    n = lanes.normalized(n, lanes(in.triangles | in.spheres));
    s.geometric_normal = select(is_polygon, s.geometric_normal, n);
  }
  s.shading_normal = s.geometric_normal;
  if (lanes.any(in.smooth)) {
    const Truth is_smooth = lanes(in.smooth);
    const Real3 n = lanes.load(in.weights[0]) * lanes.load(in.normals[0]) +
                    lanes.load(in.weights[1]) * lanes.load(in.normals[1]) +
                    lanes.load(in.weights[2]) * lanes.load(in.normals[2]);
    s.shading_normal = select(is_smooth, lanes.normalized(n, is_smooth), s.shading_normal);
  }
}

HWY_INLINE void eval_in_world(const SurfaceInputs& in, const Real3& p, const SomeLanes& lanes,
                              LocalSurfaceLanes& s) {
  if (!lanes.any(in.moved)) return eval_local(in, p, lanes, s);
  const Truth is_moved = lanes(in.moved);
  const Real3 x = lanes.load(in.object_from_world[0]), y = lanes.load(in.object_from_world[1]),
              z = lanes.load(in.object_from_world[2]), translation = lanes.load(in.object_from_world[3]);
  eval_local(in, select(is_moved, p.x * x + p.y * y + p.z * z + translation, p), lanes, s);
  const auto turned = [&](const Real3& n) HWY_ATTR {
    return select(is_moved, lanes.normalized({dot(x, n), dot(y, n), dot(z, n)}, is_moved), n);
  };
  s.geometric_normal = turned(s.geometric_normal);
  s.shading_normal = turned(s.shading_normal);
  s.magnitude =
      select(is_moved, hn::Max(lanes.load(in.three_times_matrix) * s.magnitude, lanes.load(in.translation)),
             s.magnitude);
}

void finish_surfaces(const SurfaceInputs& in, const RayPacket& rays, Surfaces& out) {
  for (SomeLanes lanes{0}; lanes.first < kMostPacketRays; lanes.first += kLanes) {
    const Real3 origin = lanes.load(rays.origins), direction = lanes.load(rays.directions);
    const Real t = lanes.load(in.t);
    const Real3 p = origin + t * direction;
    LocalSurfaceLanes s;
    eval_in_world(in, p, lanes, s);
    const Real of_ray =
        hn::Max(max_magnitude(p), hn::Max(max_magnitude(origin), t * max_magnitude(direction)));
    const Truth is_behind = hn::Lt(dot(s.shading_normal, s.geometric_normal), hn::Zero(RealTag()));
    const Truth is_front = hn::Lt(dot(s.geometric_normal, direction), hn::Zero(RealTag()));
    const Real3 shading = select(is_behind, -s.shading_normal, s.shading_normal);
    store3(p, out.p, lanes.first);
    store3(select(is_front, s.geometric_normal, -s.geometric_normal), out.geometric_normal, lanes.first);
    store3(select(is_front, shading, -shading), out.shading_normal, lanes.first);
    hn::Store(real(rounding_bound(1)) * hn::Max(of_ray, s.magnitude), RealTag(), out.offset + lanes.first);
    out.front |= bits_of(is_front) << lanes.first;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(finish_surfaces);

namespace {

/// The largest number of a polygon's plane and, where it was tested as triangles, of all of its corners.
double polygon_magnitude(const Scene& scene, const Polygon& polygon, const Hit& hit) {
  double largest = std::abs(polygon.distance);
  if (hit.block_lane != kNone)
    for (const Vec3& q : scene.points_of(polygon)) largest = std::max(largest, max_magnitude(q));
  return largest;
}

/// False: it is none of those that go on at once. `before`: the hit of the ray before, or none.
bool read_primitive(const Scene& scene, const Hit& hit, const Hit* before, size_t i, SurfaceInputs& in,
                    Surfaces& out) {
  const uint32_t index = hit.primitive.index(), bit = 1u << i;
  switch (hit.primitive.kind()) {
    case PrimitiveKind::triangle: {
      const TriangleShading& shading = scene.triangle_shading[index];
      if (shading.normals[0] != kNone) {
        if (shading.smoothing == static_cast<uint32_t>(Smoothing::center)) return false;
        for (size_t k = 0; k < 3; ++k) set_lane(in.normals[k], i, Vec3(scene.normals[shading.normals[k]]));
        in.weights[0][i] = hit.u;
        in.weights[1][i] = hit.v;
        in.weights[2][i] = hit.w;
        in.smooth |= bit;
        if (shading.smoothing == static_cast<uint32_t>(Smoothing::gouraud)) out.gouraud |= bit;
      }
      const auto& vertices = scene.triangle_blocks[hit.block_lane / 8].vertices;
      for (size_t k = 0; k < 3; ++k)
        for (size_t axis = 0; axis < 3; ++axis)
          in.vertices[k][axis][i] = double{vertices[k][axis][hit.block_lane % 8]};
      in.triangles |= bit;
      out.material[i] = shading.material;
      return true;
    }
    case PrimitiveKind::sphere: {
      const SphereRecord& sphere = scene.spheres[index];
      set_lane(in.normal, i, sphere.center);
      in.magnitude[i] = max_magnitude(sphere.center) + sphere.radius;
      in.spheres |= bit;
      out.material[i] = sphere.material;
      return true;
    }
    case PrimitiveKind::polygon: {
      const Polygon& polygon = scene.polygons[index];
      if (polygon.first_normal != kNone) return false;
      set_lane(in.normal, i, polygon.normal);
      const bool is_known = before && before->primitive == hit.primitive;
      in.magnitude[i] = is_known ? in.magnitude[i - 1] : polygon_magnitude(scene, polygon, hit);
      in.polygons |= bit;
      out.material[i] = polygon.material;
      return true;
    }
    case PrimitiveKind::face:
    case PrimitiveKind::quadric:
    case PrimitiveKind::collection:  // of no hit
      return false;
  }
  return false;
}

void read_place(const InstancePose& place, size_t i, SurfaceInputs& in) {
  in.moved |= 1u << i;
  for (int column = 0; column < 3; ++column)
    set_lane(in.object_from_world[column], i, place.object_from_world.linear[column]);
  set_lane(in.object_from_world[3], i, place.object_from_world.translation);
  const Mat3& m = place.world_from_object.linear;
  in.three_times_matrix[i] = 3 * std::max({max_magnitude(m[0]), max_magnitude(m[1]), max_magnitude(m[2])});
  in.translation[i] = max_magnitude(place.world_from_object.translation);
}

}  // namespace

uint32_t eval_surfaces(const Scene& scene, const Pose& pose, const RayPacket& rays, const Hit* hits,
                       Surfaces& surfaces) {
  SurfaceInputs in;
  surfaces.front = surfaces.gouraud = 0;
  uint32_t met = 0, others = 0;
  for (size_t i = 0; i < rays.size; ++i) {
    if (!hits[i].is_hit()) continue;
    met |= 1u << i;
    if (!read_primitive(pose.shape_of(hits[i].instance, scene), hits[i], i > 0 ? &hits[i - 1] : nullptr, i,
                        in, surfaces)) {
      others |= 1u << i;
      continue;
    }
    in.t[i] = hits[i].t;
    const InstancePose& place = pose[hits[i].instance];
    if (!place.is_identity) read_place(place, i, in);
  }
  if (met != others) HWY_DYNAMIC_DISPATCH(finish_surfaces)(in, rays, surfaces);
  for_each_lane(others, [&](size_t i) { surfaces.set(i, eval_surface(scene, pose, rays[i], hits[i])); });
  surfaces.front &= met;
  return met;
}

}  // namespace rayfarm
#endif
