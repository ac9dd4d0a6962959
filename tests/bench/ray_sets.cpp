#include "ray_sets.h"

#include <bit>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <set>

#include "common/lighting/surface.h"
#include "common/scene/camera.h"

namespace rayfarm::bench {
namespace {

constexpr int kImageSize_px = 512;
constexpr int kTile_px = 32;

}  // namespace

PartGeometry geometry_of(const Scene& scene, const Part& part) {
  PartGeometry geometry;
  std::set<std::array<float, 9>> seen;  // a clipped triangle stands in several leaves
  for (uint32_t b = 0; b < part.triangle_block_count; ++b) {
    const TriangleBlock& block = scene.triangle_blocks[part.first_triangle_block + b];
    for (size_t lane = 0; lane < 8; ++lane) {
      if (block.primitives[lane] == kNoPrimitive) continue;
      std::array<float, 9> vertices;
      for (size_t i = 0; i < 9; ++i) vertices[i] = block.vertices[i / 3][i % 3][lane];
      if (seen.insert(vertices).second)
        geometry.triangle_vertices.insert(geometry.triangle_vertices.end(), vertices.begin(), vertices.end());
    }
  }
  std::vector<bool> seen_sphere(scene.spheres.size());
  for (uint32_t b = 0; b < part.sphere_block_count; ++b)
    for (const uint32_t sphere : scene.sphere_blocks[part.first_sphere_block + b].spheres) {
      if (sphere == kNone || seen_sphere[sphere]) continue;
      seen_sphere[sphere] = true;
      const SphereRecord& s = scene.spheres[sphere];
      for (const double v : {s.center.x, s.center.y, s.center.z, s.radius})
        geometry.spheres.push_back(static_cast<float>(v));
    }
  for (uint32_t i = 0; i < part.leaf_primitive_count; ++i) {
    const PrimitiveId id = scene.leaf_primitives[part.first_leaf_primitive + i];
    if (id.kind() != PrimitiveKind::polygon)
      throw std::runtime_error("the scene has quadrics, which Embree does not know");
    const auto points = scene.points_of(scene.polygons[id.index()]);
    for (size_t k = 1; k + 1 < points.size(); ++k)
      for (const Vec3& p : {points[0], points[k], points[k + 1]})
        for (int axis = 0; axis < 3; ++axis)
          geometry.triangle_vertices.push_back(static_cast<float>(p[axis]));
  }
  return geometry;
}

std::vector<RaySet> make_rays(const Scene& scene, const Pose& pose) {
  RaySet primary{"primary", false, {}, {}}, diffuse{"diffuse", false, {}, {}}, shadow{"shadow", true, {}, {}};
  const Camera camera = make_camera(scene, 0, kImageSize_px, kImageSize_px);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit;
  for (int tile = 0; tile < kImageSize_px * kImageSize_px / (kTile_px * kTile_px); ++tile)
    for (int i = 0; i < kTile_px * kTile_px; ++i) {
      const int columns = kImageSize_px / kTile_px;
      const int x = tile % columns * kTile_px + i % kTile_px, y = tile / columns * kTile_px + i / kTile_px;
      const Ray ray = camera.ray(x + 0.5, y + 0.5);
      primary.rays.push_back(ray);
      const Hit hit = closest_hit(scene, pose, ray);
      if (!hit.is_hit()) continue;
      Surface surface = eval_surface(scene, pose, ray, hit);
      surface.offset = 1e-4 * hit.t;  // enough for Embree's float
      const Vec3 n = surface.geometric_normal;
      const Vec3 u =
          normalized(std::abs(n.x) < 0.5 ? glm::cross(n, Vec3(1, 0, 0)) : glm::cross(n, Vec3(0, 1, 0)));
      const double phi = 2 * std::numbers::pi * unit(random), r2 = unit(random);
      const Vec3 direction =
          std::sqrt(r2) * (std::cos(phi) * u + std::sin(phi) * glm::cross(n, u)) + std::sqrt(1 - r2) * n;
      diffuse.rays.push_back({surface.ray_origin(direction), direction});
      const Vec3 to_light = scene.lights[0].position - surface.p;
      if (!(glm::dot(n, to_light) > 0)) continue;
      const Vec3 origin = surface.ray_origin(to_light);
      shadow.rays.push_back({origin, scene.lights[0].position - origin, 1});
    }
  std::vector<RaySet> sets{primary, diffuse, shadow};
  for (RaySet& set : sets) {
    set.packets.reserve(set.rays.size() / kMostPacketRays + 1);
    for (size_t i = 0; i < set.rays.size(); i += kMostPacketRays)
      set.packets.emplace_back(
          std::span(set.rays).subspan(i, std::min(kMostPacketRays, set.rays.size() - i)));
  }
  return sets;
}

std::unique_ptr<Subject> load_subject(const std::string& path) {
  auto subject = std::make_unique<Subject>();
  subject->name = std::filesystem::path(path).stem().string();
  subject->description = load_scene(path);
  subject->compiled = compile(subject->description);
  subject->frame = std::make_unique<FrameState>(subject->scene());
  subject->sets = make_rays(subject->scene(), subject->frame->at(0));
  return subject;
}

size_t trace(const Scene& scene, const Pose& pose, const RaySet& set, size_t begin, size_t end) {
  size_t hits = 0;
  for (size_t i = begin; i < end; ++i)
    hits +=
        set.is_any_hit ? any_hit(scene, pose, set.rays[i]) : closest_hit(scene, pose, set.rays[i]).is_hit();
  return hits;
}

size_t trace_packets(const Scene& scene, const Pose& pose, const RaySet& set, size_t begin, size_t end) {
  size_t hits = 0;
  std::array<Hit, kMostPacketRays> found;
  for (size_t i = begin / kMostPacketRays; i * kMostPacketRays < end; ++i) {
    const RayPacket& rays = set.packets[i];
    if (set.is_any_hit) {
      hits += static_cast<size_t>(std::popcount(any_hits(scene, pose, rays)));
    } else {
      closest_hits(scene, pose, rays, found.data());
      for (size_t k = 0; k < rays.size; ++k) hits += found[k].is_hit();
    }
  }
  return hits;
}

}  // namespace rayfarm::bench
