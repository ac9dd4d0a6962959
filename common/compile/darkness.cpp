#include "common/compile/darkness.h"

#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

#include "common/hierarchy/primitive_bounds.h"
#include "common/hierarchy/region.h"
#include "common/hierarchy/traverser.h"
#include "common/materials/scattering.h"
#include "common/math/portable_math.h"
#include "common/sampling/warps.h"
#include "common/scene/camera.h"

namespace rayfarm {
namespace {

constexpr size_t kPatience = 20'000'000;  ///< boxes: under a second

struct Lamp {
  Vec3 normal{0};  ///< unit; towards where it shines
  double d = 0;    ///< normal·p of its farthest corner
  double size = 0;
};

/// A luminous polygon or triangle in the world.
Lamp lamp_in_world(const Scene& scene, const Light& light) {
  const InstancePose& pose = scene.poses[light.instance];
  Lamp lamp;
  double area = 0;
  Vec3 normal = scene.luminaire_triangles[light.first_triangle].normal;
  if (!pose.is_identity) normal = normalized(pose.object_from_world.normal_by_inverse(normal));
  lamp.normal = scene.materials[light.material].is_inward ? -normal : normal;
  lamp.d = -std::numeric_limits<double>::infinity();
  for (LuminaireTriangle t : scene.luminaire_triangles.subspan(light.first_triangle, light.triangle_count)) {
    for (Vec3& p : t.corners) {
      if (!pose.is_identity) p = pose.world_from_object.point(p);
      lamp.d = std::max(lamp.d, glm::dot(lamp.normal, p));
    }
    area += 0.5 * glm::length(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]));
  }
  lamp.size = std::sqrt(area);
  return lamp;
}

