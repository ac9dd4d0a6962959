// Hits against brute force in double: for every scene a number of random rays, aimed at nothing, at vertices,
// at points on edges, along axes and out of the middle, is traced alone, in packets and for any hit, and
// compared with testing every primitive. Any difference is printed and makes the exit code 1.
//
//   check_hits RAYS SCENE... [--hierarchy NAME] [--build ...]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <random>
#include <thread>

#include "common/compile/compile.h"
#include "common/hierarchy/traverser.h"
#include "host/commands/hierarchy_options.h"

namespace {

using namespace rayfarm;

class Checker {
 public:
  explicit Checker(const CompiledScene& compiled)
      : scene_(compiled.scene), frame_pose_(scene_), pose_(frame_pose_.at(0)) {
    for (uint32_t i = 0; i < scene_.instances.size(); ++i) bounds_.grow(pose_[i].bounds);
  }

  /// The number of rays for which an answer differs.
  size_t check(size_t rays, uint64_t seed) const {
    std::mt19937_64 random(seed);
    size_t mismatches = 0;
    std::vector<Ray> packet;
    for (size_t done = 0; done < rays; done += packet.size()) {
      packet.clear();
      const Ray first = random_ray(random);
      for (size_t i = 0; i < std::min(kMostPacketRays, rays - done); ++i) {
        // Half of the packets are bundles of neighbours, the others eight strangers.
        Ray ray = done / kMostPacketRays % 2 == 0 ? first : random_ray(random);
        if (done / kMostPacketRays % 2 == 0)
          ray.direction += 0.01 * glm::length(ray.direction) * unit_vector(random);
        packet.push_back(ray);
      }
      mismatches += check_packet(packet);
    }
    return mismatches;
  }

 private:
  static bool is_same(const Hit& a, const Hit& b) {
    return a.instance == b.instance && (!a.is_hit() || (a.t == b.t && a.primitive == b.primitive));
  }

  size_t check_packet(const std::vector<Ray>& rays) const {
    std::array<Hit, kMostPacketRays> hits;
    closest_hits(scene_, pose_, RayPacket(rays), hits.data());
    const uint32_t any = any_hits(scene_, pose_, RayPacket(rays));
    size_t mismatches = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      const Hit expected = closest_hit_brute_force(scene_, pose_, rays[i]);
      const bool is_any = expected.is_hit() && expected.t < rays[i].t_max;
      if (is_same(closest_hit(scene_, pose_, rays[i]), expected) && is_same(hits[i], expected) &&
          any_hit(scene_, pose_, rays[i]) == is_any && (any >> i & 1) == static_cast<uint32_t>(is_any))
        continue;
      ++mismatches;
      const Vec3 &o = rays[i].origin, &d = rays[i].direction;
      fmt::print("differs: from ({:a}, {:a}, {:a}) along ({:a}, {:a}, {:a})\n", o.x, o.y, o.z, d.x, d.y, d.z);
    }
    return mismatches;
  }

  static Vec3 unit_vector(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    return normalized(Vec3(normal(random), normal(random), normal(random)));
  }

  Ray random_ray(std::mt19937_64& random) const {
    std::uniform_real_distribution<double> unit;
    const Vec3 extent = bounds_.extent();
    const auto point = [&](double margin) {
      return bounds_.lo - margin * extent +
             (1 + 2 * margin) * Vec3(unit(random), unit(random), unit(random)) * extent;
    };
    Ray ray{point(0.5), unit_vector(random)};
    switch (random() % 5) {
      case 0:  // anywhere
        break;
      case 1:  // along an axis, with zeros of both signs
        ray.direction = Vec3(0);
        for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = random() % 2 == 0 ? 0.0 : -0.0;
        ray.direction[static_cast<int>(random() % 3)] = random() % 2 == 0 ? 1 : -1;
        ray.origin = point(0);
        break;
      case 2:  // out of the middle
        ray.origin = bounds_.center();
        break;
      default:  // at a vertex or a point on an edge
        if (!scene_.triangle_blocks.empty()) ray.direction = point_on_edge(random) - ray.origin;
    }
    if (random() % 4 == 0) ray.t_max = unit(random) * max_component(extent) / max_magnitude(ray.direction);
    return ray;
  }

  Vec3 point_on_edge(std::mt19937_64& random) const {
    const TriangleBlock& block = scene_.triangle_blocks[random() % scene_.triangle_blocks.size()];
    const size_t a = random() % 3, b = random() % 3;
    const auto vertex = [&](size_t k) {
      return Vec3(block.vertices[k][0][0], block.vertices[k][1][0], block.vertices[k][2][0]);
    };
    const InstancePose& pose = pose_[static_cast<uint32_t>(random() % scene_.instances.size())];
    return pose.world_from_object.point(0.5 * vertex(a) + 0.5 * vertex(b));
  }

  const Scene& scene_;
  FrameState frame_pose_;
  Pose pose_;
  Box bounds_;
};

}  // namespace

int main(int argc, char** argv) {
  BuildOptions build;
  uint32_t rays = 0;
  std::vector<std::string> scenes;
  CLI::App app("Compares hits with brute force.");
  Options options(&app);
  options.number("RAYS", rays, 1, 1'000'000'000, "rays for each scene").required();
  app.add_option("SCENE", scenes, "one or more")->required();
  add_hierarchy_options(options, build);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  }
  size_t all = 0;
  for (const std::string& scene : scenes) try {
      const CompiledScene compiled = compile(load_scene(scene), build);
      const Checker checker(compiled);
      const size_t threads = std::max(1u, std::thread::hardware_concurrency());
      std::atomic<size_t> mismatches = 0;
      {
        std::vector<std::jthread> workers;
        for (size_t t = 0; t < threads; ++t)
          workers.emplace_back([&, t] {
            const size_t share =
                static_cast<size_t>(rays) * (t + 1) / threads - static_cast<size_t>(rays) * t / threads;
            mismatches += checker.check(share, t + 1);
          });
      }
      fmt::print("{}: {} of {} rays differ from brute force\n", scene, mismatches.load(), rays);
      std::fflush(stdout);
      all += mismatches;
    } catch (const std::exception& e) {
      fmt::print(stderr, "check_hits: {}\n", e.what());
      return 1;
    }
  return all == 0 ? 0 : 1;
}
