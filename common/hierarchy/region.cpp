#include "common/hierarchy/region.h"

#include <array>
#include <vector>

namespace rayfarm {
namespace {

class Search {
 public:
  Search(const Scene& scene, std::span<const HalfSpace> region, size_t& patience)
      : scene_(scene), world_(region.begin(), region.end()), local_(world_), patience_(patience) {}

  Presence run() {
    walk(scene_.head().fixed_root, scene_.fixed_nodes, world_);
    walk(scene_.head().moving_root, scene_.moving_nodes, world_);
    return found_;
  }

 private:
  /// Of a box: the farthest that it reaches along `n`.
  static double reach(const Box& box, const Vec3& n) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += n[k] * (n[k] > 0 ? box.hi[k] : box.lo[k]);
    return sum;
  }
  static bool may_hold(std::span<const HalfSpace> region, const Box& box) {
    return std::all_of(region.begin(), region.end(),
                       [&](const HalfSpace& h) { return reach(box, h.n) > h.d; });
  }

  bool is_done() const { return found_ == Presence::certain; }
  /// Takes some of the patience; without any, there may be something.
  bool is_over() {
    if (is_done()) return true;
    if (patience_ == 0) {
      note(Presence::possible);
      return true;
    }
    --patience_;
    return false;
  }
  void note(Presence presence) { found_ = std::max(found_, presence); }

  /// Depth first, with a stack of its own: hierarchies may be deep.
  void walk(const ChildRef& root, std::span<const VolumeNode> nodes, std::span<const HalfSpace> region) {
    std::vector<ChildRef> stack{root};
    while (!stack.empty() && !is_done()) {
      if (is_over()) return;
      const ChildRef child = stack.back();
      stack.pop_back();
      if (child.kind() != ChildKind::inner) {
        look_at(child);
        continue;
      }
      const VolumeNode& node = nodes[child.first];
      for (size_t slot = 0; slot < 8; ++slot) {
        const ChildRef& inside = node.children[slot];
        if (inside.kind() != ChildKind::empty && may_hold(region, child_box(node, slot)))
          stack.push_back(inside);
      }
    }
  }

  void look_at(const ChildRef& leaf) {
    switch (leaf.kind()) {
      case ChildKind::instances:
        for (const uint32_t i : scene_.leaf_instances.subspan(leaf.first, leaf.count()))
          if (!is_done()) enter(scene_.instances[i], scene_.poses[i]);
        return;
      case ChildKind::triangles:
        for (const TriangleBlock& block : scene_.triangle_blocks.subspan(leaf.first, leaf.count())) {
          if (is_over()) return;
          for (size_t lane = 0; lane < 8; ++lane) {
            if (block.primitives[lane] == kNoPrimitive) continue;
            std::array<Vec3, 3> corners;
            for (size_t v = 0; v < 3; ++v)
              corners[v] = {block.vertices[v][0][lane], block.vertices[v][1][lane],
                            block.vertices[v][2][lane]};
            look_at(corners);
          }
        }
        return;
      case ChildKind::spheres:
        for (const SphereBlock& block : scene_.sphere_blocks.subspan(leaf.first, leaf.count())) {
          if (is_over()) return;
          for (const uint32_t i : block.spheres)
            if (i != kNone) look_at(scene_.spheres[i]);
        }
        return;
      case ChildKind::mixed:
        for (const PrimitiveId id : scene_.leaf_primitives.subspan(leaf.first, leaf.count())) {
          if (is_over()) return;
          if (id.kind() == PrimitiveKind::polygon)
            look_at(scene_.points_of(scene_.polygons[id.index()]));
          else if (id.kind() == PrimitiveKind::collection)
            enter(scene_.collections[id.index()]);
          else if (may_hold(local_, scene_.quadrics[id.index()].bounds))
            note(Presence::possible);
        }
        return;
      case ChildKind::empty:
      case ChildKind::inner:
        return;
    }
  }

  void enter(const Instance& instance, const InstancePose& pose) {
    if (pose.is_hidden) return;
    const Part& part = scene_.parts[instance.part];
    local_ = world_;
    if (!pose.is_identity)
      for (HalfSpace& h : local_) {
        h.d -= glm::dot(h.n, pose.world_from_object.translation);
        h.n = glm::transpose(pose.world_from_object.linear) * h.n;
      }
    enter(part.collection);
  }

  void enter(const Collection& collection) {
    if (may_hold(local_, collection.bounds)) walk(collection.root, scene_.nodes, local_);
  }

  void look_at(std::span<const Vec3> corners) {
    for (const Vec3& p : corners)
      if (std::all_of(local_.begin(), local_.end(),
                      [&](const HalfSpace& h) { return glm::dot(h.n, p) > h.d; }))
        return note(Presence::certain);
    const auto reaches = [&](const HalfSpace& h) {
      return std::any_of(corners.begin(), corners.end(),
                         [&](const Vec3& p) { return glm::dot(h.n, p) > h.d; });
    };
    if (std::all_of(local_.begin(), local_.end(), reaches)) note(Presence::possible);
  }

  void look_at(const SphereRecord& sphere) {
    bool holds_center = true, may_reach = true;
    for (const HalfSpace& h : local_) {
      const double along = glm::dot(h.n, sphere.center) - h.d;
      holds_center = holds_center && along > 0;
      may_reach = may_reach && along + sphere.radius * glm::length(h.n) > 0;
    }
    if (may_reach) note(holds_center ? Presence::certain : Presence::possible);
  }

  const Scene& scene_;
  std::vector<HalfSpace> world_, local_;  ///< the region in the world, and in the instance's space
  size_t& patience_;
  Presence found_ = Presence::none;
};

}  // namespace

Presence find_in_region(const Scene& scene, std::span<const HalfSpace> region, size_t& patience) {
  return Search(scene, region, patience).run();
}

}  // namespace rayfarm
