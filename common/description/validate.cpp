#include <cmath>
#include <functional>

#include "common/description/scene_description.h"
#include "common/shapes/polygon.h"

namespace rayfarm {
namespace {

constexpr size_t kMostProblems = 20;  // as YAML's

[[noreturn]] void fail(const SceneDescription& scene, const Place& place, const std::string& problem) {
  throw InputError(scene.source(place), problem);
}

/// How much there is of what meshes change their shape by.
struct DeformationSizes {
  size_t influences = 0, deltas = 0;
};

/// That indices are in range, for whatever loader.
void check_deformation(const SceneDescription& scene, const Place& at, const MeshShape& mesh,
                       DeformationSizes& sizes) {
  const DeformationDescription& d = *mesh.deformation;
  const size_t vertices = mesh.positions.size();
  const auto require = [&](bool holds, const char* what) {
    if (!holds) fail(scene, at, fmt::format("{} of a mesh that changes its shape", what));
  };
  require(mesh.normals.empty() || mesh.normals.size() == vertices, "the number of normals");
  require(mesh.triangle_normals.empty() || mesh.triangle_normals == mesh.triangles, "the corners' normals");
  if (d.skeleton != kNone) {
    require(d.skeleton < scene.skeletons.size(), "the skeleton");
    const SkeletonDescription& skeleton = scene.skeletons[d.skeleton];
    for (const DeformationDescription::Joint& joint : d.joints)
      require(joint.bone < skeleton.bones.size(), "a joint");
  }
  const size_t joints = d.skeleton == kNone ? 0 : d.joints.size();
  require(d.influences <= limits::kInfluences / std::max<size_t>(vertices, 1), "the number of influences");
  sizes.influences += vertices * d.influences;
  require(sizes.influences <= limits::kInfluences, "the number of influences");
  require(d.joint_of.size() == vertices * d.influences && d.weights.size() == vertices * d.influences,
          "the number of influences");
  for (size_t i = 0; i < d.weights.size(); ++i)
    require(std::isfinite(d.weights[i]) && d.weights[i] >= 0 && (d.weights[i] == 0 || d.joint_of[i] < joints),
            "an influence");
  for (const DeformationDescription::Target& target : d.targets) {
    sizes.deltas += target.deltas.size();
    require(sizes.deltas <= limits::kMorphDeltas, "the number of morph targets' vertices");
    for (const DeformationDescription::Delta& delta : target.deltas)
      require(delta.vertex < vertices, "a morph target's vertex");
  }
}

void check_shape(const SceneDescription& scene, const PrimitiveDescription& primitive,
                 DeformationSizes& sizes) {
  const Place& at = primitive.place;
  if (primitive.material >= scene.materials.size()) fail(scene, at, "a material that doesn't exist");
  if (const auto* sphere = std::get_if<SphereShape>(&primitive.shape)) {
    if (!(sphere->radius > 0))
      fail(scene, at, fmt::format("a sphere's radius must be above 0, not {:g}", sphere->radius));
  } else if (const auto* cone = std::get_if<ConeShape>(&primitive.shape)) {
    if (cone->base == cone->apex)
      fail(scene, at, "the two ends of a cone or cylinder must not be the same point");
    if (cone->base_radius < 0 || cone->apex_radius < 0 || cone->base_radius + cone->apex_radius == 0)
      fail(scene, at, "the radii of a cone or cylinder must not be negative, nor both 0");
  } else if (const auto* quadric = std::get_if<QuadricShape>(&primitive.shape)) {
    if (quadric->planes.size() > limits::kQuadricPlanes)
      fail(scene, at, fmt::format("a quadric can be cut by at most {} planes", limits::kQuadricPlanes));
    for (const Vec4& p : quadric->planes)
      if (max_magnitude(Vec3(p)) == 0) fail(scene, at, "a plane's normal must not be the zero vector");
    const auto& c = quadric->coefficients;
    if (std::all_of(c.begin(), c.begin() + 9, [](double v) { return v == 0; }))
      fail(scene, at, "the first nine coefficients of a quadric must not all be 0: that is no surface");
  } else if (const auto* patch = std::get_if<PatchShape>(&primitive.shape)) {
    if (is_planar(patch->corners))
      fail(scene, at, "the corners of a patch lie in a plane; make it a polygon");
  } else if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape)) {
    if (mesh->deformation) check_deformation(scene, at, *mesh, sizes);
  } else if (const auto* polygon = std::get_if<PolygonShape>(&primitive.shape)) {
    if (polygon->points.size() < 3)
      fail(scene, at, fmt::format("a polygon needs at least 3 points, not {}", polygon->points.size()));
    if (polygon->points.size() > limits::kPolygonPoints) fail(scene, at, "the polygon has too many points");
    if (polygon->points.size() == 3) return;
    const Vec3 normal = normalized(newell_normal(polygon->points));
    if (max_magnitude(normal) == 0) return;  // no area: dropped when compiled
    Box box;
    for (const Vec3& p : polygon->points) box.grow(p);
    // Files carry about six digits, so a corner may stand off its plane by that much of its coordinates.
    const double tolerance = 1e-4 * max_component(box.extent()) + 1e-5 * box.magnitude();
    const Vec3 center = box.center();
    double sum = 0;
    for (const Vec3& p : polygon->points) sum += glm::dot(normal, p - center);
    const double mean = sum / static_cast<double>(polygon->points.size());
    for (size_t i = 0; i < polygon->points.size(); ++i) {
      const double off = std::abs(glm::dot(normal, polygon->points[i] - center) - mean);
      if (off > tolerance)
        fail(scene, at,
             fmt::format("the polygon is not planar: point {} stands {:g} off the plane of the others; "
                         "split it into triangles",
                         i + 1, off));
    }
  }
}

