#include "common/compile/lights.h"

#include "common/compile/textures.h"
#include "common/errors/input_error.h"
#include "common/lighting/environment.h"
#include "common/lighting/frame_lights.h"
#include "common/lighting/light_choice.h"

namespace rayfarm {

void add_listed_lights(SceneArrays<GrowingArray>& arrays, const SceneDescription& description) {
  arrays.lights.assign(description.lights.begin(), description.lights.end());
  for (const DiagramDescription& diagram : description.diagrams) {
    arrays.goniometric_diagrams.push_back(diagram);
    arrays.goniometric_diagrams.back().first_value = static_cast<uint32_t>(arrays.goniometric_values.size());
    arrays.goniometric_values.insert(arrays.goniometric_values.end(), diagram.values.begin(),
                                     diagram.values.end());
  }
}

void add_environment(SceneArrays<GrowingArray>& arrays, const SceneDescription& description) {
  if (!description.environment) return;
  SceneHeader& head = arrays.header[0];
  head.environment = add_texture(arrays, *description.environment);
  head.environment_turn = description.environment_turn;
  arrays.lights.emplace_back().kind = LightKind::environment;
}

std::vector<Place> add_luminaires(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                                  const Luminaires& luminaires,
                                  std::span<const std::vector<Luminous>> luminous_of) {
  std::vector<Place> places;
  arrays.luminaire_triangles = luminaires.triangles();
  arrays.header[0].first_luminaire = static_cast<uint32_t>(arrays.lights.size());
  for (uint32_t i = 0; i < arrays.instances.size(); ++i)
    for (const Luminous& luminous : luminous_of[arrays.instances[i].part]) {
      if (places.size() == limits::kLuminaires)
        throw InputError(
            description.source(luminous.place),
            fmt::format("the scene has more than {} luminous primitives, each of which is a light; make "
                        "lamps of fewer (a sphere, a large polygon), or use fewer copies of them",
                        limits::kLuminaires));
      Light& light = arrays.lights.emplace_back();
      light.kind = LightKind::luminaire;
      light.instance = i;
      light.primitive = luminous.id;
      light.first_triangle = luminous.first_triangle;
      light.triangle_count = luminous.triangle_count;
      light.material = luminous.material;
      places.push_back(luminous.place);
    }
  return places;
}

void weigh_lights(SceneArrays<GrowingArray>& arrays) {
  Box bounds;
  for (const InstancePose& pose : arrays.poses) bounds.grow(pose.bounds);
  SceneHeader& head = arrays.header[0];
  head.far_away = distance_out_of(with_media(bounds, arrays.media));
  if (head.environment != kNone) {
    const auto shares = make_environment_shares(arrays.textures[head.environment], arrays.texels);
    arrays.environment_shares.assign(shares.begin(), shares.end());
  }
  const auto shares = make_light_shares(light_powers(view_of(arrays)), light_radius(bounds));
  arrays.light_shares.assign(shares.begin(), shares.end());
}

}  // namespace rayfarm
