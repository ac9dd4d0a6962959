#include "common/lighting/item_buffers.h"

#include <cmath>

#include "common/hierarchy/traverser.h"

namespace rayfarm {
namespace {

ItemView view_of(const Camera& camera, const RenderSettings& settings) {
  // Adaptive sampling looks one pixel beyond what is rendered.
  const int more = static_cast<int>(std::ceil(settings.item_radius_px)) + 1;
  const PixelRect& crop = settings.crop;
  return {
      camera.location,
      camera.top_left,
      camera.per_x,
      camera.per_y,
      {std::max(crop.x0 - more, 0), std::max(crop.y0 - more, 0),
       std::min(crop.x1 + more, settings.width_px) + 1, std::min(crop.y1 + more, settings.height_px) + 1}};
}

bool is_same(const Hit& a, const Hit& b) {
  return a.instance == b.instance && a.primitive == b.primitive;
}

/// In the world.
Box bounds_of(const Scene& scene, const Pose& pose) {
  Box box;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    if (!pose[i].is_hidden) box.grow(pose[i].bounds);
  return box;
}

/// A square of points about a direction (unit), up to this tangent away from it on all sides.
ItemView square_view(const Vec3& eye, const Vec3& axis, double tangent, uint32_t cells) {
  const Vec3 other = std::abs(axis.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 right = normalized(glm::cross(axis, other)), up = glm::cross(right, axis);
  const double step = 2 * tangent / (cells - 1);
  const auto side = static_cast<int>(cells);
  return {eye, axis - tangent * right - tangent * up, step * right, step * up, {0, 0, side, side}};
}

/// A light that sees the whole scene at no more than this tangent away from its middle has one map.
constexpr double kMostTangent = 1.5;
/// Light from afar is seen from so many radii away: nearly parallel.
constexpr double kAfar = 1e4;
/// What is this much nearer to a light, relatively, than where a ray comes from may shade it.
constexpr double kNearer = 1e-4;

}  // namespace

bool has_one_eye(const Scene& scene, const RenderSettings& settings) {
  const ViewRecord& view = scene.head().view;
  return view.projection == Projection::perspective && !(view.lens_radius > 0) && view.near == 0 &&
         std::isinf(view.far) && settings.fit != Fit::letterbox && !is_blurred(scene, settings);
}

bool has_item_map(const Light& light) {
  return light.kind == LightKind::point || light.kind == LightKind::bulb || light.kind == LightKind::spot ||
         light.kind == LightKind::distant;
}

EyeItems::EyeItems(const Scene& scene, const Pose& pose, const Camera& camera, const RenderSettings& settings)
    : scene_(scene),
      use_(settings.item_buffer),
      radius_px_(settings.item_radius_px),
      map_(scene, pose, view_of(camera, settings)) {}

void EyeItems::add_corner(int x, int y) {
  if (!map_.has(x, y)) {
    candidates_.is_known = false;
    return;
  }
  const Item& item = map_(x, y).item;
  if (!item.is_there())
    candidates_.is_open = true;
  else if (std::find(candidates_.items.begin(), candidates_.items.end(), item) == candidates_.items.end())
    candidates_.items.push_back(item);
}

const EyeItems::Candidates& EyeItems::candidates_at(double x, double y) {
  candidates_.items.clear();
  candidates_.is_open = false;
  candidates_.is_known = true;
  const double near_x = std::floor(x + 0.5), near_y = std::floor(y + 0.5);
  add_corner(static_cast<int>(near_x), static_cast<int>(near_y));
  if (near_x == x && near_y == y) return candidates_;
  for (double cy = std::ceil(y - radius_px_); cy <= y + radius_px_; ++cy)
    for (double cx = std::ceil(x - radius_px_); cx <= x + radius_px_; ++cx)
      if ((cx - x) * (cx - x) + (cy - y) * (cy - y) <= radius_px_ * radius_px_)
        add_corner(static_cast<int>(cx), static_cast<int>(cy));
  return candidates_;
}

void EyeItems::find_bounded(const Pose& pose, const RayPacket& rays, const RasterPoints& at, Hit* hits,
                            RayCounts& counts) {
  RayPacket bounded = rays;
  for (size_t i = 0; i < rays.size; ++i)
    for (const Item& item : candidates_at(at.x[i], at.y[i]).items) {
      const Hit hit = closest_hit_among(scene_, pose, {&item, 1}, rays[i]);
      if (!hit.is_hit()) continue;
      bounded.t_max[i] = hit.t;
      ++counts[RayTally::eye_items];
      break;
    }
  closest_hits(scene_, pose, bounded, hits);
}

void EyeItems::find(const Pose& pose, const RayPacket& rays, const RasterPoints& at, Hit* hits,
                    RayCounts& counts) {
  if (use_ == ItemBuffer::bound) {
    find_bounded(pose, rays, at, hits, counts);
    return;
  }
  for (size_t i = 0; i < rays.size; ++i) {
    const Candidates& candidates = candidates_at(at.x[i], at.y[i]);
    hits[i] = closest_hit_among(scene_, pose, candidates.items, rays[i]);
    if (hits[i].is_hit())
      ++counts[RayTally::eye_items];
    else if (!candidates.is_open || !candidates.is_known)  // something must be there
      hits[i] = closest_hit(scene_, pose, rays[i]);
  }
  if (use_ != ItemBuffer::checked) return;
  OfPacket<Hit> ordinary;
  ordinary.resize_for_overwrite(rays.size);
  closest_hits(scene_, pose, rays, ordinary.data());
  counts[RayTally::compared] += rays.size;
  for (size_t i = 0; i < rays.size; ++i) counts[RayTally::differing] += is_same(hits[i], ordinary[i]) ? 0 : 1;
}

size_t LightItems::most_lights(uint32_t cells) {
  return kMostItemPoints / (size_t{6} * cells * cells);
}

LightItems::LightItems(const Scene& scene, const Pose& pose, uint32_t cells) {
  const Box box = bounds_of(scene, pose);
  const double radius = 0.5 * glm::length(box.extent());
  maps_.resize(std::min(scene.lights.size(), most_lights(cells)));
  if (box.is_empty() || !(radius > 0) || !std::isfinite(radius)) return;
  for (size_t i = 0; i < maps_.size(); ++i) {
    const Light& light = scene.lights[i];
    if (!has_item_map(light)) continue;
    const LightPlace& place = pose[light];
    LightMap& map = maps_[i];
    map.position =
        light.kind == LightKind::distant ? box.center() - kAfar * radius * place.direction : place.position;
    const Vec3 to_center = box.center() - map.position;
    const double distance = glm::length(to_center);
    if (distance > radius) {
      const double tangent = radius / std::sqrt(distance * distance - radius * radius);
      if (tangent <= kMostTangent) {
        map.faces.emplace_back(scene, pose, square_view(map.position, to_center / distance, tangent, cells));
        continue;
      }
    }
    for (const Vec3& axis :
         {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
      map.faces.emplace_back(scene, pose, square_view(map.position, axis, 1, cells));
  }
}

Item LightItems::candidate(uint32_t light, const Vec3& origin) const {
  if (light >= maps_.size() || maps_[light].faces.empty()) return {};
  const LightMap& map = maps_[light];
  size_t face = 0;
  if (map.faces.size() > 1) {
    const Vec3 v = origin - map.position;
    const auto axis = static_cast<int>(largest_axis(v));
    face = static_cast<size_t>(2 * axis + (v[axis] < 0 ? 1 : 0));
  }
  const std::optional<ItemMap::Projection> at = map.faces[face].project(origin);
  if (!at || !(std::abs(at->x) < 1e6 && std::abs(at->y) < 1e6)) return {};
  const auto x = static_cast<int>(std::floor(at->x + 0.5)), y = static_cast<int>(std::floor(at->y + 0.5));
  if (!map.faces[face].has(x, y)) return {};
  const SeenItem& seen = map.faces[face](x, y);
  return seen.inverse_depth * at->depth > 1 + kNearer ? seen.item : Item();
}

uint32_t LightItems::blocked(const Scene& scene, const Pose& pose, uint32_t light, const RayPacket& rays,
                             uint32_t among, RayCounts& counts) const {
  uint32_t by_items = 0;
  for_each_lane(among, [&](size_t i) {
    const Item item = candidate(light, rays.origin(i));
    if (item.is_there() && hits_item(scene, pose, item, rays[i])) by_items |= 1u << i;
  });
  counts[RayTally::shadow_items] += static_cast<uint64_t>(std::popcount(by_items));
  const uint32_t rest = among & ~by_items;
  return rest ? by_items | any_hits(scene, pose, rays, rest) : by_items;
}

}  // namespace rayfarm
