#include "common/compile/parts.h"

namespace rayfarm {
namespace {

Box sphere_box(const SphereRecord& s) {
  return {s.center - Vec3(s.radius), s.center + Vec3(s.radius)};
}

/// Follows the outline, whose bounds in a slab are those of what lies in it.
template <typename Point>
void chop_polygon(std::span<const Point> points, const Slabs& slabs, size_t first, size_t last,
                  Bounds* pieces) {
  using Number = typename Point::value_type;
  const auto axis = static_cast<int>(slabs.axis);
  const auto grow = [&](size_t slab, const Point& p) {
    if (slab < first || slab > last) return;
    const std::array<float, 4> at{static_cast<float>(p[0]), static_cast<float>(p[1]),
                                  static_cast<float>(p[2]), 0};
    pieces[slab].grow(at.data(), at.data());
  };
  for (size_t k = 0; k < points.size(); ++k) {
    const Point &p = points[k], &q = points[k + 1 < points.size() ? k + 1 : 0];
    const size_t from = slabs.index(static_cast<float>(p[axis])),
                 to = slabs.index(static_cast<float>(q[axis]));
    grow(from, p);
    for (size_t i = std::min(from, to); i < std::max(from, to); ++i) {
      const auto plane = static_cast<Number>(slabs.plane(i + 1));
      const Number t = (plane - p[axis]) / (q[axis] - p[axis]);
      Point crossing = p + std::clamp<Number>(t, 0, 1) * (q - p);
      crossing[axis] = plane;
      grow(i, crossing);
      grow(i + 1, crossing);
    }
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

}  // namespace

Part build_part(SceneArrays<GrowingArray>& arrays, const PartPrimitives& primitives,
                const BuildOptions& options) {
  Part part;
  part.structure = options.structure;
  part.first_triangle_block = static_cast<uint32_t>(arrays.triangle_blocks.size());
  part.first_sphere_block = static_cast<uint32_t>(arrays.sphere_blocks.size());
  part.first_leaf_primitive = static_cast<uint32_t>(arrays.leaf_primitives.size());
  const PartSource source(arrays, primitives);
  // Leaves are half full or more; rooms that stay empty take no memory.
  make_room(arrays.triangle_blocks, primitives.ids.size() / 4 + 1);
  make_room(arrays.nodes, primitives.ids.size() / 16 + 1);
  LeafArrays leaves{arrays.nodes, arrays.triangle_blocks, arrays.sphere_blocks, arrays.leaf_primitives};
  part.root = build_hierarchy(
      source, options,
      [&](std::span<const PrimitiveReference> r) {
        throw_if_stopped(options.stop);
        return pack_leaf(r, primitives, arrays.spheres, leaves);
      },
      arrays.nodes);
  part.triangle_block_count =
      static_cast<uint32_t>(arrays.triangle_blocks.size()) - part.first_triangle_block;
  part.sphere_block_count = static_cast<uint32_t>(arrays.sphere_blocks.size()) - part.first_sphere_block;
  part.leaf_primitive_count =
      static_cast<uint32_t>(arrays.leaf_primitives.size()) - part.first_leaf_primitive;
  const std::array<uint32_t*, 5> counts{&part.triangle_count, &part.sphere_count, &part.polygon_count,
                                        &part.quadric_count,
                                        &part.polygon_count};  // in the order of PrimitiveKind
  PrimitiveId previous = kNoPrimitive;
  for (uint32_t i = 0; i < primitives.ids.size(); ++i) {
    part.bounds.grow(source.bounds(i));
    const PrimitiveId id = primitives.ids[i];
    if (id == previous) continue;  // another triangle of the same polygon
    previous = id;
    ++*counts[static_cast<size_t>(id.kind())];
  }
  return part;
}

}  // namespace rayfarm
