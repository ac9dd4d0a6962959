// What a loader made of a file, in numbers that other programs can find for themselves. mesh_facts FILE FRAME
// prints triangles, bounds and area in the world as a line of JSON; shapes change as the description says,
// not as the renderer does it. mesh_facts FILE FRAME WIDTH HEIGHT CAMERA CLIP [X Y Z X Y Z DEGREES] prints
// what the renderer meets (first_hits.h), by the camera and in the clip of these names or numbers ('': the
// first), or seen from a point towards another. A frame is a millisecond.
#include <fmt/core.h>

#include "common/description/scene_description.h"
#include "tests/jobs/first_hits.h"

namespace rayfarm {
namespace {

struct Facts {
  uint64_t triangles = 0;
  Box bounds;
  double area = 0;
};

Affine eval_all(const std::vector<TransformStep>& steps, double frame) {
  Affine all;
  for (const TransformStep& s : steps)
    all = eval_transform(s.kind, eval_curve(s.curve.interpolation, s.curve.frames, s.curve.values, frame),
                         s.axis, s.matrix) *
          all;
  return all;
}

std::vector<Vec3> positions_of(const SceneDescription& scene, const MeshShape& mesh, double frame) {
  std::vector<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
  const DeformationDescription* const d = mesh.deformation.get();
  if (!d) return positions;
  for (const auto& target : d->targets) {
    const Curve& w = target.weight;
    const double weight = eval_curve(w.interpolation, w.frames, w.values, frame).x;
    for (const auto& delta : target.deltas) positions[delta.vertex] += weight * Vec3(delta.position);
  }
  if (d->skeleton == kNone) return positions;
  std::vector<Affine> bones;
  for (const auto& bone : scene.skeletons[d->skeleton].bones) {
    const Affine own = eval_all(bone.transform, frame);
    bones.push_back(bone.parent == kNone ? own : bones[bone.parent] * own);
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    Vec3 sum(0);
    double weights = 0;
    for (size_t k = i * d->influences; k < (i + 1) * d->influences; ++k) {
      const auto weight = static_cast<double>(d->weights[k]);
      const auto& joint = d->joints[d->joint_of[k]];
      sum += weight * (bones[joint.bone] * joint.bone_from_mesh).point(positions[i]);
      weights += weight;
    }
    positions[i] = sum / weights;
  }
  return positions;
}

void add(const SceneDescription& scene, uint32_t object, const Affine& world, double frame, Facts& facts) {
  for (const PrimitiveDescription& p : scene.objects[object].primitives) {
    const auto* const found = std::get_if<MeshShape>(&p.shape);
    if (!found) continue;  // ground and lamp of a model that has none
    const MeshShape& mesh = *found;
    std::vector<Vec3> positions = positions_of(scene, mesh, frame);
    for (Vec3& position : positions) position = world.point(position);
    facts.triangles += mesh.triangles.size();
    for (const glm::uvec3& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) facts.bounds.grow(positions[t[k]]);
      const Vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
      facts.area += glm::length(glm::cross(b - a, c - a)) / 2;
    }
  }
  for (const ChildDescription& child : scene.objects[object].children)
    add(scene, child.object, world * eval_all(child.transform, frame), frame, facts);
}

}  // namespace
}  // namespace rayfarm

namespace rayfarm {
namespace {

void print_facts(const SceneDescription& scene, double frame) {
  Facts facts;
  add(scene, scene.root, {}, frame, facts);
  const Box& b = facts.bounds;
  fmt::print(
      "{{\"triangles\": {}, \"low\": [{}, {}, {}], \"high\": [{}, {}, {}], \"area\": {}, \"last\": {}}}\n",
      facts.triangles, b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z, facts.area,
      scene.frames ? (*scene.frames)[1] : 0);
}

}  // namespace
}  // namespace rayfarm

int main(int argc, char** argv) {
  using namespace rayfarm;
  if (argc != 3 && argc != 7 && argc != 14) return 2;
  try {
    LoadOptions options;
    options.fps = 1000;  // so that the frame is the time in milliseconds
    if (argc == 3) {
      print_facts(load_scene(argv[1], options), std::stod(argv[2]));
      return 0;
    }
    options.camera = argv[5];
    options.clip = argv[6];
    SceneDescription scene = load_scene(argv[1], options);
    std::optional<SimpleView> view;
    if (argc == 14) {
      const auto number = [&](int i) { return std::stod(argv[i]); };
      view = {{number(7), number(8), number(9)}, {number(10), number(11), number(12)}, number(13)};
    }
    print_first_hits(scene, std::stoi(argv[2]), std::stoi(argv[3]), std::stoi(argv[4]), view);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 3;
  }
  return 0;
}
