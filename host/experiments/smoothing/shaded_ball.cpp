#include "host/experiments/smoothing/shaded_ball.h"

#include "common/lighting/face_corners.h"
#include "host/experiments/smoothing/football.h"

namespace rayfarm {
namespace {

Smoothing smoothing_of(ShadingMethod method) {
  switch (method) {
    case ShadingMethod::flat:
      return Smoothing::flat;
    case ShadingMethod::gouraud:
    case ShadingMethod::gouraud_by_lines:
      return Smoothing::gouraud;
    case ShadingMethod::phong:
    case ShadingMethod::phong_by_lines:
      return Smoothing::phong;
    case ShadingMethod::center:
      return Smoothing::center;
  }
  return Smoothing::flat;
}

CompiledScene make_scene(ShadingMethod method, const Vec3& axis) {
  SceneDescription scene;
  scene.files = {"football"};
  scene.materials.emplace_back("white");
  scene.materials[0].ambient = 0;
  scene.materials[0].diffuse = 1;
  Light light;
  light.position = ShadedBall::eye();
  scene.lights.push_back(light);
  scene.view.location = constant_curve(Vec4(ShadedBall::eye(), 0));
  scene.view.direction = constant_curve(Vec4(0, 0, -1, 0));
  scene.view.field_of_view = constant_curve(Vec4(32, 0, 0, 0));
  scene.view.aspect = 1;
  scene.objects.push_back({"root", {}, {}, {}});
  scene.objects.push_back({"ball", {}, {}, {}});
  scene.objects[1].primitives.push_back({make_football(smoothing_of(method)), 0, {}});
  TransformStep tilt;  // so that no polygon faces the eye
  tilt.kind = TransformKind::rotate;
  tilt.axis = Vec3(1, 2, 0.5);
  tilt.curve = constant_curve(Vec4(33, 0, 0, 0));
  TransformStep turn;
  turn.kind = TransformKind::rotate;
  turn.axis = axis;
  turn.curve.frames = {0, kBallFrames};
  turn.curve.values = {Vec4(0), Vec4(kDegreesPerFrame * kBallFrames, 0, 0, 0)};
  scene.objects[0].children.push_back({1, {tilt, turn}, {}});
  return compile(scene);
}

RenderSettings settings_of_ball() {
  RenderSettings settings;
  settings.lighting = LightingModel::phong;
  return settings;
}

/// A value at the place where the picture's line `y` crosses one of a polygon's edges.
template <typename T>
struct Crossing {
  double x;
  T value;
};

/// Between the crossings to the left and to the right of `p`, linearly along the line; `p` lies in the
/// polygon, which is convex.
template <typename T>
T along_line(std::span<const Vec2> corners, std::span<const T> values, const Vec2& p) {
  std::optional<Crossing<T>> left, right;
  for (size_t i = 0; i < corners.size(); ++i) {
    const size_t j = (i + 1) % corners.size();
    const Vec2 &a = corners[i], &b = corners[j];
    if ((a.y <= p.y) == (b.y <= p.y)) continue;
    const double t = (p.y - a.y) / (b.y - a.y);
    const Crossing<T> crossing{a.x + t * (b.x - a.x), values[i] + t * (values[j] - values[i])};
    std::optional<Crossing<T>>& side = b.y > a.y ? left : right;
    side = crossing;
  }
  if (!left || !right) return values[0];  // a corner's line alone: rounding
  const double length = right->x - left->x;
  const double share = length != 0 ? std::clamp((p.x - left->x) / length, 0.0, 1.0) : 0;
  return left->value + share * (right->value - left->value);
}

}  // namespace

const char* name_of(ShadingMethod method) {
  constexpr std::array kNames{"flat", "gouraud", "phong", "center", "gouraud, by lines", "phong, by lines"};
  return kNames[static_cast<size_t>(method)];
}

ShadedBall::ShadedBall(ShadingMethod method, const Vec3& axis)
    : method_(method),
      compiled_(make_scene(method, axis)),
      state_(compiled_.scene),
      settings_(settings_of_ball()),
      tables_(settings_, 0),
      integrator_(make_integrator(settings_.lighting)) {
  set_frame(0);
}

void ShadedBall::set_frame(double frame) {
  frame_ = frame;
  pose_.emplace(state_.at(frame));
}

Camera ShadedBall::camera(int side_px) const {
  return make_camera(compiled_.scene, frame_, side_px, side_px);
}

double ShadedBall::intensity(const Ray& ray) {
  if (method_ == ShadingMethod::gouraud_by_lines || method_ == ShadingMethod::phong_by_lines) {
    const Hit hit = closest_hit(compiled_.scene, *pose_, ray);
    return hit.is_hit() ? by_lines(hit, ray.origin + hit.t * ray.direction) : 0;
  }
  const SampleId id;
  RayCounts counts;
  Color color;
  integrator_->trace({compiled_.scene, *pose_, tables_}, RayPacket(std::span(&ray, 1)), std::span(&id, 1),
                     counts, &color);
  return color.x;
}

double ShadedBall::by_lines(const Hit& hit, const Vec3& p) const {
  const Scene& scene = compiled_.scene;
  const MeshFace& face = scene.mesh_faces[hit.primitive.index()];
  const Affine& world = (*pose_)[hit.instance].world_from_object;
  const Camera view = camera(1);
  Gathered<Vec3> points = points_of(scene, face), normals = normals_of(scene, face);
  Gathered<Vec2> seen(face.corner_count);
  for (size_t i = 0; i < face.corner_count; ++i) {
    points[i] = world.point(points[i]);
    normals[i] = normalized(world.vector(normals[i]));  // it only turns
    seen[i] = view.project(points[i])->raster;
  }
  const auto light_at = [&](const Vec3& at, const Vec3& normal) {
    return std::max(0.0, glm::dot(normalized(normal), normalized(eye() - at)));
  };
  const Vec2 place = view.project(p)->raster;
  if (method_ == ShadingMethod::phong_by_lines)
    return light_at(p, along_line<Vec3>(seen.span(), normals.span(), place));
  Gathered<double> light(face.corner_count);
  for (size_t i = 0; i < face.corner_count; ++i) light[i] = light_at(points[i], normals[i]);
  return along_line<double>(seen.span(), light.span(), place);
}

}  // namespace rayfarm
