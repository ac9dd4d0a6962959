#include "common/lighting/surface.h"

#include <array>

#include "common/lighting/face_corners.h"

namespace rayfarm {
namespace {

/// What a primitive tells in its object's space.
struct LocalSurface {
  Vec3 geometric_normal{0}, shading_normal{0};  ///< unit
  uint32_t material = 0;
  double magnitude = 0;  ///< of the numbers that describe the primitive
  bool is_gouraud = false;
};

bool is(Smoothing smoothing, uint32_t value) {
  return value == static_cast<uint32_t>(smoothing);
}

double magnitude_of(const std::array<Vec3, 3>& v) {
  return std::max({max_magnitude(v[0]), max_magnitude(v[1]), max_magnitude(v[2])});
}

LocalSurface eval_triangle(const Scene& scene, const Hit& hit, const Vec3& p) {
  const std::array<Vec3, 3> v = triangle_vertices(scene, hit.block_lane);
  const TriangleShading& shading = scene.triangle_shading[hit.primitive.index()];
  LocalSurface s;
  s.geometric_normal = s.shading_normal = normalized(glm::cross(v[1] - v[0], v[2] - v[0]));
  s.material = shading.material;
  s.magnitude = magnitude_of(v);
  if (shading.normals[0] != kNone) {
    const std::array<Vec3, 3> n{Vec3(scene.normals[shading.normals[0]]),
                                Vec3(scene.normals[shading.normals[1]]),
                                Vec3(scene.normals[shading.normals[2]])};
    s.shading_normal = is(Smoothing::center, shading.smoothing) ? center_normal(v, n, p)
                                                                : hit.u * n[0] + hit.v * n[1] + hit.w * n[2];
    s.shading_normal = normalized(s.shading_normal);
    s.is_gouraud = is(Smoothing::gouraud, shading.smoothing);
  }
  return s;
}

/// Sets the shading normal of a polygon that has normals at its corners.
void smooth(uint32_t smoothing, std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& p,
            LocalSurface& s) {
  s.shading_normal =
      normalized(is(Smoothing::center, smoothing) ? center_normal(points, normals, p)
                                                  : phong_normal(points, normals, p, s.geometric_normal));
  s.is_gouraud = is(Smoothing::gouraud, smoothing);
}

LocalSurface eval_polygon(const Scene& scene, const Polygon& polygon, const Hit& hit, const Vec3& p) {
  LocalSurface s;
  s.geometric_normal = s.shading_normal = polygon.normal;
  s.material = polygon.material;
  s.magnitude = std::max(std::abs(polygon.distance), max_magnitude(p));
  // Tested as triangles it has their rounding: of all of them, because a hit on their common edge may be
  // either's.
  if (hit.block_lane != kNone)
    for (const Vec3& q : scene.points_of(polygon)) s.magnitude = std::max(s.magnitude, max_magnitude(q));
  if (polygon.first_normal != kNone)
    smooth(polygon.smoothing, scene.points_of(polygon), scene.normals_of(polygon), p, s);
  return s;
}

/// Which of its triangles was hit makes no difference.
LocalSurface eval_face(const Scene& scene, const MeshFace& face, const Vec3& p) {
  const Gathered<Vec3> points = points_of(scene, face);
  LocalSurface s;
  s.geometric_normal = s.shading_normal = normalized(newell_normal(points.span()));
  s.material = face.material;
  for (const Vec3& q : points.span()) s.magnitude = std::max(s.magnitude, max_magnitude(q));
  if (face.first_normal != kNone) smooth(face.smoothing, points.span(), normals_of(scene, face).span(), p, s);
  return s;
}

LocalSurface eval_local(const Scene& scene, const Hit& hit, const Vec3& p) {
  const uint32_t index = hit.primitive.index();
  switch (hit.primitive.kind()) {
    case PrimitiveKind::triangle:
      return eval_triangle(scene, hit, p);
    case PrimitiveKind::sphere: {
      const SphereRecord& sphere = scene.spheres[index];
      const Vec3 n = normalized(p - sphere.center);
      return {n, n, sphere.material, max_magnitude(sphere.center) + sphere.radius};
    }
    case PrimitiveKind::polygon:
      return eval_polygon(scene, scene.polygons[index], hit, p);
    case PrimitiveKind::face:
      return eval_face(scene, scene.mesh_faces[index], p);
    case PrimitiveKind::quadric: {
      const Quadric& quadric = scene.quadrics[index];
      const Vec3 n = normalized(quadric.gradient(p));
      return {n, n, quadric.material, quadric.bounds.magnitude() + max_magnitude(quadric.bounds.extent())};
    }
    case PrimitiveKind::collection:  // of no hit
      break;
  }
  return {};
}

}  // namespace

std::array<Vec3, 3> triangle_vertices(const Scene& scene, uint32_t block_lane) {
  const auto& vertices = scene.triangle_blocks[block_lane / 8].vertices;
  const size_t lane = block_lane % 8;
  std::array<Vec3, 3> v;
  for (size_t k = 0; k < 3; ++k)
    v[k] = Vec3(vertices[k][0][lane], vertices[k][1][lane], vertices[k][2][lane]);
  return v;
}

double area_scale(const InstancePose& place, const Vec3& n) {
  if (place.is_identity) return 1;
  const Vec3 m = place.object_from_world.normal_by_inverse(n);
  return std::sqrt(glm::dot(m, m)) / std::abs(glm::determinant(place.object_from_world.linear));
}

double magnitude_in_world(const InstancePose& place, double local) {
  const Mat3& m = place.world_from_object.linear;
  const double largest = std::max({max_magnitude(m[0]), max_magnitude(m[1]), max_magnitude(m[2])});
  return std::max(3 * largest * local, max_magnitude(place.world_from_object.translation));
}

Surface eval_surface(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit) {
  const InstancePose& place = pose[hit.instance];
  const Scene& shapes = pose.shape_of(hit.instance, scene);
  Surface surface;
  surface.p = ray.origin + hit.t * ray.direction;
  double magnitude =
      std::max({max_magnitude(surface.p), max_magnitude(ray.origin), hit.t * max_magnitude(ray.direction)});
  LocalSurface local;
  if (place.is_identity) {
    local = eval_local(shapes, hit, surface.p);
    magnitude = std::max(magnitude, local.magnitude);
    surface.geometric_normal = local.geometric_normal;
    surface.shading_normal = local.shading_normal;
  } else {
    local = eval_local(shapes, hit, place.object_from_world.point(surface.p));
    magnitude = std::max(magnitude, magnitude_in_world(place, local.magnitude));
    surface.geometric_normal = normalized(place.object_from_world.normal_by_inverse(local.geometric_normal));
    surface.shading_normal = normalized(place.object_from_world.normal_by_inverse(local.shading_normal));
  }
  surface.offset = rounding_bound(magnitude);
  surface.material = local.material;
  surface.is_gouraud = local.is_gouraud;
  if (glm::dot(surface.shading_normal, surface.geometric_normal) < 0)
    surface.shading_normal = -surface.shading_normal;
  surface.is_front = glm::dot(surface.geometric_normal, ray.direction) < 0;
  if (!surface.is_front) {
    surface.geometric_normal = -surface.geometric_normal;
    surface.shading_normal = -surface.shading_normal;
  }
  return surface;
}

}  // namespace rayfarm
