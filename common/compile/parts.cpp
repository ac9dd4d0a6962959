#include "common/compile/parts.h"

#include "common/compile/object_groups.h"
#include "common/hierarchy/grid.h"
#include "common/hierarchy/octant_tree.h"
#include "common/hierarchy/octree.h"
#include "common/hierarchy/primitive_bounds.h"
#include "common/scene/array_offsets.h"

namespace rayfarm {
namespace {

/// Follows the outline, whose bounds in a slab are those of what lies in it.
template <typename Point>
void chop_polygon(std::span<const Point> points, const Slabs& slabs, size_t first, size_t last,
                  Bounds* pieces) {
  const size_t axis = slabs.axis;
  const auto lanes = [](const Point& p) {
    return FourFloats{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), 0};
  };
  const auto along = [axis](const Point& p) { return static_cast<float>(p[static_cast<int>(axis)]); };
  FourFloats p = lanes(points.back());
  float p_along = along(points.back());
  size_t at_p = slabs.index(p_along);
  for (const Point& point : points) {
    const FourFloats q = lanes(point);
    const float q_along = along(point);
    const size_t at_q = slabs.index(q_along);
    if (first <= at_q && at_q <= last) pieces[at_q].grow(q, q);
    // From plane i one comes from slab i - 1 into slab i.
    const size_t begin = std::max(std::min(at_p, at_q) + 1, first),
                 end = std::min(std::max(at_p, at_q), last + 1);
    if (begin <= end) {
      const FourFloats way = q - p;
      const float per_way = 1 / (q_along - p_along);
      for (size_t i = begin; i <= end; ++i) {
        const float t = std::clamp((slabs.plane(i) - p_along) * per_way, 0.0f, 1.0f);
        const FourFloats crossing = p + t * way;
        if (i > first) pieces[i - 1].grow(crossing, crossing);
        if (i <= last) pieces[i].grow(crossing, crossing);
      }
    }
    p = q;
    p_along = q_along;
    at_p = at_q;
  }
}

/// The primitives of one part, for the builder.
class PartSource : public PrimitiveSource {
 public:
  PartSource(const SceneArrays<GrowingArray>& arrays, const PartPrimitives& part)
      : shapes_(view_of(arrays)), part_(part) {}
  size_t size() const override { return part_.ids.size(); }

  Box bounds(uint32_t primitive) const override {
    if (part_.is_triangle(primitive)) {
      Box box;
      for (const Vec3& v : triangle(primitive)) box.grow(v);
      return box;
    }
    return bounds_of(shapes_, part_.ids[primitive]);
  }

  Box clipped(uint32_t primitive, const Box& cell) const override {
    if (part_.is_triangle(primitive)) return clipped_bounds(triangle(primitive), cell);
    return clipped_to(shapes_, part_.ids[primitive], cell);
  }

  void chop(uint32_t primitive, const Slabs& slabs, size_t first, size_t last,
            Bounds* pieces) const override {
    if (part_.is_triangle(primitive))
      return chop_polygon<glm::vec3>(part_.triangle(primitive), slabs, first, last, pieces);
    const PrimitiveId id = part_.ids[primitive];
    if (id.kind() == PrimitiveKind::polygon)
      return chop_polygon(shapes_.points_of(shapes_.polygons[id.index()]), slabs, first, last, pieces);
    PrimitiveSource::chop(primitive, slabs, first, last, pieces);
  }

