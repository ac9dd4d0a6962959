#include "common/description/quick_look.h"

#include "common/materials/scattering.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

/// From the model to the camera: 30° to the right, 20° up. The picture's upper edge is 8° below the horizon
/// then, so that the ground is all that stands behind the model.
const Vec3 kToCamera = normalized(Vec3(0.5, 0.42, 0.866));
/// From the model to the lamp, in radii of the model.
const Vec3 kToLamp(-2.6, 3.2, 2.4);
/// The part of the picture that the model may fill.
constexpr double kFilled = 0.88;
/// How far the ground reaches, and how far below the model it is, in radii of the model.
constexpr double kGroundReach = 60, kGroundGap = 1e-4;

MaterialDescription matt(const char* name, double color) {
  MaterialDescription material(name);
  material.color = Color(color);
  material.ambient = QuickLook::kAmbient;
  material.diffuse = 1;
  return material;
}

/// A lamp's body is brighter than what white surfaces show; what only glows is not.
bool is_lamp(const Material& m) {
  return is_luminaire(m) && !m.is_no_lamp && luminance(m.emission) > 1;
}

bool has_lights(const SceneDescription& scene) {
  return !scene.lights.empty() || std::any_of(scene.materials.begin(), scene.materials.end(), is_lamp) ||
         std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const ObjectDescription& object) { return !object.lights.empty(); });
}

void add_child(SceneDescription& scene, const char* name, Shape shape, MaterialDescription material) {
  const auto index = static_cast<uint32_t>(scene.objects.size());
  scene.objects.push_back({name, {}, {}, {}});
  scene.objects.back().primitives.push_back(
      {std::move(shape), static_cast<uint32_t>(scene.materials.size()), {}});
  scene.materials.push_back(std::move(material));
  scene.objects[scene.root].children.push_back({index, {}, {}});
}

}  // namespace

QuickLook make_quick_look(const Box& bounds) {
  QuickLook look;
  const Vec3 center = bounds.center();
  // A single point has no size, and a camera must stand off it.
  const double radius = std::max({0.5 * glm::length(bounds.extent()), 1e-6 * bounds.magnitude(), 1e-12});
  constexpr double kLeastSeen = 0.01;  // of what the picture shows: a few pixels
  look.is_too_small = 0.5 * glm::length(bounds.extent()) < kLeastSeen * radius;
  look.look_at = center;
  const Vec3 right = normalized(glm::cross(Vec3(0, 1, 0), kToCamera)), up = glm::cross(kToCamera, right);
  constexpr double kRadians = 3.14159265358979323846 / 180;
  const double half_width = portable_tan(0.5 * look.field_of_view * kRadians) * kFilled,
               half_height = half_width / ViewDescription().aspect;
  double distance = 1.5 * radius;  // off what it looks at, however flat that is
  for (const Vec3& corner : corners_of(bounds)) {
    const Vec3 p = corner - center;
    distance = std::max({distance, std::abs(glm::dot(p, right)) / half_width + glm::dot(p, kToCamera),
                         std::abs(glm::dot(p, up)) / half_height + glm::dot(p, kToCamera)});
  }
  look.location = center + distance * kToCamera;
  const double ground = bounds.lo.y - kGroundGap * radius, reach = kGroundReach * radius;
  look.ground = {
      Vec3(center.x - reach, ground, center.z + reach), Vec3(center.x + reach, ground, center.z + reach),
      Vec3(center.x + reach, ground, center.z - reach), Vec3(center.x - reach, ground, center.z - reach)};
  look.lamp = center + radius * kToLamp;
  look.lamp_radius = radius;
  return look;
}

MaterialDescription quick_look_material(bool is_coloured) {
  MaterialDescription material = matt("model", is_coloured ? 1 : QuickLook::kModelColor);
  material.diffuse = QuickLook::kModelDiffuse;
  material.specular = QuickLook::kModelSpecular;
  material.shininess = QuickLook::kModelShininess;
  return material;
}

void add_quick_look(SceneDescription& scene, const QuickLook& look) {
  if (!scene.has_view && look.is_too_small)
    scene.notes.add(
        scene.source(),
        "the model is too small to be shown by itself (less than 2e-14 across, or than a "
        "hundred-millionth of its coordinates): put it into a scene, scaled up (`transform: {scale: "
        "…}`) or seen from near by");
  if (!scene.has_view) {
    scene.view.location = constant_curve(Vec4(look.location, 0));
    scene.view.look_at = constant_curve(Vec4(look.look_at, 0));
    scene.view.field_of_view = constant_curve(Vec4(look.field_of_view, 0, 0, 0));
    scene.has_view = true;
  }
  if (has_lights(scene)) return;
  scene.background = Color(QuickLook::kSky);
  add_child(scene, "ground", PolygonShape{{look.ground.begin(), look.ground.end()}, {}},
            matt("ground", QuickLook::kGroundColor));
  MaterialDescription lamp("lamp");
  lamp.kind = MaterialKind::luminaire;
  lamp.color = Color(0);
  lamp.emission = Color(QuickLook::kEmission);
  lamp.ambient = lamp.specular = 0;
  lamp.diffuse = 1;
  add_child(scene, "lamp", SphereShape{look.lamp, look.lamp_radius}, std::move(lamp));
  scene.render.push_back({"lighting", QuickLook::kLighting, {}});
  scene.render.push_back({"samples", fmt::format("{}", QuickLook::kSamples), {}});
}

}  // namespace rayfarm
