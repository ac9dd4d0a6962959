#include "common/lighting/integrators/gouraud.h"

#include "common/lighting/face_corners.h"

namespace rayfarm {
namespace {

/// Calls visit(points, normals, plane's normal) with a smooth polygon's corners in its object's space.
template <typename Visitor>
void visit_corners(const Scene& scene, const Hit& hit, Visitor visit) {
  const uint32_t index = hit.primitive.index();
  if (hit.primitive.kind() == PrimitiveKind::polygon) {
    const Polygon& polygon = scene.polygons[index];
    visit(scene.points_of(polygon), scene.normals_of(polygon), polygon.normal);
  } else if (hit.primitive.kind() == PrimitiveKind::face) {
    const MeshFace& face = scene.mesh_faces[index];
    const Gathered<Vec3> points = points_of(scene, face), normals = normals_of(scene, face);
    visit(points.span(), normals.span(), normalized(newell_normal(points.span())));
  } else {
    const std::array<Vec3, 3> points = triangle_vertices(scene, hit.block_lane);
    std::array<Vec3, 3> normals;
    for (size_t k = 0; k < 3; ++k) normals[k] = scene.normals[scene.triangle_shading[index].normals[k]];
    visit(std::span<const Vec3>(points), std::span<const Vec3>(normals), normalized(newell_normal(points)));
  }
}

/// What the viewer sees of a corner. It is the same for all polygons that share the corner and are seen from
/// the same side: rays leave from beside its own normal.
ClassicalSurface surface_at_corner(const ClassicalSurface& hit, const InstancePose& place, const Vec3& p,
                                   const Vec3& normal) {
  ClassicalSurface corner = hit;
  Surface& s = corner.surface;
  s.is_gouraud = false;
  s.p = place.is_identity ? p : place.world_from_object.point(p);
  Vec3 n = place.is_identity ? normal : normalized(place.object_from_world.normal_by_inverse(normal));
  if (glm::dot(n, s.geometric_normal) < 0) n = -n;
  s.geometric_normal = s.shading_normal = n;
  s.offset = rounding_bound(std::max(max_magnitude(s.p), place.is_identity
                                                             ? max_magnitude(p)
                                                             : magnitude_in_world(place, max_magnitude(p))));
  corner.direction = normalized(s.p - hit.ray_origin);
  corner.diffuse = corner.specular = Color(0);
  return corner;
}

}  // namespace

void add_gouraud_light(const FrameContext& context, const Highlights& highlights, ClassicalSurface& surface,
                       RayCounts& counts) {
  const InstancePose& place = context.pose[surface.hit->instance];
  visit_corners(context.scene, *surface.hit,
                [&](std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& plane_normal) {
                  Gathered<Color> diffuse(points.size()), specular(points.size());
                  for (size_t begin = 0; begin < points.size(); begin += kMostPacketRays) {
                    OfPacket<ClassicalSurface> corners;
                    const size_t end = std::min(points.size(), begin + kMostPacketRays);
                    for (size_t i = begin; i < end; ++i)
                      corners.push_back(surface_at_corner(surface, place, points[i], normals[i]));
                    add_direct_light(context, highlights, corners.span(), counts);
                    for (size_t i = begin; i < end; ++i) {
                      diffuse[i] = corners[i - begin].diffuse;
                      specular[i] = corners[i - begin].specular;
                    }
                  }
                  const Vec3 p = place.is_identity ? surface.surface.p
                                                   : place.object_from_world.point(surface.surface.p);
                  const auto at_hit = [&](const Gathered<Color>& light) {
                    // In the corners of concave polygons weights may be negative.
                    return glm::max(mean_value_sum(points, light.span(), p, plane_normal).mean(), Color(0));
                  };
                  surface.diffuse += at_hit(diffuse);
                  surface.specular += at_hit(specular);
                });
}

}  // namespace rayfarm
