#include "common/scene/camera.h"

#include <numbers>
#include <stdexcept>

#include "common/math/portable_math.h"

namespace rayfarm {

Camera make_camera(const Scene& scene, double frame, int width_px, int height_px) {
  const ViewRecord& view = scene.head().view;
  Camera camera;
  camera.location = Vec3(scene.eval(view.location, frame));
  const Vec3 direction =
      normalized(view.look_at == kNone ? Vec3(scene.eval(view.direction, frame))
                                       : Vec3(scene.eval(view.look_at, frame)) - camera.location);
  if (max_magnitude(direction) == 0)
    throw std::domain_error("the view has no direction: it looks at its own location");
  const Vec3 across = glm::cross(direction, normalized(Vec3(scene.eval(view.up, frame))));
  if (max_magnitude(across) < 1e-9)
    throw std::domain_error("the view's direction and its up vector are parallel; choose another up");
  const Vec3 right = normalized(across);
  const Vec3 up = glm::cross(right, direction);
  const double half_width = portable_tan(scene.eval(view.field_of_view, frame).x * (std::numbers::pi / 360));
  const double half_height = half_width * height_px / width_px;
  camera.top_left = direction - half_width * right + half_height * up;
  camera.per_x = (2 * half_width / width_px) * right;
  camera.per_y = (-2 * half_height / height_px) * up;
  camera.right = right;
  camera.up = up;
  camera.lens_radius = view.lens_radius;
  if (view.lens_radius > 0) camera.focus = scene.eval(view.focus, frame).x;
  return camera;
}

}  // namespace rayfarm
