#include "common/hierarchy/item_map.h"

#include <cmath>

#include "common/hierarchy/primitive_bounds.h"

namespace rayfarm {
namespace {

/// In front of the eye lies what is no nearer to its plane than this share of its own distance.
constexpr double kLeastDepth = 1e-9;

double square(const Vec3& v) {
  return glm::dot(v, v);
}

/// The nearest whole number of [lo, hi]; lo if there is none.
int clamped(double v, int lo, int hi) {
  return v > lo ? v < hi ? static_cast<int>(v) : hi : lo;
}

}  // namespace

ItemMap::ItemMap(const ItemView& view) : view_(view), seen_(view.points.count()) {
  const Vec3 normal = glm::cross(view.per_x, view.per_y);
  forward_ = normal / glm::dot(normal, view.corner);
  across_ = view.per_x / glm::dot(view.per_x, view.per_x);
  down_ = view.per_y / glm::dot(view.per_y, view.per_y);
}

std::optional<ItemMap::Projection> ItemMap::project(const Vec3& p) const {
  const Vec3 v = p - view_.eye;
  const double depth = glm::dot(v, forward_);
  if (!(depth > 0)) return std::nullopt;
  const Vec3 offset = v / depth - view_.corner;
  return Projection{glm::dot(offset, across_), glm::dot(offset, down_), depth};
}

std::optional<ItemMap::Footprint> ItemMap::footprint(std::span<const Vec3> points) const {
  const ViewPoints& all = view_.points;
  double x0 = all.x1, x1 = all.x0 - 1, y0 = all.y1, y1 = all.y0 - 1;
  const double least = kLeastDepth * kLeastDepth * square(forward_);
  size_t behind = 0;
  bool is_near = false;
  for (const Vec3& v : points) {
    const double depth = glm::dot(v, forward_);
    if (depth <= 0) ++behind;
    if (!(depth > 0 && depth * depth > least * square(v))) {
      is_near = true;
      continue;
    }
    const Vec3 offset = v / depth - view_.corner;
    const double x = glm::dot(offset, across_), y = glm::dot(offset, down_);
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
  }
  if (behind == points.size()) return std::nullopt;
  if (is_near) return Footprint{all.x0, all.y0, all.x1 - 1, all.y1 - 1};
  if (!(x1 >= all.x0 && x0 <= all.x1 - 1 && y1 >= all.y0 && y0 <= all.y1 - 1)) return std::nullopt;
  return Footprint{clamped(std::floor(x0), all.x0, all.x1 - 1), clamped(std::floor(y0), all.y0, all.y1 - 1),
                   clamped(std::ceil(x1), all.x0, all.x1 - 1), clamped(std::ceil(y1), all.y0, all.y1 - 1)};
}

// The ray t · d meets the triangle a, b, c where t · d = α a + β b + γ c with α + β + γ = 1 and none of them
// negative. With V = a · (b × c), α = t (b × c) · d / V, and so on; hence 1 / t is the sum of the three
// quotients, which grow evenly over the view.
void ItemMap::draw_triangle(const std::array<Vec3, 3>& corners, const Item& item) {
  const auto& [a, b, c] = corners;
  const std::array<Vec3, 3> across{glm::cross(b, c), glm::cross(c, a), glm::cross(a, b)};
  const double volume = glm::dot(a, across[0]);
  if (!(std::abs(volume) > 0)) return;  // seen edge-on, or of no numbers
  const std::optional<Footprint> seen = footprint(corners);
  if (!seen) return;
  const double inverse_volume = 1 / volume;
  std::array<Linear, 3> shares;
  std::array<double, 3> x_per_share;
  Linear inverse_depth{0, 0, 0};
  for (size_t i = 0; i < 3; ++i) {
    shares[i] = linear(inverse_volume * across[i]);
    x_per_share[i] = 1 / shares[i].per_x;
    inverse_depth.at += shares[i].at;
    inverse_depth.per_x += shares[i].per_x;
    inverse_depth.per_y += shares[i].per_y;
  }
  for (int y = seen->y0; y <= seen->y1; ++y) {
    double first = seen->x0, last = seen->x1;
    for (size_t i = 0; i < 3; ++i) {
      const Linear& share = shares[i];
      const double at = share.at + y * share.per_y;
      if (share.per_x > 0)
        first = std::max(first, std::ceil(-at * x_per_share[i]));
      else if (share.per_x < 0)
        last = std::min(last, std::floor(-at * x_per_share[i]));
      else if (!(at >= 0))
        last = seen->x0 - 1.0;  // nothing; of a large first, first - 1 may be the same number
    }
    if (!(first <= last)) continue;
    const double row = inverse_depth.at + y * inverse_depth.per_y;
    SeenItem* seen_here = &seen_[index(static_cast<int>(first), y)];
    for (int x = static_cast<int>(first); x <= static_cast<int>(last); ++x)
      put(*seen_here++, row + x * inverse_depth.per_x, item);
  }
}

/// Draws what there is.
class ItemMap::Painter {
 public:
  Painter(ItemMap& map, const Scene& scene, const Pose& pose) : map_(map), scene_(scene), pose_(pose) {}

  void draw_scene() {
    const uint32_t tree = scene_.head().object_tree;
    if (tree != kNone) draw_objects(scene_.bounding_trees[tree].root, kNone);
    for (uint32_t i = 0; i < scene_.instances.size(); ++i)
      if (tree == kNone || scene_.instances[i].moving != kNone) draw_instance(i);
  }

