#include "tinybvh_scene.h"

#include <cmath>
#include <vector>

#ifdef RAYFARM_TINYBVH
#define TINYBVH_IMPLEMENTATION
#include <tiny_bvh.h>
#endif

namespace rayfarm::bench {

#ifdef RAYFARM_TINYBVH
struct TinyBvhScene::Impl {
  std::vector<tinybvh::bvhvec4> vertices;  // which the hierarchy keeps pointing to
  std::vector<tinybvh::Ray> rays;
  tinybvh::BVH8_CPU hierarchy;
};

bool TinyBvhScene::is_available() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

std::string TinyBvhScene::version() {
#ifdef TINY_BVH_VERSION_MAJOR
  return std::to_string(TINY_BVH_VERSION_MAJOR) + "." + std::to_string(TINY_BVH_VERSION_MINOR) + "." +
         std::to_string(TINY_BVH_VERSION_SUB);
#else
  return "a reimplementation (the header names no version)";
#endif
}

TinyBvhScene::TinyBvhScene(std::span<const float> triangle_vertices, TinyBvhBuild build)
    : impl_(std::make_unique<Impl>()) {
  for (size_t i = 0; i < triangle_vertices.size(); i += 3)
    impl_->vertices.emplace_back(triangle_vertices[i], triangle_vertices[i + 1], triangle_vertices[i + 2],
                                 0.0f);
  const auto triangles = static_cast<uint32_t>(impl_->vertices.size() / 3);
  if (build == TinyBvhBuild::spatial_splits)
    impl_->hierarchy.BuildHQ(impl_->vertices.data(), triangles);
  else
    impl_->hierarchy.Build(impl_->vertices.data(), triangles);
}

TinyBvhScene::~TinyBvhScene() = default;

void TinyBvhScene::set_rays(std::span<const TinyBvhRay> rays) {
  const auto vec3 = [](const std::array<float, 3>& v) { return tinybvh::bvhvec3(v[0], v[1], v[2]); };
  impl_->rays.clear();
  impl_->rays.reserve(rays.size());
  for (const TinyBvhRay& ray : rays)
    impl_->rays.emplace_back(vec3(ray.origin), vec3(ray.direction), std::min(ray.t_max, BVH_FAR));
}

size_t TinyBvhScene::trace_closest(size_t begin, size_t end) {
  size_t hits = 0;
  for (size_t i = begin; i < end; ++i) {
    tinybvh::Ray& ray = impl_->rays[i];
    ray.hit.t = BVH_FAR;  // as it was before it was traced last
    impl_->hierarchy.Intersect(ray);
    hits += ray.hit.t < BVH_FAR;
  }
  return hits;
}

size_t TinyBvhScene::trace_any(size_t begin, size_t end) const {
  size_t hits = 0;
  for (size_t i = begin; i < end; ++i) hits += impl_->hierarchy.IsOccluded(impl_->rays[i]);
  return hits;
}
#else
struct TinyBvhScene::Impl {};
bool TinyBvhScene::is_available() {
  return false;
}
std::string TinyBvhScene::version() {
  return "";
}
TinyBvhScene::TinyBvhScene(std::span<const float>, TinyBvhBuild) {}
TinyBvhScene::~TinyBvhScene() = default;
void TinyBvhScene::set_rays(std::span<const TinyBvhRay>) {}
size_t TinyBvhScene::trace_closest(size_t, size_t) {
  return 0;
}
size_t TinyBvhScene::trace_any(size_t, size_t) const {
  return 0;
}
#endif

}  // namespace rayfarm::bench
