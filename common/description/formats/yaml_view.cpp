#include "common/description/formats/yaml_view.h"

#include <fmt/core.h>

#include "common/description/formats/yaml_curves.h"

namespace rayfarm {

void read_view(const YamlValue& value, SceneDescription& scene) {
  YamlMap map(value);
  // First: one that is misspelt would be told as one that is missing.
  map.know({"location", "direction", "look_at", "up", "projection", "field_of_view", "width", "shift", "near",
            "far", "lens", "aspect", "resolution"});
  map.finish();
  scene.has_view = true;
  ViewDescription& view = scene.view;
  view.location = read_curve(map.require("location"), Interpolation::linear, read_point);
  const auto direction = map.find("direction"), look_at = map.find("look_at");
  if (direction && look_at) direction->fail("give either `direction` or `look_at`, not both");
  if (!direction && !look_at) value.fail("the view needs `direction` or `look_at`");
  if (direction) view.direction = read_curve(*direction, Interpolation::spherical, read_direction);
  if (look_at) view.look_at = read_curve(*look_at, Interpolation::linear, read_point);
  if (auto v = map.find("up")) view.up = read_curve(*v, Interpolation::spherical, read_direction);
  if (auto v = map.find("projection"))
    view.projection = static_cast<Projection>(v->choice({kProjectionWords.begin(), kProjectionWords.end()}));
  const double most = most_field_of_view(view.projection);
  view.field_of_view = constant_curve(Vec4(usual_field_of_view(view.projection), 0, 0, 0));
  const bool is_parallel = view.projection == Projection::orthographic;
  if (auto v = map.find("field_of_view")) {
    if (is_parallel)
      v->fail("an orthographic view has no angle; `width` says how much of the world it shows");
    view.field_of_view = read_curve(*v, Interpolation::linear, [most](const YamlValue& n) {
      const double degrees = n.number();
      if (!(degrees > 0 && (degrees < most || (degrees == 360 && most == 360))))
        n.fail(fmt::format("the field of view must be between 0 and {} degrees", most));
      return Vec4(degrees, 0, 0, 0);
    });
  }
  if (auto v = map.find("width")) {
    if (!is_parallel) v->fail("`width` belongs to `projection: orthographic`; others have a `field_of_view`");
    view.width = read_curve(*v, Interpolation::linear,
                            [](const YamlValue& n) { return Vec4(n.number_in(1e-12, 1e12), 0, 0, 0); });
  } else if (is_parallel) {
    value.fail("an orthographic view needs `width`: how much of the world the picture is wide");
  }
  if (auto v = map.find("shift")) {
    const std::vector<YamlValue> of = v->items();
    if (of.size() != 2) v->fail("the shift is [right, up] in widths of the view");
    view.shift = {of[0].number_in(-100, 100), of[1].number_in(-100, 100)};
  }
  if (auto v = map.find("near")) view.near = v->number_in(0, 1e12);
  if (auto v = map.find("far")) {
    view.far = v->number_in(0, 1e12);
    if (!(view.far > view.near)) v->fail("`far` must lie behind `near`");
  }
  if (auto v = map.find("lens")) {
    if (view.projection == Projection::panoramic || view.projection == Projection::fisheye)
      v->fail("a panoramic view or a fisheye's has no lens here; all of it is sharp");
    YamlMap lens(*v);
    view.lens_radius = lens.require("radius").number_in(0, 1e9);
    view.focus = read_curve(lens.require("focus"), Interpolation::linear, [](const YamlValue& n) {
      const double distance = n.number();
      if (!(distance > 0)) n.fail("the distance in focus must be above 0");
      return Vec4(distance, 0, 0, 0);
    });
    lens.finish();
  }
  if (view.projection == Projection::panoramic) view.aspect = 2;
  if (view.projection == Projection::fisheye) view.aspect = 1;
  if (auto v = map.find("aspect")) view.aspect = v->number_in(1e-3, 1e3);
  if (auto v = map.find("resolution")) {
    const std::vector<YamlValue> size = v->items();
    if (size.size() != 2) v->fail("the resolution is [width, height] in pixels");
    view.resolution_px = {size[0].whole_number_in(1, 65536), size[1].whole_number_in(1, 65536)};
  }
}

}  // namespace rayfarm