/// Luminaires that share corners are one body: the back of a luminous box may shine at nothing.
class Bodies {
 public:
  Bodies(const Scene& scene, std::span<const Light> lamps) : body_(lamps.size()) {
    std::iota(body_.begin(), body_.end(), 0u);
    // In float, as some corners stand: a polygon tested as it is may be the cap of others.
    std::map<std::tuple<uint32_t, float, float, float>, uint32_t> at;
    for (uint32_t i = 0; i < lamps.size(); ++i)
      for (const LuminaireTriangle& t :
           scene.luminaire_triangles.subspan(lamps[i].first_triangle, lamps[i].triangle_count))
        for (const Vec3& p : t.corners) {
          const auto [found, is_new] = at.try_emplace(
              {lamps[i].instance, static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
              i);
          if (!is_new) body_[of(i)] = of(found->second);
        }
  }
  uint32_t of(uint32_t lamp) {
    while (body_[lamp] != lamp) lamp = body_[lamp] = body_[body_[lamp]];
    return lamp;
  }

 private:
  std::vector<uint32_t> body_;
};

/// True if a medium may lie in the region: no half space has all of its box outside.
bool may_hold_medium(const Scene& scene, std::span<const HalfSpace> region) {
  return std::any_of(scene.media.begin(), scene.media.end(), [&](const ParticipatingMedium& medium) {
    const auto corners = corners_of(medium.box);
    return std::all_of(region.begin(), region.end(), [&](const HalfSpace& half) {
      return std::any_of(corners.begin(), corners.end(),
                         [&](const Vec3& p) { return glm::dot(half.n, p) > half.d; });
    });
  });
}

/// What lies in front of the lamp by more than a hair's breadth: a lamp that is mounted on a ceiling need not
/// touch it.
bool shines_at_something(const Scene& scene, const Lamp& lamp, double hair, const Vec3& viewer,
                         size_t& patience) {
  constexpr double kGap = 0.02;  ///< of the lamp's size
  const double gap = std::max(kGap * lamp.size, hair);
  const HalfSpace front{lamp.normal, lamp.d + gap};
  if (glm::dot(front.n, viewer) > front.d) return true;  // the camera looks at it
  if (may_hold_medium(scene, std::span(&front, 1))) return true;
  if (find_in_region(scene, std::span(&front, 1), patience) != Presence::none) return true;
  const HalfSpace back{-lamp.normal, -lamp.d + gap};
  return find_in_region(scene, std::span(&back, 1), patience) != Presence::certain;  // there is nothing else
}

/// Where the camera's rays go; nothing if that is not a pyramid.
std::vector<HalfSpace> seen_by(const Camera& camera, int width_px, int height_px) {
  if (camera.projection != Projection::perspective || camera.near > 0 || std::isfinite(camera.far)) return {};
  const Vec3& forward = camera.forward;
  const Vec3 right = static_cast<double>(width_px) * camera.per_x,
             down = static_cast<double>(height_px) * camera.per_y;
  const std::array<Vec3, 4> corners{camera.top_left, camera.top_left + right, camera.top_left + right + down,
                                    camera.top_left + down};
  std::vector<HalfSpace> region;
  const auto add = [&](const Vec3& inwards, double spread) {
    // A lens moves rays by its radius, and by as much again at the distance where it is sharp.
    const Vec3 n = inwards + (spread * camera.lens_radius / camera.focus) * forward;
    region.push_back({n, glm::dot(n, camera.location) - spread * camera.lens_radius});
  };
  add(forward, 0);
  for (size_t i = 0; i < 4; ++i) {
    const Vec3 side = normalized(glm::cross(corners[i], corners[(i + 1) % 4]));
    add(glm::dot(side, forward) > 0 ? side : -side, 1);
  }
  if (camera.has_lens()) return region;
  for (int k = 0; k < 3; ++k)  // sharpens the pyramid's tip for boxes that are large beside it
    for (const double sign : {-1.0, 1.0})
      if (std::all_of(corners.begin(), corners.end(), [&](const Vec3& c) { return sign * c[k] >= 0; })) {
        Vec3 n(0);
        n[k] = sign;
        add(n, 0);
      }
  return region;
}

/// Of all that is there at the first frame.
Box bounds_of_visible(const Scene& scene) {
  Box bounds;
  for (const InstancePose& pose : scene.poses)
    if (!pose.is_hidden) bounds.grow(pose.bounds);
  return bounds;
}

/// Luminous triangles and polygons that shine away from all there is.
void note_turned_lamps(const SceneDescription& description, const Scene& scene, std::span<const Place> places,
                       Notes& notes) {
  const std::span<const Light> lamps = scene.lights.subspan(scene.head().first_luminaire);
  const double frame = description.frames ? (*description.frames)[0] : 0;
  const Vec3 viewer(scene.eval(scene.head().view.location, frame));
  const double hair = 1e-6 * bounds_of_visible(scene).magnitude();
  size_t patience = kPatience;
  std::vector<bool> is_turned(lamps.size());
  for (size_t i = 0; i < lamps.size() && patience > 0; ++i)
    is_turned[i] = lamps[i].triangle_count > 0 && !scene.poses[lamps[i].instance].is_hidden &&
                   !shines_at_something(scene, lamp_in_world(scene, lamps[i]), hair, viewer, patience);
  if (std::find(is_turned.begin(), is_turned.end(), true) == is_turned.end()) return;
  Bodies bodies(scene, lamps);
  std::vector<bool> is_body_lit(lamps.size());
  for (uint32_t i = 0; i < lamps.size(); ++i)
    if (!is_turned[i]) is_body_lit[bodies.of(i)] = true;
  size_t count = 0;
  Place first;
  bool is_inward = false;
  for (uint32_t i = 0; i < lamps.size(); ++i) {
    if (!is_turned[i] || is_body_lit[bodies.of(i)] || count++ > 0) continue;
    first = places[i];
    is_inward = scene.materials[lamps[i].material].is_inward != 0;
  }
  if (count == 0) return;
  notes.add(
      description.source(first),
      fmt::format("the lamp shines away from everything else{}{}: to the side from which its corners run "
                  "{}clockwise; turn their order round, or {} `inward: true` in its luminaire",
                  !scene.moving_instances.empty() ? fmt::format(" at frame {}", frame) : "",
                  count > 1 ? fmt::format(" ({} of them do)", count) : "", is_inward ? "" : "counter-",
                  is_inward ? "leave out" : "write"));
}

/// True if nothing lies in the cone of a spot.
bool shines_past_everything(const Scene& scene, const Light& light, size_t& patience) {
  if (light.kind != LightKind::spot || !(light.cosine_none > 0)) return false;
  // A pyramid about the cone that it lights.
  const double sine = std::sqrt(std::max(0.0, 1 - light.cosine_none * light.cosine_none));
  const double slack = 1e-9 * max_magnitude(light.position);
  std::vector<HalfSpace> cone;
  for (int side = 0; side < 8; ++side) {
    const double phi = side * std::numbers::pi / 4;
    const Vec3 outwards = Frame(light.direction).to_world({portable_cos(phi), portable_sin(phi), 0});
    const Vec3 n = sine * light.direction - light.cosine_none * outwards;
    cone.push_back({n, glm::dot(n, light.position) - slack});
  }
  return !may_hold_medium(scene, cone) && find_in_region(scene, cone, patience) == Presence::none;
}

void note_turned_spots(const SceneDescription& description, const Scene& scene,
                       std::span<const Place> places_in_objects, Notes& notes) {
  if (scene.instances.empty()) return;
  const char* when = has_poses(scene) ? " at the first frame" : "";
  const char* remedy = "check its `position` and `direction`";
  const size_t listed = description.lights.size();
  size_t patience = kPatience;
  for (size_t i = 0; i < listed; ++i)
    if (shines_past_everything(scene, scene.lights[i], patience))
      notes.add(
          description.source(),
          fmt::format("light {} of `lights`, a spot, shines past everything{}; {}", i + 1, when, remedy));
  const double frame = description.frames ? (*description.frames)[0] : 0;
  const std::vector<char> visible = visible_nodes(scene, frame);
  std::map<std::pair<int, int>, std::pair<Place, size_t>> turned;  // by line and column: copies are told once
  for (size_t i = 0; i < places_in_objects.size(); ++i) {
    const Light& light = scene.lights[listed + i];
    if (!visible[light.object_node] || !shines_past_everything(scene, light, patience)) continue;
    const Place& place = places_in_objects[i];
    auto& [first, count] = turned[{place.line, place.column}];
    first = place;
    ++count;
  }
  for (const auto& [_, found] : turned)
    notes.add(
        description.source(found.first),
        fmt::format("the spot shines past everything{}{}; {}", when,
                    found.second > 1 ? fmt::format(" ({} copies of it do)", found.second) : "", remedy));
}

/// Those of what stands anywhere in some frame.
std::vector<bool> materials_in_use(const Scene& scene) {
  std::vector<bool> is_placed(scene.parts.size()), is_used(scene.materials.size());
  for (const Instance& instance : scene.instances) is_placed[instance.part] = true;
  for (size_t i = 0; i < scene.parts.size(); ++i)
    if (is_placed[i])
      for_each_named(scene, scene.parts[i],
                     [&](PrimitiveId id, uint32_t) { is_used[material_of(scene, id)] = true; });
  return is_used;
}

}  // namespace

