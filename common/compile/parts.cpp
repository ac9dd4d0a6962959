#include "common/compile/parts.h"

#include "common/compile/object_groups.h"
#include "common/hierarchy/grid.h"
#include "common/hierarchy/octree.h"
#include "common/scene/array_offsets.h"

namespace rayfarm {
namespace {

Box sphere_box(const SphereRecord& s) {
  return {s.center - Vec3(s.radius), s.center + Vec3(s.radius)};
}

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
      : arrays_(arrays), part_(part) {}
  size_t size() const override { return part_.ids.size(); }

  Box bounds(uint32_t primitive) const override {
    if (part_.is_triangle(primitive)) {
      Box box;
      for (const Vec3& v : triangle(primitive)) box.grow(v);
      return box;
    }
    const PrimitiveId id = part_.ids[primitive];
    switch (id.kind()) {
      case PrimitiveKind::triangle:
      case PrimitiveKind::face:
        break;
      case PrimitiveKind::sphere:
        return sphere_box(arrays_.spheres[id.index()]);
      case PrimitiveKind::polygon: {
        Box box;
        for (const Vec3& p : points(id)) box.grow(p);
        return box;
      }
      case PrimitiveKind::quadric:
        return arrays_.quadrics[id.index()].bounds;
      case PrimitiveKind::collection:
        return arrays_.collections[id.index()].bounds;
    }
    return {};
  }

  Box clipped(uint32_t primitive, const Box& cell) const override {
    if (part_.is_triangle(primitive)) return clipped_bounds(triangle(primitive), cell);
    const PrimitiveId id = part_.ids[primitive];
    switch (id.kind()) {
      case PrimitiveKind::triangle:
      case PrimitiveKind::face:
        break;
      case PrimitiveKind::sphere: {
        const SphereRecord& s = arrays_.spheres[id.index()];
        const Vec3 nearest = glm::clamp(s.center, cell.lo, cell.hi) - s.center;
        if (glm::dot(nearest, nearest) > s.radius * s.radius * (1 + 1e-12)) return {};
        return intersection(sphere_box(s), cell);
      }
      case PrimitiveKind::polygon:
        return clipped_bounds(points(id), cell);
      case PrimitiveKind::quadric:
        return intersection(arrays_.quadrics[id.index()].bounds, cell);
      case PrimitiveKind::collection:
        return intersection(arrays_.collections[id.index()].bounds, cell);
    }
    return {};
  }

  void chop(uint32_t primitive, const Slabs& slabs, size_t first, size_t last,
            Bounds* pieces) const override {
    if (part_.is_triangle(primitive))
      return chop_polygon<glm::vec3>(part_.triangle(primitive), slabs, first, last, pieces);
    const PrimitiveId id = part_.ids[primitive];
    if (id.kind() == PrimitiveKind::polygon) return chop_polygon(points(id), slabs, first, last, pieces);
    PrimitiveSource::chop(primitive, slabs, first, last, pieces);
  }

 private:
  std::array<Vec3, 3> triangle(uint32_t primitive) const {
    const TriangleVertices t = part_.triangle(primitive);
    return {Vec3(t[0]), Vec3(t[1]), Vec3(t[2])};
  }
  std::span<const Vec3> points(PrimitiveId id) const {
    const Polygon& p = arrays_.polygons[id.index()];
    return std::span(arrays_.polygon_points).subspan(p.first_point, p.point_count);
  }
  const SceneArrays<GrowingArray>& arrays_;
  const PartPrimitives& part_;
};

/// The primitives by the names that lists have for them: what was cut into triangles is one again.
class WholePrimitives : public PrimitiveSource {
 public:
  WholePrimitives(const PartSource& pieces, const PartPrimitives& part, const Collection& collection)
      : pieces_(pieces) {
    uint32_t triangle = 8 * collection.first_triangle_block, sphere = 8 * collection.first_sphere_block,
             other = collection.first_leaf_primitive;  // as pack_leaf packs them
    for (uint32_t i = 0; i < part.ids.size(); ++i) {
      const bool is_triangle = part.is_triangle(i);
      const PrimitiveId id = part.ids[i];
      if (i == 0 || id != part.ids[i - 1]) {
        first_.push_back(i);
        pointers_.push_back(is_triangle ? make_pointer(PointerKind::triangle, triangle)
                            : id.kind() == PrimitiveKind::sphere ? make_pointer(PointerKind::sphere, sphere)
                                                                 : make_pointer(PointerKind::other, other));
      }
      ++(is_triangle ? triangle : id.kind() == PrimitiveKind::sphere ? sphere : other);
    }
    first_.push_back(static_cast<uint32_t>(part.ids.size()));
  }
  size_t size() const override { return pointers_.size(); }
  Box bounds(uint32_t primitive) const override {
    return union_of(primitive, [&](uint32_t piece) { return pieces_.bounds(piece); });
  }
  Box clipped(uint32_t primitive, const Box& cell) const override {
    return union_of(primitive, [&](uint32_t piece) { return pieces_.clipped(piece, cell); });
  }
  std::span<const PrimitivePointer> pointers() const { return pointers_; }

 private:
  template <typename BoxOf>
  Box union_of(uint32_t primitive, BoxOf box_of) const {
    Box box;
    for (uint32_t piece = first_[primitive]; piece < first_[primitive + 1]; ++piece) box.grow(box_of(piece));
    return box;
  }
  const PartSource& pieces_;
  std::vector<uint32_t> first_;  ///< piece of each, and one more
  std::vector<PrimitivePointer> pointers_;
};

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
                            const SceneDescription& description, const BuildOptions& options,
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
  const bool has_volumes = options.hierarchy == Hierarchy::sah || options.hierarchy == Hierarchy::thesis;
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
  if (has_volumes || options.hierarchy == Hierarchy::brute) return collection;
  if (options.hierarchy == Hierarchy::object) {
    if (placed) {
      *placed = std::move(objects);
      return collection;
    }
    collection.structure = Structure::object;
    collection.tree =
        build_bounding_tree(element_of(group, objects, description), options.objects, std::nullopt, arrays);
    return collection;
  }
  const WholePrimitives whole(source, primitives, collection);
  collection.has_mailbox = options.has_mailbox ? 1 : 0;
  if (options.hierarchy == Hierarchy::regular) {
    collection.structure = Structure::regular;
    collection.grid = build_grid(whole, whole.pointers(), options, arrays);
  } else {
    collection.structure = Structure::adaptive;
    collection.octree = build_octree(whole, whole.pointers(), options, arrays);
  }
  return collection;
}

}  // namespace

Part build_part(SceneArrays<GrowingArray>& arrays, std::vector<PrimitiveGroup>& groups,
                const SceneDescription& description, const BuildOptions& options, std::vector<bool>& is_used,
                std::vector<PlacedObject>* placed) {
  Part part;
  const ArrayOffsets begin = offsets_behind(arrays);
  for (size_t i = groups.size(); i-- > 0;) {  // what is in a group stands behind it
    const PartPrimitives& primitives = groups[i].primitives;
    const uint32_t structure = groups[i].structure;
    if (primitives.ids.empty()) continue;
    BuildOptions build = options;
    if (structure != kNone) {
      is_used[structure] = true;
      build = description.structures[structure].build;
      build.progress = options.progress;
      build.stop = options.stop;
    }
    count_primitives(primitives, part);
    const Collection collection =
        build_collection(arrays, groups[i], description, build, i == 0 ? placed : nullptr);
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
