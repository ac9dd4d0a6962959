#pragma once
// Shapes of the description to the flat records that rays are tested against.
#include "common/compile/luminaires.h"
#include "common/hierarchy/structurer.h"
#include "common/scene/scene.h"

namespace rayfarm {

class ShapeCompiler {
 public:
  /// All must outlive it; the arrays hold the materials already.
  ShapeCompiler(SceneArrays<GrowingArray>& arrays, Luminaires& luminaires,
                const SceneDescription& description, std::stop_token stop)
      : arrays_(arrays), luminaires_(luminaires), description_(description), stop_(std::move(stop)) {}

  /// Adds the shape's records, and to `part` what the hierarchy is built over. Throws InputError for a
  /// quadric that its planes don't bound, or of which nothing is left, and Stopped.
  void add(PartPrimitives& part, const PrimitiveDescription& primitive) {
    std::visit([&](const auto& shape) { add(part, primitive, shape); }, primitive.shape);
  }

  /// Says what was left out.
  void add_notes(Notes& notes) const;

 private:
  void add(PartPrimitives& part, const PrimitiveDescription& p, const SphereShape& sphere);
  void add(PartPrimitives& part, const PrimitiveDescription& p, const ConeShape& cone);
  void add(PartPrimitives& part, const PrimitiveDescription& p, const QuadricShape& shape);
  void add(PartPrimitives& part, const PrimitiveDescription& p, const PatchShape& shape);
  void add(PartPrimitives& part, const PrimitiveDescription& p, const PolygonShape& shape);
  void add(PartPrimitives& part, const PrimitiveDescription& p, const MeshShape& mesh);  // meshes.cpp
  void add_polygons(PartPrimitives& part, const PrimitiveDescription& p, const MeshShape& mesh,
                    uint32_t first_normal, bool has_all_normals);
  /// Nothing if the triangle has no area: no ray can hit it.
  std::optional<PrimitiveId> add_triangle(const TriangleVertices& v, const TriangleShading& shading,
                                          const Place& place);
  void store_quadric(PartPrimitives& part, const PrimitiveDescription& p, Quadric quadric,
                     std::span<const Vec4> planes);
  void add_quadric(PartPrimitives& part, const PrimitiveDescription& p, Quadric quadric,
                   std::span<const Vec4> planes);
  bool is_luminous(uint32_t material) const;

  SceneArrays<GrowingArray>& arrays_;
  Luminaires& luminaires_;
  const SceneDescription& description_;
  std::stop_token stop_;
  struct Others {
    size_t count = 0;
    Place first;
  };
  void note_shading(uint32_t smoothing, uint32_t material, const Place& place);
  static void count(Others& others, const Place& place);
  Others dropped_;  ///< what no ray can hit
  Others folded_;   ///< faces that are not planar
  Others bumped_;   ///< by Gouraud, with a bump map
};

}  // namespace rayfarm
