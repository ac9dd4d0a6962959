#include "common/hierarchy/bounding_tree.h"

#include <algorithm>

#include "common/hierarchy/cells.h"

namespace rayfarm {
namespace {

/// What volumes must hold of an element.
struct FittedElement {
  std::vector<FitPoint> points;
  Box box;
  bool is_simple =
      false;  ///< one sphere or quadric, or a box: a test of a volume would cost as much as its own
};

/// The points of primitives, in the space that they stand in or, through `pose`, in the world.
class PointCollector {
 public:
  PointCollector(const SceneArrays<GrowingArray>& arrays, const InstancePose* pose)
      : arrays_(arrays), pose_(pose) {
    if (!pose || pose->is_identity) return;
    // The norm of MᵀM is not above its largest sum of a row.
    const Mat3 square = glm::transpose(pose->world_from_object.linear) * pose->world_from_object.linear;
    double most = 0;
    for (int i = 0; i < 3; ++i)
      most = std::max(most, std::abs(square[i][0]) + std::abs(square[i][1]) + std::abs(square[i][2]));
    stretch_ = std::sqrt(most);
  }

  void add_triangles(uint32_t first, uint32_t count) {
    for (const TriangleBlock& block : std::span(arrays_.triangle_blocks).subspan(first, count))
      for (size_t lane = 0; lane < 8; ++lane)
        if (block.primitives[lane] != kNoPrimitive)
          for (const auto& v : block.vertices) add(Vec3(v[0][lane], v[1][lane], v[2][lane]), 0);
  }
  void add_spheres(uint32_t first, uint32_t count) {
    for (const SphereBlock& block : std::span(arrays_.sphere_blocks).subspan(first, count))
      for (size_t lane = 0; lane < 8; ++lane) {
        if (block.spheres[lane] == kNone) continue;
        ++curved_;
        add(Vec3(block.center[0][lane], block.center[1][lane], block.center[2][lane]), block.radius[lane]);
      }
  }
  /// `with_collections`: as the boxes that they have; otherwise what is in them is added elsewhere.
  void add_others(uint32_t first, uint32_t count, bool with_collections) {
    for (const PrimitiveId id : std::span(arrays_.leaf_primitives).subspan(first, count)) {
      if (id.kind() == PrimitiveKind::polygon) {
        const Polygon& polygon = arrays_.polygons[id.index()];
        for (const Vec3& p :
             std::span(arrays_.polygon_points).subspan(polygon.first_point, polygon.point_count))
          add(p, 0);
      } else if (id.kind() == PrimitiveKind::quadric) {
        ++curved_;
        add_corners(arrays_.quadrics[id.index()].bounds);
      } else if (with_collections) {
        curved_ += 2;  // which is not simple, whatever is in it
        add_corners(arrays_.collections[id.index()].bounds);
      }
    }
  }

  FittedElement take() {
    FittedElement fitted;
    fitted.is_simple = curved_ == 0 ? is_box(points_) : curved_ == 1 && !has_corners_;
    fitted.box = box_of(points_);
    fitted.points = std::move(points_);
    return fitted;
  }

 private:
  void add_corners(const Box& box) {
    const bool had_corners = has_corners_;
    for (const Vec3& corner : corners_of(box)) add(corner, 0);
    has_corners_ = had_corners;
  }
  void add(Vec3 p, double radius) {
    if (pose_ && !pose_->is_identity) p = pose_->world_from_object.point(p);
    points_.push_back({p, radius * stretch_});
    has_corners_ = has_corners_ || radius == 0;
  }

  const SceneArrays<GrowingArray>& arrays_;
  const InstancePose* pose_;
  double stretch_ = 1;  ///< a bound on how much longer a vector becomes
  std::vector<FitPoint> points_;
  size_t curved_ = 0;         ///< spheres and quadrics
  bool has_corners_ = false;  ///< there are polygons
};

class Builder {
 public:
  Builder(SceneArrays<GrowingArray>& arrays, const ObjectOptions& options, const std::optional<Vec3>& eye)
      : arrays_(arrays), options_(options) {
    if (options.bounds_for == BoundsFor::eye) eye_ = eye;
  }

