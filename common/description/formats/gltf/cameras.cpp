#include "common/description/formats/gltf/cameras.h"

#include <fmt/core.h>

#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// Between frames a camera that moves is where a straight line leads; clips are shorter, or have so many
/// keys.
constexpr int kMostKeys = 100'000;

/// What its place in the world is made of: the transforms of the nodes, from the scene down.
class CameraPath {
 public:
  CameraPath(const GltfAnimation& animation, const std::vector<uint32_t>& nodes) {
    for (const uint32_t node : nodes) steps_.push_back(animation.transform_of(node));
  }
  bool moves() const {
    return std::any_of(steps_.begin(), steps_.end(), [](const std::vector<TransformStep>& steps) {
      return std::any_of(steps.begin(), steps.end(),
                         [](const TransformStep& s) { return s.curve.is_animated(); });
    });
  }
  Affine at(double frame) const {
    Affine world;
    for (const std::vector<TransformStep>& steps : steps_) world = world * eval_steps(steps, frame);
    return world;
  }

 private:
  std::vector<std::vector<TransformStep>> steps_;
};

/// A camera looks along its -z, with y up.
void place_view(const CameraPath& path, std::optional<std::array<int, 2>> frames, ViewDescription& view) {
  view.location = view.direction = view.up = {};
  view.direction.interpolation = view.up.interpolation = Interpolation::spherical;
  const int last = path.moves() && frames ? (*frames)[1] : 0, step = last / kMostKeys + 1;
  for (int frame = 0; frame < last + step; frame += step) {
    const Affine world = path.at(frame);
    const auto add = [&](Curve& curve, const Vec3& value) {
      curve.frames.push_back(frame);
      curve.values.emplace_back(value, 0);
    };
    add(view.location, world.translation);
    add(view.direction, normalized(-world.linear[2]));
    add(view.up, normalized(world.linear[1]));
  }
}

void read_projection(const GltfValue& camera, ViewDescription& view) {
  const std::string type = camera.at("type").text();
  if (type == "perspective") {
    const GltfValue lens = camera.at("perspective");
    lens.at("yfov");
    const double yfov = lens.number_in("yfov", 1, 1e-6, pi - 1e-6);
    view.aspect = lens.number_in("aspectRatio", 4.0 / 3, 1e-4, 1e4);
    const double across = view.aspect * portable_tan(yfov / 2);
    // The angle whose tangent is `across`.
    view.field_of_view =
        constant_curve(Vec4(360 / pi * portable_acos(1 / std::sqrt(1 + across * across)), 0, 0, 0));
    view.near = lens.number_in("znear", 0, 0, 1e30);
    if (lens.has("zfar")) view.far = lens.number_in("zfar", 1, 1e-30, 1e300);
  } else if (type == "orthographic") {
    const GltfValue lens = camera.at("orthographic");
    lens.at("xmag");
    lens.at("ymag");
    const double x = std::abs(lens.number("xmag", 1)), y = std::abs(lens.number("ymag", 1));
    if (!(x > 1e-12 && y > 1e-12 && x < 1e15 && x / y < 1e4 && y / x < 1e4))
      lens.fail("xmag and ymag, half the width and height of what is seen, were expected to be of one kind");
    view.projection = Projection::orthographic;
    view.width = constant_curve(Vec4(2 * x, 0, 0, 0));
    view.aspect = x / y;
    view.near = lens.number_in("znear", 0, 0, 1e30);
    view.far = lens.number_in("zfar", 1e300, 1e-30, 1e300);
  } else {
    camera.at("type").fail("perspective or orthographic was expected");
  }
  if (!(view.near < view.far)) camera.fail("its znear is not before its zfar, so that it sees nothing");
}

}  // namespace

void list_cameras(const GltfFile& file, const std::vector<GltfPlacedCamera>& cameras,
                  SceneDescription& scene) {
  const auto is_of_file = [&](const CameraDescription& camera) { return camera.file == file.path(); };
  if (std::any_of(scene.cameras.begin(), scene.cameras.end(), is_of_file)) return;  // it is used twice
  for (size_t i = 0; i < cameras.size(); ++i)
    scene.cameras.push_back({file.path(), i, cameras[i].name, false});
}

void set_view(const GltfFile& file, const GltfAnimation& animation,
              const std::vector<GltfPlacedCamera>& cameras, SceneDescription& scene) {
  std::vector<std::string> names;
  for (const GltfPlacedCamera& camera : cameras) names.push_back(camera.name);
  const std::string& wanted = file.options().camera;
  list_cameras(file, cameras, scene);
  if (wanted.empty() && cameras.empty()) return;
  const size_t choice = wanted.empty() ? 0 : file.find_choice("camera", wanted, names);
  const GltfPlacedCamera* const chosen = &cameras[choice];
  scene.cameras[choice].is_view = true;  // the file is the scene: no other has cameras in it
  if (wanted.empty() && cameras.size() > 1)
    scene.notes.add({file.path()},
                    fmt::format("the view is the first of {} cameras, '{}'; --camera chooses another",
                                cameras.size(), chosen->name));
  place_view(CameraPath(animation, chosen->nodes), animation.frames(), scene.view);
  read_projection(file.item("cameras", chosen->camera), scene.view);
  scene.has_view = true;
}

}  // namespace rayfarm
