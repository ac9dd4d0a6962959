#include "common/description/formats/yaml_view.h"

#include "common/description/formats/yaml_curves.h"

namespace rayfarm {

void read_view(const YamlValue& value, SceneDescription& scene) {
  YamlMap map(value);
  scene.has_view = true;
  ViewDescription& view = scene.view;
  view.location = read_curve(map.require("location"), Interpolation::linear, read_point);
  const auto direction = map.find("direction"), look_at = map.find("look_at");
  if (direction && look_at) direction->fail("give either `direction` or `look_at`, not both");
  if (!direction && !look_at) value.fail("the view needs `direction` or `look_at`");
  if (direction) view.direction = read_curve(*direction, Interpolation::spherical, read_direction);
  if (look_at) view.look_at = read_curve(*look_at, Interpolation::linear, read_point);
  if (auto v = map.find("up")) view.up = read_curve(*v, Interpolation::spherical, read_direction);
  if (auto v = map.find("field_of_view"))
    view.field_of_view = read_curve(*v, Interpolation::linear, [](const YamlValue& n) {
      const double degrees = n.number();
      if (!(degrees > 0 && degrees < 180)) n.fail("the field of view must be between 0 and 180 degrees");
      return Vec4(degrees, 0, 0, 0);
    });
  if (auto v = map.find("lens")) {
    YamlMap lens(*v);
    view.lens_radius = lens.require("radius").number_in(0, 1e9);
    view.focus = read_curve(lens.require("focus"), Interpolation::linear, [](const YamlValue& n) {
      const double distance = n.number();
      if (!(distance > 0)) n.fail("the distance in focus must be above 0");
      return Vec4(distance, 0, 0, 0);
    });
    lens.finish();
  }
  if (auto v = map.find("aspect")) view.aspect = v->number_in(1e-3, 1e3);
  if (auto v = map.find("resolution")) {
    const std::vector<YamlValue> size = v->items();
    if (size.size() != 2) v->fail("the resolution is [width, height] in pixels");
    view.resolution_px = {size[0].whole_number_in(1, 65536), size[1].whole_number_in(1, 65536)};
  }
  map.finish();
}

}  // namespace rayfarm
