#include "common/hierarchy/primitive_bounds.h"

#include "common/hierarchy/cells.h"

namespace rayfarm {
namespace {

Box sphere_box(const SphereRecord& s) {
  return {s.center - Vec3(s.radius), s.center + Vec3(s.radius)};
}

/// Of one that is not made of triangles.
PrimitiveId id_of(const Scene& scene, PrimitivePointer pointer) {
  const uint32_t place = pointer.place();
  if (pointer.kind() == PointerKind::other) return scene.leaf_primitives[place];
  return make_primitive_id(PrimitiveKind::sphere, scene.sphere_blocks[place / 8].spheres[place % 8]);
}

/// Calls visit(corners) for the triangles of a primitive.
template <typename Visit>
void for_each_triangle(const Scene& scene, PrimitivePointer pointer, Visit visit) {
  const auto id_at = [&](uint32_t place) { return scene.triangle_blocks[place / 8].primitives[place % 8]; };
  const PrimitiveId id = id_at(pointer.place());
  for (uint32_t i = pointer.place(); i / 8 < scene.triangle_blocks.size() && id_at(i) == id; ++i) {
    const TriangleBlock& block = scene.triangle_blocks[i / 8];
    std::array<Vec3, 3> corners;
    for (size_t v = 0; v < 3; ++v)
      for (size_t axis = 0; axis < 3; ++axis)
        corners[v][static_cast<int>(axis)] = block.vertices[v][axis][i % 8];
    visit(corners);
  }
}

/// True where the surface is known to pass a cell by that may lie in its box.
bool passes_by(const Scene& scene, PrimitiveId primitive, const Box& cell, double ray_error) {
  if (primitive.kind() == PrimitiveKind::quadric)
    return ::rayfarm::passes_by(scene.quadrics[primitive.index()], cell, ray_error);
  if (primitive.kind() != PrimitiveKind::sphere) return false;
  const SphereRecord& s = scene.spheres[primitive.index()];
  const Vec3 farthest = glm::max(glm::abs(cell.lo - s.center), glm::abs(cell.hi - s.center));
  return glm::dot(farthest, farthest) < s.radius * s.radius * (1 - 1e-12);
}

}  // namespace

Box bounds_of(const Scene& scene, PrimitiveId primitive) {
  const uint32_t i = primitive.index();
  switch (primitive.kind()) {
    case PrimitiveKind::triangle:
    case PrimitiveKind::face:
      break;
    case PrimitiveKind::sphere:
      return sphere_box(scene.spheres[i]);
    case PrimitiveKind::polygon: {
      Box box;
      for (const Vec3& p : scene.points_of(scene.polygons[i])) box.grow(p);
      return box;
    }
    case PrimitiveKind::quadric:
      return scene.quadrics[i].bounds;
    case PrimitiveKind::collection:
      return scene.collections[i].bounds;
  }
  return {};
}

Box bounds_of(const Scene& scene, PrimitivePointer pointer) {
  if (pointer.kind() != PointerKind::triangle) return bounds_of(scene, id_of(scene, pointer));
  Box box;
  for_each_triangle(scene, pointer, [&](const auto& corners) {
    for (const Vec3& corner : corners) box.grow(corner);
  });
  return box;
}

uint32_t material_of(const Scene& scene, PrimitiveId id) {
  switch (id.kind()) {
    case PrimitiveKind::triangle:
      return scene.triangle_shading[id.index()].material;
    case PrimitiveKind::sphere:
      return scene.spheres[id.index()].material;
    case PrimitiveKind::polygon:
      return scene.polygons[id.index()].material;
    case PrimitiveKind::quadric:
      return scene.quadrics[id.index()].material;
    case PrimitiveKind::face:
      return scene.mesh_faces[id.index()].material;
    case PrimitiveKind::collection:
      break;
  }
  return 0;
}

Box clipped_to(const Scene& scene, PrimitiveId primitive, const Box& cell) {
  const uint32_t i = primitive.index();
  switch (primitive.kind()) {
    case PrimitiveKind::triangle:
    case PrimitiveKind::face:
      break;
    case PrimitiveKind::sphere: {
      const SphereRecord& s = scene.spheres[i];
      const Vec3 nearest = glm::clamp(s.center, cell.lo, cell.hi) - s.center;
      if (glm::dot(nearest, nearest) > s.radius * s.radius * (1 + 1e-12)) return {};
      return intersection(sphere_box(s), cell);
    }
    case PrimitiveKind::polygon:
      return clipped_bounds(scene.points_of(scene.polygons[i]), cell);
    case PrimitiveKind::quadric:
      return intersection(scene.quadrics[i].bounds, cell);
    case PrimitiveKind::collection:
      return intersection(scene.collections[i].bounds, cell);
  }
  return {};
}

PointedPrimitives::PointedPrimitives(const Scene& scene, const Box& bounds,
                                     std::span<const PrimitivePointer> pointers)
    : scene_(scene), pointers_(pointers), ray_error_(surface_error(bounds)) {}

Box PointedPrimitives::bounds(uint32_t primitive) const {
  return bounds_of(scene_, pointers_[primitive]);
}

Box PointedPrimitives::clipped(uint32_t primitive, const Box& cell) const {
  const PrimitivePointer pointer = pointers_[primitive];
  if (pointer.kind() != PointerKind::triangle) {
    const PrimitiveId id = id_of(scene_, pointer);
    return passes_by(scene_, id, cell, ray_error_) ? Box() : clipped_to(scene_, id, cell);
  }
  Box box;
  for_each_triangle(scene_, pointer, [&](const auto& corners) { box.grow(clipped_bounds(corners, cell)); });
  return box;
}

std::vector<Vec3> corners_of(const Scene& scene, PrimitivePointer pointer) {
  std::vector<Vec3> all;
  for_each_triangle(scene, pointer,
                    [&](const auto& corners) { all.insert(all.end(), corners.begin(), corners.end()); });
  return all;
}

}  // namespace rayfarm
