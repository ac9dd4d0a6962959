#pragma once
// Collects what shines while a scene is compiled: shadow rays are sent to luminous spheres, triangles and
// polygons. Other shapes shine too, but only chance finds their light.
#include "common/description/scene_description.h"
#include "common/hierarchy/structurer.h"

namespace rayfarm {

/// A luminous primitive of a part.
struct Luminous {
  PrimitiveId id;
  Place place;
  uint32_t material = 0;
  uint32_t first_triangle = 0, triangle_count = 0;  ///< of luminaire_triangles; a sphere has none
};

class Luminaires {
 public:
  void add_sphere(const Luminous& sphere) { luminous_.push_back(sphere); }
  /// A polygon or triangle that is tested as these triangles.
  void add_triangles(Luminous luminous, std::span<const TriangleVertices> triangles);
  /// A polygon that is tested as it is.
  void add_polygon(Luminous luminous, const Polygon& polygon, std::span<const Vec3> points);
  void add_quadric(const Place& place) { count(quadrics_, place); }
  /// A mesh that changes its shape.
  void add_deforming(const Place& place) { count(deforming_, place); }

  /// What was added since the last call, by id.
  std::vector<Luminous> take();
  const LargeVector<LuminaireTriangle>& triangles() const { return triangles_; }
  /// Those so far, and others behind them that were found before.
  void take_over(LargeVector<LuminaireTriangle> triangles) { triangles_ = std::move(triangles); }

  /// Says what shines and is no lamp.
  void add_notes(const SceneDescription& description, Notes& notes) const;

 private:
  struct Others {
    size_t count = 0;
    Place first;
  };
  static void count(Others& others, const Place& place) {
    if (others.count++ == 0) others.first = place;
  }
  void add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal, Luminous& luminous);
  void finish(const Luminous& luminous);

  std::vector<Luminous> luminous_;
  LargeVector<LuminaireTriangle> triangles_;
  Others quadrics_, polygons_, deforming_;
};

}  // namespace rayfarm