 private:
  void draw_instance(uint32_t instance) {
    if (pose_[instance].is_hidden) return;
    const Part& part = pose_.shape_of(instance, scene_).parts[scene_.instances[instance].part];
    if (part.collection.structure == Structure::object) {
      draw_objects(scene_.bounding_trees[part.collection.tree].root, instance);
      return;
    }
    draw_leaf(make_child(ChildKind::triangles, part.first_triangle_block, part.triangle_block_count),
              instance, {});
    draw_leaf(make_child(ChildKind::spheres, part.first_sphere_block, part.sphere_block_count), instance, {});
    draw_leaf(make_child(ChildKind::mixed, part.first_leaf_primitive, part.leaf_primitive_count), instance,
              {});
  }

  /// `instance`: of objects that name none.
  void draw_objects(uint32_t root, uint32_t instance) {
    std::vector<uint32_t> left{root};
    while (!left.empty()) {
      const uint32_t index = left.back();
      left.pop_back();
      const BoundingNode& node = scene_.bounding_nodes[index];
      for (uint32_t i = node.child_count; i-- > 0;) left.push_back(node.first_child + i);
      if (!node.is_group()) draw_object(index, node.instance == kNone ? instance : node.instance);
    }
  }

  void draw_object(uint32_t index, uint32_t instance) {
    const BoundingNode& node = scene_.bounding_nodes[index];
    if (!node.has_leaves()) draw_instance(instance);
    for (const ChildRef& leaf : node.leaves)
      if (leaf.count() > 0) draw_leaf(leaf, instance, make_object_item(instance, index));
  }

  /// `item`: that all of it is; none: each primitive is one.
  void draw_leaf(const ChildRef& leaf, uint32_t instance, const Item& item) {
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) switch (leaf.kind()) {
        case ChildKind::triangles:
          draw_triangles(i, instance, item);
          break;
        case ChildKind::spheres:
          draw_spheres(i, instance, item);
          break;
        case ChildKind::mixed:
          draw_other(i, instance, item);
          break;
        default:
          break;
      }
  }

  void draw_triangles(uint32_t index, uint32_t instance, const Item& item) {
    const TriangleBlock& block = pose_.shape_of(instance, scene_).triangle_blocks[index];
    for (uint32_t lane = 0; lane < 8; ++lane) {
      if (block.primitives[lane] == kNoPrimitive) continue;
      std::array<Vec3, 3> corners;
      for (size_t v = 0; v < 3; ++v)
        corners[v] = from_eye(
            instance, {block.vertices[v][0][lane], block.vertices[v][1][lane], block.vertices[v][2][lane]});
      map_.draw_triangle(corners, item.is_there() ? item
                                                  : make_item(instance, make_pointer(PointerKind::triangle,
                                                                                     8 * index + lane)));
    }
  }

  void draw_spheres(uint32_t index, uint32_t instance, const Item& item) {
    const SphereBlock& block = scene_.sphere_blocks[index];
    for (uint32_t lane = 0; lane < 8; ++lane) {
      if (block.spheres[lane] == kNone) continue;
      const Vec3 center(block.center[0][lane], block.center[1][lane], block.center[2][lane]);
      draw_by_rays(Box{center - block.radius[lane], center + block.radius[lane]},
                   make_item(instance, make_pointer(PointerKind::sphere, 8 * index + lane)), item);
    }
  }

  void draw_other(uint32_t index, uint32_t instance, const Item& item) {
    const PrimitiveId id = scene_.leaf_primitives[index];
    if (id.kind() != PrimitiveKind::collection) {
      draw_by_rays(bounds_of(scene_, id), make_item(instance, make_pointer(PointerKind::other, index)), item);
      return;
    }
    if (!item.is_there()) return;  // what is in it stands among the part's primitives, too
    const Collection& c = scene_.collections[id.index()];
    draw_leaf(make_child(ChildKind::triangles, c.first_triangle_block, c.triangle_block_count), instance,
              item);
    draw_leaf(make_child(ChildKind::spheres, c.first_sphere_block, c.sphere_block_count), instance, item);
    draw_leaf(make_child(ChildKind::mixed, c.first_leaf_primitive, c.leaf_primitive_count), instance, item);
  }

  /// `box`: in the object's space.
  void draw_by_rays(const Box& box, const Item& primitive, const Item& item) {
    std::array<Vec3, 8> corners = corners_of(box);
    for (Vec3& corner : corners) corner = from_eye(primitive.instance, corner);
    const std::optional<Footprint> seen = map_.footprint(corners);
    if (!seen) return;
    Ray ray{map_.view_.eye, Vec3(0)};
    for (int y = seen->y0; y <= seen->y1; ++y)
      for (int x = seen->x0; x <= seen->x1; ++x) {
        SeenItem& point = map_.seen_[map_.index(x, y)];
        ray.direction = map_.view_.corner + double(x) * map_.view_.per_x + double(y) * map_.view_.per_y;
        const Hit hit = closest_hit_among(scene_, pose_, {&primitive, 1}, ray);
        if (hit.is_hit()) map_.put(point, 1 / hit.t, item.is_there() ? item : primitive);
      }
  }

  Vec3 from_eye(uint32_t instance, const Vec3& p) const {
    const InstancePose& place = pose_[instance];
    return (place.is_identity ? p : place.world_from_object.point(p)) - map_.view_.eye;
  }

  ItemMap& map_;
  const Scene& scene_;
  const Pose& pose_;
};

void ItemMap::draw(const Scene& scene, const Pose& pose) {
  Painter(*this, scene, pose).draw_scene();
}

}  // namespace rayfarm