  uint32_t build(ObjectElement root) {
    if (options_.clusters != Clusters::groups && !root.children.empty()) {
      std::vector<ObjectElement> objects;
      take_objects(root, objects);
      root.children = std::move(objects);
      if (options_.clusters == Clusters::automatic) cluster(root);
    }
    const auto first_volume = arrays_.bounding_volumes.size();
    const auto index = static_cast<uint32_t>(arrays_.bounding_nodes.size());
    arrays_.bounding_nodes.push_back({});
    const FittedElement all = add(root, index);
    const double magnitude = all.box.magnitude();
    const double margin = with_margin(all.box).hi.x - all.box.hi.x;
    for (BoundingVolume& v : std::span(arrays_.bounding_volumes).subspan(first_volume)) widen(v, margin);
    arrays_.bounding_trees.push_back({index, options_.order, magnitude});
    return static_cast<uint32_t>(arrays_.bounding_trees.size() - 1);
  }

 private:
  static void take_objects(ObjectElement& element, std::vector<ObjectElement>& objects) {
    if (element.children.empty()) return objects.push_back(std::move(element));
    for (ObjectElement& child : element.children) take_objects(child, objects);
  }

  FittedElement fit(const ObjectElement& object) const {
    PointCollector collector(arrays_, object.instance == kNone ? nullptr : &arrays_.poses[object.instance]);
    const auto& [triangles, spheres, others] = object.leaves;
    if (triangles.count() + spheres.count() + others.count() > 0) {
      collector.add_triangles(triangles.first, triangles.count());
      collector.add_spheres(spheres.first, spheres.count());
      collector.add_others(others.first, others.count(), true);
    } else {
      const Part& part = arrays_.parts[arrays_.instances[object.instance].part];
      collector.add_triangles(part.first_triangle_block, part.triangle_block_count);
      collector.add_spheres(part.first_sphere_block, part.sphere_block_count);
      collector.add_others(part.first_leaf_primitive, part.leaf_primitive_count, false);
    }
    return collector.take();
  }

