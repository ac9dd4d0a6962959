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

/// Corners as the viewer sees them that a ray shows of the surface that it met. A corner is the same for all
/// polygons that share it and are seen from the same side: rays leave from beside its own normal.
class Corners {
 public:
  /// Of surface i.
  Corners(const FrameContext& context, const ClassicalSurfaces& of, size_t i)
      : of_(of), i_(i), place_(context.pose[of.hits[i].instance]) {
    surfaces.rays = &rays_;
    surfaces.met = 0;
  }
  Corners(const Corners&) = delete;

  /// There must be room.
  void add(const Vec3& p, const Vec3& normal) {
    Surface s = of_.at[i_];
    s.is_gouraud = false;
    s.p = place_.is_identity ? p : place_.world_from_object.point(p);
    Vec3 n = place_.is_identity ? normal : normalized(place_.object_from_world.normal_by_inverse(normal));
    if (glm::dot(n, s.geometric_normal) < 0) n = -n;
    s.geometric_normal = s.shading_normal = n;
    s.offset = rounding_bound(
        std::max(max_magnitude(s.p),
                 place_.is_identity ? max_magnitude(p) : magnitude_in_world(place_, max_magnitude(p))));
    const size_t k = rays_.size;
    const Vec3 from = of_.rays->origin(i_);
    rays_.push_back(from, normalized(s.p - from));
    surfaces.at.set(k, s);
    surfaces.met |= 1u << k;
    surfaces.begin(k, of_, i_);
  }

  ClassicalSurfaces surfaces;

 private:
  const ClassicalSurfaces& of_;
  size_t i_;
  const InstancePose& place_;
  RayPacket rays_;
};

}  // namespace

void add_gouraud_light(const FrameContext& context, const Highlights& highlights, ClassicalSurfaces& surfaces,
                       size_t i, RayCounts& counts) {
  const Hit& hit = surfaces.hits[i];
  const InstancePose& place = context.pose[hit.instance];
  visit_corners(context.pose.shape_of(hit.instance, context.scene), hit,
                [&](std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& plane_normal) {
                  Gathered<Color> diffuse(points.size()), specular(points.size());
                  for (size_t begin = 0; begin < points.size(); begin += kMostPacketRays) {
                    Corners corners(context, surfaces, i);
                    const size_t end = std::min(points.size(), begin + kMostPacketRays);
                    for (size_t k = begin; k < end; ++k) corners.add(points[k], normals[k]);
                    add_direct_light(context, highlights, corners.surfaces, counts);
                    for (size_t k = begin; k < end; ++k) {
                      diffuse[k] = lane_of(corners.surfaces.diffuse, k - begin);
                      specular[k] = lane_of(corners.surfaces.specular, k - begin);
                    }
                  }
                  const Vec3 seen = lane_of(surfaces.at.p, i);
                  const Vec3 p = place.in_object(seen);
                  const auto at_hit = [&](const Gathered<Color>& light) {
                    // In the corners of concave polygons weights may be negative.
                    return glm::max(mean_value_sum(points, light.span(), p, plane_normal).mean(), Color(0));
                  };
                  set_lane(surfaces.diffuse, i, lane_of(surfaces.diffuse, i) + at_hit(diffuse));
                  surfaces.add_specular(i, at_hit(specular));
                });
}

}  // namespace rayfarm
