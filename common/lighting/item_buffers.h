#pragma once
// Item buffers (Weghorst, Hooper and Greenberg 1984, section 4) of the eye, and of lights as their section 6
// asks for: what is nearest where a ray goes is tested before all else.
#include "common/hierarchy/item_map.h"
#include "common/lighting/eye_rays.h"
#include "common/lighting/frame_context.h"
#include "common/lighting/moments.h"
#include "common/lighting/ray_counts.h"

namespace rayfarm {

/// Whether the eye rays of a scene have one origin in every frame of a render: without, there is no item
/// buffer.
bool has_one_eye(const Scene& scene, const RenderSettings& settings);
/// Whether a light stands where shadow rays can be looked up from: it is a point, or infinitely far.
bool has_item_map(const Light& light);

/// Items at the corners of the picture's pixels.
class EyeItems {
 public:
  /// What `scene` looks at must outlive it.
  EyeItems(const Scene& scene, const Pose& pose, const Camera& camera, const RenderSettings& settings);

  /// What is tested first for a ray through a raster position.
  struct Candidates {
    std::vector<Item> items;  ///< different ones, that of the nearest corner first
    bool is_open = true;      ///< there may be nothing to hit: a corner shows nothing
    bool is_known = true;     ///< all corners that count stand in the buffer
  };
  /// A corner's item alone, where the position is one; else those of corners within the radius. Valid until
  /// the next call.
  const Candidates& candidates_at(double x, double y);

  /// Sets the hits of eye rays through `at`. `counts` grows by the rays that hit a candidate, and by those
  /// that would have hit something else, if that is looked for.
  void find(const Pose& pose, const RayPacket& rays, const RasterPoints& at, Hit* hits, RayCounts& counts);

 private:
  void find_bounded(const Pose& pose, const RayPacket& rays, const RasterPoints& at, Hit* hits,
                    RayCounts& counts);
  void add_corner(int x, int y);

  Scene scene_;
  ItemBuffer use_;
  double radius_px_;
  ItemMap map_;
  Candidates candidates_;
};

/// Items as each of a frame's lights sees them.
class LightItems {
 public:
  /// Of lights from the first on, as many as there is room for.
  LightItems(const Scene& scene, const Pose& pose, uint32_t cells);

  /// As any_hits for shadow rays to source number `light`, of t_max 1, the bits of `among`. `counts` grows by
  /// those that the light's items ended.
  uint32_t blocked(const Scene& scene, const Pose& pose, uint32_t light, const RayPacket& rays,
                   uint32_t among, RayCounts& counts) const;

  /// What is seen from the light where a ray comes from; nothing if the map doesn't reach there, or the ray
  /// comes from what is nearest to the light.
  Item candidate(uint32_t light, const Vec3& origin) const;

  /// Room for maps: lights in all, with so many points along a side.
  static size_t most_lights(uint32_t cells);

 private:
  struct LightMap {
    Vec3 position{0};
    std::vector<ItemMap> faces;  ///< one towards the scene; or six, from +x, -x, … on; none: of no use
  };
  std::vector<LightMap> maps_;  ///< by light
};

/// The hits of eye rays: those that the frame's items gave, or by an ordinary search.
inline void find_eye_hits(const FrameContext& context, const RayPacket& rays, Hit* hits) {
  if (context.eye_hits) [[unlikely]]
    std::copy_n(context.eye_hits, rays.size, hits);
  else
    closest_hits(context.scene, context.pose, rays, hits);
}

/// As any_hits, for shadow rays to source number `light`.
inline uint32_t find_blocked(const FrameContext& context, uint32_t light, const RayPacket& rays,
                             uint32_t among, RayCounts& counts) {
  if (context.light_items) [[unlikely]]
    return context.light_items->blocked(context.scene, context.pose, light, rays, among, counts);
  return any_hits(context.scene, context.pose, rays, among);
}

}  // namespace rayfarm
