#include "common/description/primitive_counts.h"

#include <functional>

namespace rayfarm {

PrimitiveCounts count_primitives(const SceneDescription& scene, const ObjectDescription& object) {
  PrimitiveCounts counts;
  if (object.built) {
    const Part& part = scene.libraries[object.built->library].scene.parts[object.built->part];
    counts = {uint64_t{part.triangle_count} + part.polygon_count, part.sphere_count, part.quadric_count};
  }
  for (const PrimitiveDescription& primitive : object.primitives) {
    if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape))
      counts.polygons += mesh->triangles.size() + mesh->polygons.sides.size();
    else if (std::holds_alternative<PolygonShape>(primitive.shape))
      ++counts.polygons;
    else if (std::holds_alternative<SphereShape>(primitive.shape))
      ++counts.spheres;
    else
      ++counts.quadrics;
  }
  return counts;
}

PrimitiveCounts count_copies(const SceneDescription& scene) {
  std::vector<std::optional<PrimitiveCounts>> known(scene.objects.size());
  const std::function<PrimitiveCounts(uint32_t)> count =
      [&](uint32_t object) -> PrimitiveCounts {  // depth is bounded by validate
    if (known[object]) return *known[object];
    PrimitiveCounts sum = count_primitives(scene, scene.objects[object]);
    for (const ChildDescription& child : scene.objects[object].children) sum += count(child.object);
    known[object] = sum;
    return sum;
  };
  return count(scene.root);
}

}  // namespace rayfarm