  /// Groups of four or fewer that are near each other: the elements are halved twice, each time at the median
  /// of their centres along the longest axis. What is more than half as large as all of them stays with the
  /// group itself.
  void cluster(ObjectElement& group) const {
    std::vector<Box> boxes;
    for (const ObjectElement& child : group.children) boxes.push_back(fit(child).box);
    std::vector<size_t> order(boxes.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    cluster(group, boxes, order);
  }
  void cluster(ObjectElement& group, const std::vector<Box>& boxes, std::span<size_t> order) const {
    constexpr size_t kMost = 4;
    if (order.size() <= kMost) return;
    Box all;
    for (const size_t i : order) all.grow(boxes[i]);
    const auto end_of_large = std::stable_partition(order.begin(), order.end(), [&](size_t i) {
      return max_component(boxes[i].extent()) > 0.5 * max_component(all.extent());
    });
    const auto large_count = static_cast<size_t>(end_of_large - order.begin());
    const std::span<size_t> rest = order.subspan(large_count);
    const auto halve = [&](std::span<size_t> part) {
      Box centers;
      for (const size_t i : part) centers.grow(boxes[i].center());
      const auto axis = static_cast<int>(largest_axis(centers.is_empty() ? Vec3(0) : centers.extent()));
      std::stable_sort(part.begin(), part.end(),
                       [&](size_t a, size_t b) { return boxes[a].center()[axis] < boxes[b].center()[axis]; });
      return part.size() / 2;
    };
    std::vector<ObjectElement> children;
    std::vector<ObjectElement>& from = group.children;
    for (const size_t i : order.first(large_count)) children.push_back(std::move(from[i]));
    std::vector<std::span<size_t>> parts{rest};
    if (rest.size() > kMost) {
      const size_t middle = halve(rest);
      parts.clear();
      for (const std::span<size_t> half : {rest.first(middle), rest.subspan(middle)}) {
        const size_t quarter = halve(half);
        parts.push_back(half.first(quarter));
        parts.push_back(half.subspan(quarter));
      }
    }
    for (const std::span<size_t> part : parts) {
      ObjectElement inner;
      std::vector<Box> inner_boxes;
      std::vector<size_t> inner_order;
      for (const size_t i : part) {
        inner_order.push_back(inner_order.size());
        inner_boxes.push_back(boxes[i]);
        inner.children.push_back(std::move(from[i]));
      }
      cluster(inner, inner_boxes, inner_order);
      children.push_back(std::move(inner));
    }
    group.children = std::move(children);
    group = without_idle_groups(std::move(group));
  }

  /// Fills in the node and appends what is below it.
  FittedElement add(const ObjectElement& element, uint32_t index) {
    FittedElement fitted;
    if (element.children.empty()) {
      fitted = fit(element);
      arrays_.bounding_nodes[index].instance = element.instance;
      arrays_.bounding_nodes[index].leaves = element.leaves;
    } else {
      const auto first = static_cast<uint32_t>(arrays_.bounding_nodes.size());
      arrays_.bounding_nodes[index].first_child = first;
      arrays_.bounding_nodes[index].child_count = static_cast<uint32_t>(element.children.size());
      arrays_.bounding_nodes.insert(arrays_.bounding_nodes.end(), element.children.size(), BoundingNode{});
      for (uint32_t i = 0; i < element.children.size(); ++i) {
        const FittedElement child = add(element.children[i], first + i);
        fitted.box.grow(child.box);
        fitted.points.insert(fitted.points.end(), child.points.begin(), child.points.end());
      }
    }
    const auto first_volume = static_cast<uint32_t>(arrays_.bounding_volumes.size());
    arrays_.bounding_nodes[index].first_volume = first_volume;
    add_volumes(element, fitted);
    arrays_.bounding_nodes[index].volume_count =
        static_cast<uint32_t>(arrays_.bounding_volumes.size()) - first_volume;
    return fitted;
  }

  void add_volumes(const ObjectElement& element, const FittedElement& fitted) {
    const auto add_volume = [&](BoundChoice bounds) {
      if (bounds == BoundChoice::none) return;
      arrays_.bounding_volumes.push_back(bounds == BoundChoice::best
                                             ? choose_volume(fitted.points, eye_)
                                             : fit_volume(static_cast<VolumeKind>(bounds), fitted.points));
    };
    if (element.bound.empty() && !fitted.is_simple) add_volume(options_.bounds);
    for (const BoundChoice bounds : element.bound) add_volume(bounds);
  }

  SceneArrays<GrowingArray>& arrays_;
  const ObjectOptions& options_;
  std::optional<Vec3> eye_;
};

}  // namespace

ObjectElement without_idle_groups(ObjectElement element) {
  for (ObjectElement& child : element.children) child = without_idle_groups(std::move(child));
  std::erase_if(element.children, [](const ObjectElement& child) { return child.is_empty(); });
  if (element.children.size() != 1) return element;
  ObjectElement only = std::move(element.children[0]);
  if (only.bound.empty()) only.bound = std::move(element.bound);
  return only;
}

uint32_t build_bounding_tree(ObjectElement root, const ObjectOptions& options, const std::optional<Vec3>& eye,
                             SceneArrays<GrowingArray>& arrays) {
  return Builder(arrays, options, eye).build(std::move(root));
}

ObjectSizes sizes_of(const Scene& scene, const BoundingTree& tree) {
  ObjectSizes sizes;
  std::vector<uint32_t> open{tree.root};
  while (!open.empty()) {
    const BoundingNode& node = scene.bounding_nodes[open.back()];
    open.pop_back();
    ++sizes.nodes;
    sizes.pointers += node.child_count;
    for (uint32_t i = 0; i < node.child_count; ++i) open.push_back(node.first_child + i);
    if (node.is_group() || node.instance == kNone) continue;
    const Collection& collection = scene.parts[scene.instances[node.instance].part].collection;
    if (node.has_leaves() || collection.tree == kNone) continue;
    --sizes.nodes;  // the instance and the root of its tree are one
    open.push_back(scene.bounding_trees[collection.tree].root);
  }
  return sizes;
}

}  // namespace rayfarm
