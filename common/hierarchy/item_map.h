#pragma once
// A z-buffer that keeps, for points of a view, which item is nearest there (Weghorst, Hooper and Greenberg
// 1984, section 4: "instead of producing the traditional display buffer, the algorithm is modified to produce
// an item buffer"). Triangles are scan-converted in homogeneous coordinates (Olano and Greer 1997), so that
// nothing need be clipped where they reach behind the eye; other primitives are tested by a ray through each
// point of their boxes' footprints.
#include <optional>
#include <vector>

#include "common/hierarchy/items.h"

namespace rayfarm {

/// Points [x0, x1) × [y0, y1) of a view.
struct ViewPoints {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  size_t width() const { return static_cast<size_t>(x1 - x0); }
  size_t count() const { return width() * static_cast<size_t>(y1 - y0); }
};

/// The point (x, y) shows what lies from `eye` in the direction corner + x · per_x + y · per_y.
struct ItemView {
  Vec3 eye{0};
  Vec3 corner{0}, per_x{0}, per_y{0};  ///< per_x and per_y at right angles
  ViewPoints points;                   ///< those that are kept
};

/// What a point shows: nothing, or the item that is nearest.
struct SeenItem {
  /// 1 / the depth, counted in that of the plane through the directions; 0: there is nothing.
  float inverse_depth = 0;
  Item item;
};

class ItemMap {
 public:
  /// An empty map.
  explicit ItemMap(const ItemView& view);
  /// What there is of the scene, at these poses.
  ItemMap(const Scene& scene, const Pose& pose, const ItemView& view) : ItemMap(view) { draw(scene, pose); }

  bool has(int x, int y) const {
    return x >= view_.points.x0 && x < view_.points.x1 && y >= view_.points.y0 && y < view_.points.y1;
  }
  /// The map must have the point.
  const SeenItem& operator()(int x, int y) const { return seen_[index(x, y)]; }

  /// Where a point of the world is seen, if it is before the eye.
  struct Projection {
    double x, y, depth;
  };
  std::optional<Projection> project(const Vec3& p) const;

 private:
  /// The points between which something is seen, both ends included.
  struct Footprint {
    int x0, y0, x1, y1;
  };
  /// What grows evenly over the view.
  struct Linear {
    double at, per_x, per_y;
  };
  class Painter;

  void draw(const Scene& scene, const Pose& pose);
  size_t index(int x, int y) const {
    return static_cast<size_t>(y - view_.points.y0) * view_.points.width() +
           static_cast<size_t>(x - view_.points.x0);
  }
  /// Of the convex hull of points relative to the eye: all of the view, if some lie behind it.
  std::optional<Footprint> footprint(std::span<const Vec3> points) const;
  Linear linear(const Vec3& v) const {
    return {glm::dot(v, view_.corner), glm::dot(v, view_.per_x), glm::dot(v, view_.per_y)};
  }
  /// Corners relative to the eye.
  void draw_triangle(const std::array<Vec3, 3>& corners, const Item& item);
  void put(SeenItem& seen, double inverse_depth, const Item& item) {
    const auto w = static_cast<float>(inverse_depth);
    if (w > seen.inverse_depth) seen = {w, item};
  }

  ItemView view_;
  Vec3 forward_{0};           ///< its product with any of the directions is 1
  Vec3 across_{0}, down_{0};  ///< their products with per_x and with per_y are 1
  std::vector<SeenItem> seen_;
};

}  // namespace rayfarm
