#include "common/scene/array_offsets.h"

namespace rayfarm {
namespace {

void shift(uint32_t& index, uint32_t offset) {
  if (index != kNone) index += offset;
}

void shift(ChildRef& child, const ArrayOffsets& o) {
  switch (child.kind()) {
    case ChildKind::empty:
      return;
    case ChildKind::inner:
      child.first += o.nodes;
      return;
    case ChildKind::triangles:
      child.first += o.triangle_blocks;
      return;
    case ChildKind::spheres:
      child.first += o.sphere_blocks;
      return;
    case ChildKind::mixed:
      child.first += o.leaf_primitives;
      return;
    case ChildKind::instances:  // of no part's volumes
      return;
  }
}

}  // namespace

void shift(VolumeNode& node, const ArrayOffsets& o) {
  auto& [planes, children] = node;
  for (ChildRef& child : children) shift(child, o);
}

void shift(PrimitiveId& id, const ArrayOffsets& o) {
  if (id == kNoPrimitive) return;
  const std::array<uint32_t, 6> offsets{o.triangle_shading, o.spheres,    o.polygons, o.quadrics,
                                        o.mesh_faces,       o.collections};  // in the order of PrimitiveKind
  id = make_primitive_id(id.kind(), id.index() + offsets[static_cast<size_t>(id.kind())]);
}

void shift(TriangleBlock& block, const ArrayOffsets& o) {
  auto& [vertices, primitives] = block;
  for (PrimitiveId& id : primitives) shift(id, o);
}

void shift(SphereBlock& block, const ArrayOffsets& o) {
  auto& [center, radius, spheres] = block;
  for (uint32_t& sphere : spheres) shift(sphere, o.spheres);
}

void shift(SphereRecord& sphere, const ArrayOffsets& o) {
  auto& [center, radius, material, padding] = sphere;
  material += o.materials;
}

void shift(Polygon& polygon, const ArrayOffsets& o) {
  auto& [normal, distance, first_point, point_count, first_normal, smoothing, material, drop_axis] = polygon;
  first_point += o.polygon_points;
  shift(first_normal, o.polygon_normals);
  material += o.materials;
}

void shift(Quadric& quadric, const ArrayOffsets& o) {
  auto& [origin, a, b, c, square_bound, rest_bound, first_plane, plane_count, material, is_patch, bounds] =
      quadric;
  first_plane += o.quadric_planes;
  material += o.materials;
}

void shift(TriangleShading& shading, const ArrayOffsets& o) {
  auto& [material, smoothing, normals] = shading;
  material += o.materials;
  for (uint32_t& normal : normals) shift(normal, o.normals);
}

void shift(MeshFace& face, const ArrayOffsets& o) {
  auto& [first_corner, corner_count, first_normal, smoothing, material] = face;
  first_corner += o.face_corners;
  shift(first_normal, o.face_normals);
  material += o.materials;
}

void shift(LuminaireTriangle& triangle, const ArrayOffsets&) {
  [[maybe_unused]] auto& [corners, normal, area_through, magnitude] = triangle;
}

void shift(Collection& collection, const ArrayOffsets& o) {
  auto& [bounds, structure, grid, octree, has_mailbox, tree, octants, root, first_triangle_block,
         triangle_block_count, first_sphere_block, sphere_block_count, first_leaf_primitive,
         leaf_primitive_count] = collection;
  shift(grid, o.grids);
  shift(octree, o.octrees);
  shift(tree, o.bounding_trees);
  shift(octants, o.octant_trees);
  shift(root, o);
  first_triangle_block += o.triangle_blocks;
  first_sphere_block += o.sphere_blocks;
  first_leaf_primitive += o.leaf_primitives;
}

void shift(Grid& grid, const ArrayOffsets& o) {
  auto& [low, cell, cells, first_cell] = grid;
  first_cell += o.grid_cells;
}

void shift(BoundingTree& tree, const ArrayOffsets& o) {
  auto& [root, order, magnitude] = tree;
  root += o.bounding_nodes;
}

void shift(BoundingNode& node, const ArrayOffsets& o) {
  auto& [first_child, child_count, first_volume, volume_count, instance, padding, leaves] = node;
  first_child += o.bounding_nodes;
  first_volume += o.bounding_volumes;
  for (ChildRef& leaf : leaves) shift(leaf, o);
}

void shift(Octree& octree, const ArrayOffsets& o) {
  auto& [low, unit, size, next, first_node, node_count, first_cell, cell_count, first_place, place_count,
         max_primitives, build] = octree;
  first_node += o.octree_nodes;
  first_cell += o.octree_cells;
  first_place += o.octree_hash;
}

void shift(OctreeNode& node, const ArrayOffsets&) {
  [[maybe_unused]] auto& [size, center, child, sibling, is_divided] = node;
}

void shift(OctreeCell& cell, const ArrayOffsets& o) {
  auto& [name, first_pointer, pointer_count, next, padding] = cell;
  first_pointer += o.primitive_pointers;
}

void shift(OctantTree& tree, const ArrayOffsets& o) {
  auto& [magnitude, first_volume, volume_count] = tree;
  first_volume += o.octant_volumes;
}

void shift(OctantVolume& volume, const ArrayOffsets& o) {
  auto& [center, radius, octants, first, pointer_count, padding] = volume;
  if (volume.is_leaf()) first += o.primitive_pointers;
}

void shift(PrimitivePointer& pointer, const ArrayOffsets& o) {
  const std::array<uint32_t, 3> offsets{8 * o.triangle_blocks, 8 * o.sphere_blocks,
                                        o.leaf_primitives};  // in the order of PointerKind
  pointer = make_pointer(pointer.kind(), pointer.place() + offsets[static_cast<size_t>(pointer.kind())]);
}

void shift(Part& part, const ArrayOffsets& o) {
  auto& [collection, first_triangle_block, triangle_block_count, first_sphere_block, sphere_block_count,
         first_leaf_primitive, leaf_primitive_count, triangle_count, sphere_count, quadric_count,
         polygon_count] = part;
  shift(collection, o);
  first_triangle_block += o.triangle_blocks;
  first_sphere_block += o.sphere_blocks;
  first_leaf_primitive += o.leaf_primitives;
}

void shift(Material& m, const ArrayOffsets& o) {
  auto& [color, ambient, diffuse, specular, shininess, reflect, transmit, index, kind, priority, texture,
         bump, emission, interior, reflections, zone_size, is_solid, is_pierced, is_unlit, is_no_lamp,
         is_colored, bump_height, exponent, n, k, metal, is_inward, abbe, filter, back, through, diagram,
         principled, diagram_axis, diagram_zero, parts] = m;
  shift(texture, o.textures);
  shift(bump, o.textures);
  shift(diagram, o.goniometric_diagrams);
  shift(principled, o.principled);
  for (uint32_t& part : parts) shift(part, o.materials);
}

void shift(PrincipledMaterial& m, const ArrayOffsets& o) {
  auto& [sources, ior, cutoff, is_one_sided, has_textures, has_coefficients, unused] = m;
  for (PrincipledSource& source : sources) {
    auto& [factor, texture, channel, u_row, v_row, uv_set, padding] = source;
    shift(texture, o.textures);
  }
}

/// Of an object's light, which is no luminaire; where it stands is told apart.
void shift(Light& light, const ArrayOffsets& o) {
  static_assert(sizeof(Light) == sizeof(LightPlace) + 80, "say here what becomes of a new field");
  shift(light.diagram, o.goniometric_diagrams);
}

}  // namespace rayfarm