void add_notes_of_darkness(const SceneDescription& description, const Scene& scene, const LightPlaces& places,
                           Notes& notes) {
  note_turned_lamps(description, scene, places.luminaires, notes);
  note_turned_spots(description, scene, places.in_objects, notes);
  if (!scene.instances.empty() && is_dark(scene, {}))
    notes.add(description.source(),
              "nothing lights the scene, so pictures of it are black: it has no lights, nothing "
              "luminous, no background or environment, and no material shows ambient light; add "
              "`lights`, or a material with a `luminaire`");
}

bool is_dark(const Scene& scene, const RenderSettings& settings) {
  std::vector<bool> is_used = materials_in_use(scene);
  for (size_t i = is_used.size(); i-- > 0;)
    if (is_used[i] && scene.materials[i].kind == MaterialKind::mix)
      for (const uint32_t part : scene.materials[i].parts) is_used[part] = true;
  const SceneHeader& head = scene.head();
  if (head.background != Color(0)) return false;  // of an environment, too
  for (const Light& light : scene.lights)
    if (light.kind < LightKind::environment && light.color != Color(0)) return false;
  for (size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i] || scene.materials[i].kind == MaterialKind::mix) continue;
    const Material& m = scene.materials[i];
    if (is_luminaire(m)) return false;
    const bool has_ambient =
        follows_paths(settings.lighting) ? false
        : settings.lighting == LightingModel::thesis
            ? (has_diffuse_rays(m) ? settings.diffuse_reach > 0 && m.diffuse > 0 : m.ambient > 0)
            : m.ambient > 0;
    const bool takes_colour =
        settings.lighting == LightingModel::thesis || settings.ambient_colour == AmbientColour::surface;
    if (has_ambient && head.ambient != Color(0) &&
        (!takes_colour || m.texture != kNone || m.color * head.ambient != Color(0)))
      return false;
  }
  return true;
}

std::optional<std::string> nothing_in_view(const Scene& scene, double frame, int width_px, int height_px) {
  if (scene.instances.empty() && scene.media.empty())
    return scene.head().environment == kNone ? std::optional<std::string>("the scene holds no objects")
                                             : std::nullopt;
  const Camera camera = make_camera(scene, frame, width_px, height_px);
  const std::vector<HalfSpace> seen = seen_by(camera, width_px, height_px);
  if (may_hold_medium(scene, seen)) return std::nullopt;
  size_t patience = kPatience;
  switch (seen.empty() ? Presence::possible : find_in_region(scene, seen, patience)) {
    case Presence::certain:
      return std::nullopt;
    case Presence::none: {
      const Box box = bounds_of_visible(scene);
      if (box.is_empty()) return "the camera sees nothing: no object is visible";
      return fmt::format(
          "the camera sees nothing: no object lies in its view; the middle of the scene is ({:.4g}, {:.4g}, "
          "{:.4g}), and its size {:.4g}",
          box.center().x, box.center().y, box.center().z, glm::length(box.extent()));
    }
    case Presence::possible:
      break;
  }
  constexpr int kColumns = 64, kRows = 48;
  FrameState pose(scene);
  const Pose now = pose.at(frame);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) {
      const Vec2 at((x + 0.5) / kColumns * width_px, (y + 0.5) / kRows * height_px);
      if (camera.sees(at.x, at.y) && closest_hit(scene, now, camera.ray(at.x, at.y)).is_hit())
        return std::nullopt;
    }
  return fmt::format(
      "the camera sees nothing, or hardly anything: of {} rays all over the picture none meets an "
      "object",
      kColumns * kRows);
}

}  // namespace rayfarm
