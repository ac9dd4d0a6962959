#include "common/lighting/small_objects.h"

#include <tuple>

namespace rayfarm {
namespace {

class Finder {
 public:
  Finder(const Scene& scene, const Camera& camera, const PixelRect& crop)
      : scene_(scene), camera_(camera), crop_(crop) {}

  void add_part(const Part& part, const InstancePose& place) {
    for (const SphereBlock& block :
         scene_.sphere_blocks.subspan(part.first_sphere_block, part.sphere_block_count))
      for (const uint32_t i : block.spheres)
        if (i != kNone) add(place, scene_.spheres[i].center, scene_.spheres[i].radius);
    for (const TriangleBlock& block :
         scene_.triangle_blocks.subspan(part.first_triangle_block, part.triangle_block_count))
      for (const PrimitiveId id : block.primitives) add_primitive(place, id);
    for (const PrimitiveId id :
         scene_.leaf_primitives.subspan(part.first_leaf_primitive, part.leaf_primitive_count))
      add_primitive(place, id);
  }

  std::vector<SmallObject> take() {
    const auto key = [](const SmallObject& o) { return std::tuple(o.y, o.x, o.center.x, o.center.y); };
    std::sort(found_.begin(), found_.end(),
              [&](const SmallObject& a, const SmallObject& b) { return key(a) < key(b); });
    // A polygon stands in the blocks once for each of its triangles.
    found_.erase(std::unique(found_.begin(), found_.end(),
                             [&](const SmallObject& a, const SmallObject& b) { return key(a) == key(b); }),
                 found_.end());
    return std::move(found_);
  }

 private:
  void add_primitive(const InstancePose& place, PrimitiveId id) {
    if (id == kNoPrimitive) return;
    if (id.kind() == PrimitiveKind::polygon) {
      const auto points = scene_.points_of(scene_.polygons[id.index()]);
      Vec3 center(0);
      for (const Vec3& p : points) center += p / static_cast<double>(points.size());
      double radius = 0;
      for (const Vec3& p : points) radius = std::max(radius, glm::length(p - center));
      add(place, center, radius);
    } else if (id.kind() == PrimitiveKind::quadric) {
      const Box& box = scene_.quadrics[id.index()].bounds;
      add(place, box.center(), 0.5 * glm::length(box.extent()));
    }
  }

  void add(const InstancePose& place, const Vec3& center, double radius) {
    const Mat3& m = place.world_from_object.linear;
    const double scale =
        std::sqrt(max_component({glm::dot(m[0], m[0]), glm::dot(m[1], m[1]), glm::dot(m[2], m[2])}));
    const auto seen = camera_.project(place.is_identity ? center : place.world_from_object.point(center));
    if (!seen) return;
    const double radius_px = (place.is_identity ? radius : scale * radius) * seen->px_per_length;
    if (!(radius_px < 0.5)) return;
    const Vec2 low = glm::floor(seen->raster - radius_px), high = glm::floor(seen->raster + radius_px);
    if (!(high.x >= crop_.x0 && low.x < crop_.x1 && high.y >= crop_.y0 && low.y < crop_.y1)) return;
    for (int y = std::max(crop_.y0, static_cast<int>(low.y));
         y <= std::min(crop_.y1 - 1, static_cast<int>(high.y)); ++y)
      for (int x = std::max(crop_.x0, static_cast<int>(low.x));
           x <= std::min(crop_.x1 - 1, static_cast<int>(high.x)); ++x)
        found_.push_back({x, y, seen->raster});
  }

  const Scene& scene_;
  const Camera& camera_;
  const PixelRect& crop_;
  std::vector<SmallObject> found_;
};

}  // namespace

std::vector<SmallObject> find_small_objects(const Scene& scene, const Pose& pose, const Camera& camera,
                                            const PixelRect& crop) {
  Finder finder(scene, camera, crop);
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    if (!pose[i].is_hidden) finder.add_part(scene.parts[scene.instances[i].part], pose[i]);
  return finder.take();
}

}  // namespace rayfarm