void check_cycles_and_depth(const SceneDescription& scene) {
  enum class Visit : uint8_t { fresh, open, done };
  std::vector<Visit> visits(scene.objects.size(), Visit::fresh);
  std::vector<size_t> height(scene.objects.size(), 0);
  std::vector<uint32_t> path;
  // An explicit stack: the depth of the input must not become the depth of this program's stack.
  struct Frame {
    uint32_t object;
    size_t next_child;
  };
  for (uint32_t start = 0; start < scene.objects.size(); ++start) {
    if (visits[start] != Visit::fresh) continue;
    std::vector<Frame> stack{{start, 0}};
    visits[start] = Visit::open;
    while (!stack.empty()) {
      Frame& frame = stack.back();
      const ObjectDescription& object = scene.objects[frame.object];
      if (frame.next_child == object.children.size()) {
        visits[frame.object] = Visit::done;
        const uint32_t finished = frame.object;
        stack.pop_back();
        if (!stack.empty())
          height[stack.back().object] = std::max(height[stack.back().object], height[finished] + 1);
        if (height[finished] > limits::kObjectDepth)
          fail(scene, object.place,
               fmt::format("objects are nested more than {} deep", limits::kObjectDepth));
        continue;
      }
      const ChildDescription& child = object.children[frame.next_child++];
      if (child.object >= scene.objects.size()) fail(scene, child.place, "a child object that doesn't exist");
      if (visits[child.object] == Visit::open) {
        std::string cycle;
        bool inside = false;
        for (const Frame& f : stack) {
          inside = inside || f.object == child.object;
          if (inside) cycle += scene.objects[f.object].name + " → ";
        }
        fail(scene, child.place,
             fmt::format("an object contains itself: {}{}; break the circle", cycle,
                         scene.objects[child.object].name));
      }
      if (visits[child.object] == Visit::done) {
        height[frame.object] = std::max(height[frame.object], height[child.object] + 1);
      } else {
        visits[child.object] = Visit::open;
        stack.push_back({child.object, 0});
      }
    }
  }
}

}  // namespace

size_t count_instances(const SceneDescription& scene, size_t most) {
  std::vector<size_t> counts(scene.objects.size(), 0);
  std::vector<bool> known(scene.objects.size(), false);
  const std::function<size_t(uint32_t)> count =
      [&](uint32_t object) -> size_t {  // depth is bounded by validate
    if (known[object]) return counts[object];
    size_t total = 1;  // every object becomes a node of the expanded tree
    for (const ChildDescription& child : scene.objects[object].children)
      total = std::min(most + 1, total + count(child.object));
    known[object] = true;
    return counts[object] = total;
  };
  return count(scene.root);
}

void ClipSearch::check() const {
  if (is_found || missing.empty()) return;
  std::string lines;
  for (size_t i = 0; i < missing.size() && i < kMostProblems; ++i) lines += (i > 0 ? "\n" : "") + missing[i];
  throw InputError(lines);
}

void validate(const SceneDescription& scene, const std::stop_token& stop) {
  scene.clip.check();
  size_t bones = 0;
  for (const SkeletonDescription& skeleton : scene.skeletons) {
    bones += skeleton.bones.size();
    if (bones > limits::kBones) fail(scene, skeleton.place, "the scene has too many bones");
    for (size_t i = 0; i < skeleton.bones.size(); ++i)
      if (skeleton.bones[i].parent != kNone && skeleton.bones[i].parent >= i)
        fail(scene, skeleton.place, "a bone that stands before the one that it hangs on");
  }
  size_t primitives = 0;
  DeformationSizes sizes;
  for (const ObjectDescription& object : scene.objects) {
    for (const PrimitiveDescription& p : object.primitives) {
      throw_if_stopped(stop);
      check_shape(scene, p, sizes);
    }
    primitives += object.primitives.size();
    if (primitives > limits::kPrimitives) fail(scene, object.place, "the scene has too many primitives");
  }
  check_cycles_and_depth(scene);
  if (count_instances(scene, limits::kInstances) > limits::kInstances)
    fail(scene, scene.objects[scene.root].place,
         fmt::format("the object tree expands to more than {} objects; use fewer copies of copies",
                     limits::kInstances));
  for (const MaterialDescription& m : scene.materials)
    if (!is_finite(m.color) || !std::isfinite(m.shininess) || m.shininess < 0)
      throw InputError(
          {scene.files.at(0)},
          fmt::format("material '{}': the shininess must be 0 or more and all numbers finite", m.name));
}

}  // namespace rayfarm