 private:
  std::array<Vec3, 3> triangle(uint32_t primitive) const {
    const TriangleVertices t = part_.triangle(primitive);
    return {Vec3(t[0]), Vec3(t[1]), Vec3(t[2])};
  }
  Scene shapes_;  ///< all that are there as the part is built
  const PartPrimitives& part_;
};

/// The names that lists have for the primitives: what was cut into triangles is one again.
std::vector<PrimitivePointer> pointers_to(const PartPrimitives& part, const Collection& collection) {
  std::vector<PrimitivePointer> pointers;
  uint32_t triangle = 8 * collection.first_triangle_block, sphere = 8 * collection.first_sphere_block,
           other = collection.first_leaf_primitive;  // as pack_leaf packs them
  for (uint32_t i = 0; i < part.ids.size(); ++i) {
    const bool is_triangle = part.is_triangle(i);
    const PrimitiveId id = part.ids[i];
    if (i == 0 || id != part.ids[i - 1])
      pointers.push_back(is_triangle                          ? make_pointer(PointerKind::triangle, triangle)
                         : id.kind() == PrimitiveKind::sphere ? make_pointer(PointerKind::sphere, sphere)
                                                              : make_pointer(PointerKind::other, other));
    ++(is_triangle ? triangle : id.kind() == PrimitiveKind::sphere ? sphere : other);
  }
  return pointers;
}

template <typename Array>
uint32_t count_behind(const Array& array, uint32_t first) {
  return static_cast<uint32_t>(array.size()) - first;
}

/// Those of whole primitives: what was cut into triangles is one.
void count_primitives(const PartPrimitives& primitives, Part& part) {
  const std::array<uint32_t*, 5> counts{&part.triangle_count, &part.sphere_count, &part.polygon_count,
                                        &part.quadric_count,
                                        &part.polygon_count};  // in the order of PrimitiveKind
  PrimitiveId previous = kNoPrimitive;
  for (const PrimitiveId id : primitives.ids) {
    if (id != previous && id.kind() != PrimitiveKind::collection) ++*counts[static_cast<size_t>(id.kind())];
    previous = id;
  }
}

/// Builds the hierarchy over the primitives of `group`, which are not empty. `placed`: as of build_part.
Collection build_collection(SceneArrays<GrowingArray>& arrays, const PrimitiveGroup& group,
                            const SceneDescription& description, const BuildOptions& options, InUse& in_use,
                            std::vector<PlacedObject>* placed) {
  const PartPrimitives& primitives = group.primitives;
  Collection collection;
  collection.first_triangle_block = static_cast<uint32_t>(arrays.triangle_blocks.size());
  collection.first_sphere_block = static_cast<uint32_t>(arrays.sphere_blocks.size());
  collection.first_leaf_primitive = static_cast<uint32_t>(arrays.leaf_primitives.size());
  const PartSource source(arrays, primitives);
  for (uint32_t i = 0; i < primitives.ids.size(); ++i) collection.bounds.grow(source.bounds(i));
  // Leaves are half full or more; rooms that stay empty take no memory.
  make_room(arrays.triangle_blocks, primitives.ids.size() / 4 + 1);
  make_room(arrays.nodes, primitives.ids.size() / 16 + 1);
  LeafArrays leaves{arrays.nodes, arrays.triangle_blocks, arrays.sphere_blocks, arrays.leaf_primitives};
  const auto make_leaf = [&](std::span<const PrimitiveReference> r) {
    throw_if_stopped(options.stop);
    return pack_leaf(r, primitives, arrays.spheres, leaves);
  };
  const bool has_volumes =
      options.hierarchy == Hierarchy::sah ||
      (options.hierarchy == Hierarchy::thesis && options.thesis.volumes == ThesisVolumes::boxes);
  collection.structure = has_volumes ? Structure::volumes : Structure::list;
  std::vector<PlacedObject> objects;
  if (has_volumes)
    collection.root = build_hierarchy(source, options, make_leaf, arrays.nodes);
  else if (options.hierarchy == Hierarchy::object)
    collection.root = pack_objects(group, make_references(source, options), arrays, objects);
  else
    collection.root = make_leaf(make_references(source, options));
  collection.triangle_block_count = count_behind(arrays.triangle_blocks, collection.first_triangle_block);
  collection.sphere_block_count = count_behind(arrays.sphere_blocks, collection.first_sphere_block);
  collection.leaf_primitive_count = count_behind(arrays.leaf_primitives, collection.first_leaf_primitive);
  if (options.hierarchy == Hierarchy::object) {
    if (placed) {
      *placed = std::move(objects);
      return collection;
    }
    collection.structure = Structure::object;
    collection.tree = build_bounding_tree(element_of(group, objects, description, in_use), options.objects,
                                          std::nullopt, arrays);
    return collection;
  }
  if (has_volumes || options.hierarchy == Hierarchy::brute) return collection;
  const std::vector<PrimitivePointer> pointers = pointers_to(primitives, collection);
  const Scene packed = view_of(arrays);
  const PointedPrimitives whole(packed, collection.bounds, pointers);
  collection.has_mailbox = options.has_mailbox ? 1 : 0;
  if (options.hierarchy == Hierarchy::regular) {
    collection.structure = Structure::regular;
    collection.grid = build_grid(whole, pointers, options, arrays);
  } else if (options.hierarchy == Hierarchy::adaptive) {
    collection.structure = Structure::adaptive;
    collection.octree = build_octree(whole, pointers, options, arrays);
  } else {
    collection.structure = Structure::octants;
    collection.octants = build_octant_tree(whole, pointers, options, arrays);
  }
  return collection;
}

}  // namespace

Part build_part(SceneArrays<GrowingArray>& arrays, std::vector<PrimitiveGroup>& groups,
                const SceneDescription& description, const BuildOptions& options, InUse& in_use,
                std::vector<PlacedObject>* placed) {
  Part part;
  const ArrayOffsets begin = offsets_behind(arrays);
  for (size_t i = groups.size(); i-- > 0;) {  // what is in a group stands behind it
    const PartPrimitives& primitives = groups[i].primitives;
    const uint32_t structure = groups[i].structure;
    if (primitives.ids.empty()) continue;
    BuildOptions build = options;
    if (structure != kNone) {
      in_use.structures[structure] = true;
      build = description.structures[structure].build;
      build.progress = options.progress;
      build.stop = options.stop;
    }
    count_primitives(primitives, part);
    const Collection collection =
        build_collection(arrays, groups[i], description, build, in_use, i == 0 ? placed : nullptr);
    if (i == 0) {
      part.collection = collection;
    } else {
      PrimitiveGroup& outer = groups[groups[i].parent];
      outer.objects.push_back(
          {groups[i].owner, groups[i].owner_in, static_cast<uint32_t>(outer.primitives.ids.size()), 1});
      outer.primitives.add(
          make_primitive_id(PrimitiveKind::collection, static_cast<uint32_t>(arrays.collections.size())));
      arrays.collections.push_back(collection);
    }
  }
  part.first_triangle_block = begin.triangle_blocks;
  part.first_sphere_block = begin.sphere_blocks;
  part.first_leaf_primitive = begin.leaf_primitives;
  part.triangle_block_count = count_behind(arrays.triangle_blocks, begin.triangle_blocks);
  part.sphere_block_count = count_behind(arrays.sphere_blocks, begin.sphere_blocks);
  part.leaf_primitive_count = count_behind(arrays.leaf_primitives, begin.leaf_primitives);
  return part;
}

}  // namespace rayfarm
