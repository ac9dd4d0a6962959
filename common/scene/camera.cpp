#include "common/scene/camera.h"

#include <numbers>
#include <stdexcept>

#include "common/math/portable_math.h"

namespace rayfarm {

using std::numbers::pi;

std::optional<Camera::Projected> Camera::project(const Vec3& p) const {
  const Vec3 v = p - location;
  const double depth = glm::dot(v, forward);
  if (radians_per_px > 0) {
    const double distance = glm::length(v), x = glm::dot(v, right), y = glm::dot(v, up);
    if (!(distance > 0)) return std::nullopt;
    if (projection == Projection::panoramic) {
      const double across = glm::length(Vec2(x, depth)),
                   longitude = std::copysign(portable_acos(depth / across), x);
      if (!(across > 0)) return std::nullopt;
      const double latitude = std::copysign(portable_acos(across / distance), y);
      return Projected{middle_px + Vec2(longitude, -latitude) / radians_per_px,
                       1 / (across * radians_per_px)};
    }
    const double angle = portable_acos(depth / distance), across = glm::length(Vec2(x, y));
    if (!(across > 0)) return Projected{middle_px, 1 / (distance * radians_per_px)};
    return Projected{middle_px + angle / (across * radians_per_px) * Vec2(x, -y),
                     std::max(angle, across / distance) / (across * radians_per_px)};
  }
  if (!(depth > 0)) return std::nullopt;
  const bool is_parallel = projection == Projection::orthographic;
  const Vec3 offset = (is_parallel ? v : v / depth) - top_left;
  return Projected{
      {glm::dot(offset, per_x) / glm::dot(per_x, per_x), glm::dot(offset, per_y) / glm::dot(per_y, per_y)},
      1 / ((is_parallel ? 1 : depth) * glm::length(per_x))};
}

bool Camera::sees(double x, double y) const {
  if (!(x >= frame_begin_px.x && x < frame_end_px.x && y >= frame_begin_px.y && y < frame_end_px.y))
    return false;
  if (radians_per_px == 0) return true;
  const Vec2 angles = radians_per_px * (Vec2(x, y) - middle_px);
  return projection == Projection::panoramic ? std::abs(angles.y) <= pi / 2
                                             : glm::length(angles) <= most_radians;
}

Ray Camera::ray(double x, double y, const Vec2& lens) const {
  Ray ray{location};
  double cosine = 1;  // between the ray and what near and far are measured along
  switch (projection) {
    case Projection::perspective: {
      ray.direction = top_left + x * per_x + y * per_y;
      if (has_lens()) {
        const Vec3 offset = lens_radius * (lens.x * right + lens.y * up);
        ray = {location + offset, focus * ray.direction - offset};
      }
      ray.direction = normalized(ray.direction);
      cosine = glm::dot(ray.direction, forward);
      break;
    }
    case Projection::orthographic: {
      const Vec3 offset = lens_radius * (lens.x * right + lens.y * up);
      ray = {location + top_left + x * per_x + y * per_y + offset, normalized(focus * forward - offset)};
      cosine = glm::dot(ray.direction, forward);
      break;
    }
    case Projection::panoramic: {
      const auto longitude = portable_sine_cosine((x - middle_px.x) * radians_per_px),
                 latitude = portable_sine_cosine((middle_px.y - y) * radians_per_px);
      ray.direction = normalized(latitude.cosine * (longitude.sine * right + longitude.cosine * forward) +
                                 latitude.sine * up);
      break;
    }
    case Projection::fisheye: {
      const Vec2 from_middle(x - middle_px.x, middle_px.y - y);
      const double distance = glm::length(from_middle);
      const auto angle = portable_sine_cosine(distance * radians_per_px);
      const Vec2 across = distance > 0 ? from_middle / distance : Vec2(0);
      ray.direction = normalized(angle.cosine * forward + angle.sine * (across.x * right + across.y * up));
    }
  }
  if (near > 0) ray.origin += near / cosine * ray.direction;
  if (std::isfinite(far)) ray.t_max = (far - near) / cosine;
  return ray;
}

Camera make_camera(const Scene& scene, double frame, int width_px, int height_px, Fit fit) {
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
  camera.right = right;
  camera.up = up;
  camera.forward = glm::cross(up, right);
  camera.projection = view.projection;
  camera.near = view.near;
  camera.far = view.far;
  camera.lens_radius = view.lens_radius;
  if (view.lens_radius > 0) camera.focus = scene.eval(view.focus, frame).x;

  const double covering = height_px * view.aspect;  // of a frame that is as high as the picture
  const double frame_px = fit == Fit::crop        ? std::max<double>(width_px, covering)
                          : fit == Fit::letterbox ? std::min<double>(width_px, covering)
                                                  : width_px;
  if (fit == Fit::letterbox) {
    const Vec2 size(width_px, height_px), bars = (size - Vec2(frame_px, frame_px / view.aspect)) / 2.0;
    if (bars.x > 0 || bars.y > 0) {
      camera.frame_begin_px = bars;
      camera.frame_end_px = size - bars;
    }
  }
  const Vec2 shift(view.shift[0], view.shift[1]);
  if (view.projection == Projection::panoramic || view.projection == Projection::fisheye) {
    const double radians = scene.eval(view.field_of_view, frame).x * (pi / 180);
    camera.radians_per_px = radians / frame_px;
    camera.most_radians = radians / 2;
    camera.middle_px = Vec2(width_px, height_px) / 2.0 + frame_px * Vec2(-shift.x, shift.y);
    return camera;
  }
  const bool is_parallel = view.projection == Projection::orthographic;
  const double frame_half = is_parallel ? scene.eval(view.width, frame).x / 2
                                        : portable_tan(scene.eval(view.field_of_view, frame).x * (pi / 360));
  const double half_width = frame_half * (width_px / frame_px);
  const double half_height = half_width * height_px / width_px;
  camera.top_left = (is_parallel ? Vec3(0) : direction) - half_width * right + half_height * up;
  if (shift != Vec2(0)) camera.top_left += 2 * frame_half * (shift.x * right + shift.y * up);
  camera.per_x = (2 * half_width / width_px) * right;
  camera.per_y = (-2 * half_height / height_px) * up;
  return camera;
}

}  // namespace rayfarm
