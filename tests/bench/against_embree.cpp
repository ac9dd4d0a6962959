// Rayfarm's hierarchy against Embree's, one ray at a time: the same rays through the same triangles and
// spheres, in one process and one thread, in short chunks that alternate, so that both meet the same noise.
// Only the ratios of thread CPU time mean something.
//
//   against_embree [--benchmark_...] [--simd=TARGET] SCENE...
//
// For every scene: primary rays in tiles as a subpolygon gives them, one diffuse ray from each hit
// (distributed by the cosine), and one shadow ray from each hit to the first light; then the time and memory
// of the build.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <numbers>
#include <random>
#include <set>

#include "common/compile/compile.h"
#include "common/lighting/surface.h"
#include "common/scene/camera.h"

namespace {

using namespace rayfarm;

constexpr int kImageSize_px = 512;
constexpr int kTile_px = 32;
constexpr size_t kChunk = 2048;  // rays

double cpu_s(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
double thread_cpu_s() {
  return cpu_s(CLOCK_THREAD_CPUTIME_ID);
}
double process_cpu_s() {
  return cpu_s(CLOCK_PROCESS_CPUTIME_ID);
}

/// The geometry of a compiled part as Embree takes it.
struct PartGeometry {
  std::vector<float> triangle_vertices;  // 9 per triangle
  std::vector<float> spheres;            // x, y, z, radius
};

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
    if (id.kind() != PrimitiveKind::polygon) throw std::runtime_error("Embree has no quadrics");
    const auto points = scene.points_of(scene.polygons[id.index()]);
    for (size_t k = 1; k + 1 < points.size(); ++k)
      for (const Vec3& p : {points[0], points[k], points[k + 1]})
        for (int axis = 0; axis < 3; ++axis)
          geometry.triangle_vertices.push_back(static_cast<float>(p[axis]));
  }
  return geometry;
}

class EmbreeScene {
 public:
  EmbreeScene(const Scene& scene, RTCSceneFlags flags) : device_(rtcNewDevice(nullptr)) {
    if (!device_) throw std::runtime_error("Embree could not start");
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* self, ssize_t bytes, bool) {
          static_cast<EmbreeScene*>(self)->bytes_ += bytes;
          return true;
        },
        this);
    std::vector<PartGeometry> geometries;
    for (const Part& part : scene.parts) geometries.push_back(geometry_of(scene, part));
    const double begin = process_cpu_s();
    std::vector<RTCScene> parts(scene.parts.size(), nullptr);
    root_ = new_scene(flags);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
      const uint32_t part = scene.instances[i].part;
      const InstancePose& pose = scene.poses[i];
      if (pose.is_identity) {
        attach(root_, geometries[part]);
        continue;
      }
      if (!parts[part]) {
        parts[part] = new_scene(flags);
        attach(parts[part], geometries[part]);
        rtcCommitScene(parts[part]);
      }
      RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(instance, parts[part]);
      std::array<float, 12> matrix;
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
          matrix[static_cast<size_t>(3 * column + row)] =
              static_cast<float>(column < 3 ? pose.world_from_object.linear[column][row]
                                            : pose.world_from_object.translation[row]);
      rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
      finish(root_, instance);
    }
    rtcCommitScene(root_);
    build_cpu_s_ = process_cpu_s() - begin;
    for (RTCScene part : parts)
      if (part) rtcReleaseScene(part);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree reports an error");
  }
  ~EmbreeScene() {
    rtcReleaseScene(root_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCScene get() const { return root_; }
  double build_cpu_s() const { return build_cpu_s_; }
  ssize_t bytes() const { return bytes_; }

 private:
  RTCScene new_scene(RTCSceneFlags flags) {
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, flags);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    return scene;
  }
  static void finish(RTCScene scene, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  void attach(RTCScene scene, const PartGeometry& from) const {
    if (const size_t triangles = from.triangle_vertices.size() / 9) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                               3 * sizeof(float), 3 * triangles);
      std::copy(from.triangle_vertices.begin(), from.triangle_vertices.end(), static_cast<float*>(vertices));
      auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangles));
      for (uint32_t i = 0; i < 3 * triangles; ++i) indices[i] = i;
      finish(scene, geometry);
    }
    if (const size_t spheres = from.spheres.size() / 4) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
      void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                               4 * sizeof(float), spheres);
      std::copy(from.spheres.begin(), from.spheres.end(), static_cast<float*>(vertices));
      finish(scene, geometry);
    }
  }

  RTCDevice device_;
  RTCScene root_ = nullptr;
  double build_cpu_s_ = 0;
  ssize_t bytes_ = 0;
};

struct RaySet {
  std::string name;
  bool is_any_hit = false;
  std::vector<Ray> rays;
};

std::vector<RaySet> make_rays(const Scene& scene, const Pose& pose) {
  RaySet primary{"primary", false, {}}, diffuse{"diffuse", false, {}}, shadow{"shadow", true, {}};
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
  return {primary, diffuse, shadow};
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay r{};
  r.org_x = static_cast<float>(ray.origin.x), r.org_y = static_cast<float>(ray.origin.y);
  r.org_z = static_cast<float>(ray.origin.z);
  r.dir_x = static_cast<float>(ray.direction.x), r.dir_y = static_cast<float>(ray.direction.y);
  r.dir_z = static_cast<float>(ray.direction.z);
  r.tfar = static_cast<float>(ray.t_max);
  r.mask = ~0u;
  return r;
}

/// A loaded scene with its rays; shared by its benchmarks.
struct Subject {
  std::string name;
  SceneDescription description;
  CompiledScene compiled;
  std::unique_ptr<FrameState> pose;
  std::vector<RaySet> sets;
};

size_t trace_rayfarm(const Scene& scene, const Pose& pose, const RaySet& set, size_t begin, size_t end,
                     bool in_packets) {
  size_t hits = 0;
  if (in_packets) {
    std::array<Hit, kMostPacketRays> found;
    for (size_t i = begin; i < end; i += kMostPacketRays) {
      const RayPacket rays{std::span(set.rays).subspan(i, std::min(kMostPacketRays, end - i))};
      if (set.is_any_hit) {
        hits += static_cast<size_t>(std::popcount(any_hits(scene, pose, rays)));
      } else {
        closest_hits(scene, pose, rays, found.data());
        for (size_t k = 0; k < rays.size; ++k) hits += found[k].is_hit();
      }
    }
    return hits;
  }
  for (size_t i = begin; i < end; ++i)
    hits +=
        set.is_any_hit ? any_hit(scene, pose, set.rays[i]) : closest_hit(scene, pose, set.rays[i]).is_hit();
  return hits;
}

size_t trace_embree(const EmbreeScene& scene, const RaySet& set, const std::vector<RTCRay>& rays,
                    size_t begin, size_t end) {
  size_t hits = 0;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = begin; i < end; ++i) {
    if (set.is_any_hit) {
      RTCRay ray = rays[i];
      rtcOccluded1(scene.get(), &context, &ray);
      hits += ray.tfar < 0;
    } else {
      RTCRayHit hit;
      hit.ray = rays[i];
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene.get(), &context, &hit);
      hits += hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
  }
  return hits;
}

void compare_rays(benchmark::State& state, const Subject& subject, const RaySet& set, RTCSceneFlags flags,
                  bool in_packets) {
  const EmbreeScene embree(subject.compiled.scene, flags);
  std::vector<RTCRay> rays;
  for (const Ray& ray : set.rays) rays.push_back(embree_ray(ray));
  const Pose pose = subject.pose->at(0);
  double ours_s = 0, theirs_s = 0;
  size_t traced = 0, our_hits = 0, their_hits = 0, chunk = 0;
  const auto ours = [&](size_t begin, size_t end) {
    const double start = thread_cpu_s();
    our_hits += trace_rayfarm(subject.compiled.scene, pose, set, begin, end, in_packets);
    ours_s += thread_cpu_s() - start;
  };
  const auto theirs = [&](size_t begin, size_t end) {
    const double start = thread_cpu_s();
    their_hits += trace_embree(embree, set, rays, begin, end);
    theirs_s += thread_cpu_s() - start;
  };
  for (auto _ : state) {
    const double before = ours_s + theirs_s;
    for (size_t begin = 0; begin < rays.size(); begin += kChunk, ++chunk) {
      const size_t end = std::min(rays.size(), begin + kChunk);
      if (chunk % 2 == 0) ours(begin, end);
      theirs(begin, end);
      if (chunk % 2 == 1) ours(begin, end);
    }
    traced += rays.size();
    state.SetIterationTime(ours_s + theirs_s - before);
  }
  state.counters["ratio"] = theirs_s / ours_s;
  state.counters["rayfarm_Mray/s"] = 1e-6 * static_cast<double>(traced) / ours_s;
  state.counters["embree_Mray/s"] = 1e-6 * static_cast<double>(traced) / theirs_s;
  const auto differing =
      static_cast<double>(our_hits > their_hits ? our_hits - their_hits : their_hits - our_hits);
  state.counters["hits_differ"] = differing / static_cast<double>(traced);
  if (differing > 1e-3 * static_cast<double>(traced)) state.SkipWithError("the two do not hit the same");
}

/// CPU time of all threads, and bytes per primitive, of the volume hierarchies.
void compare_builds(benchmark::State& state, const Subject& subject) {
  double ours_s = 0, theirs_s = 0;
  double their_bytes = 0;
  for (auto _ : state) {
    const double start = process_cpu_s();
    const CompiledScene compiled = compile(subject.description);
    const double took_s = process_cpu_s() - start;
    ours_s += took_s;
    const EmbreeScene embree(compiled.scene, RTC_SCENE_FLAG_NONE);
    theirs_s += embree.build_cpu_s();
    their_bytes = static_cast<double>(embree.bytes());
    state.SetIterationTime(took_s + embree.build_cpu_s());
  }
  const Scene& scene = subject.compiled.scene;
  size_t primitives = 0;
  for (const Part& part : scene.parts)
    primitives += part.triangle_count + part.sphere_count + part.polygon_count + part.quadric_count;
  const double our_bytes =
      static_cast<double>(scene.nodes.size_bytes() + scene.triangle_blocks.size_bytes() +
                          scene.sphere_blocks.size_bytes() + scene.leaf_primitives.size_bytes());
  state.counters["time_ratio"] = ours_s / theirs_s;  // below 1: Rayfarm builds faster
  state.counters["rayfarm_s"] = ours_s / static_cast<double>(state.iterations());
  state.counters["embree_s"] = theirs_s / static_cast<double>(state.iterations());
  state.counters["rayfarm_bytes"] = our_bytes / static_cast<double>(primitives);
  state.counters["embree_bytes"] = their_bytes / static_cast<double>(primitives);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::vector<std::unique_ptr<Subject>> subjects;
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string argument = argv[i];
      if (argument.starts_with("--simd=")) {
        force_simd_target(argument.substr(7));
        continue;
      }
      auto subject = std::make_unique<Subject>();
      subject->name = std::filesystem::path(argument).stem().string();
      subject->description = load_scene(argument);
      subject->compiled = compile(subject->description);
      subject->pose = std::make_unique<FrameState>(subject->compiled.scene);
      subject->sets = make_rays(subject->compiled.scene, subject->pose->at(0));
      subjects.push_back(std::move(subject));
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "against_embree: {}\n", e.what());
    return 1;
  }
  if (subjects.empty()) {
    fmt::print(stderr, "usage: against_embree [--benchmark_...] [--simd=TARGET] SCENE...\n");
    return 2;
  }
  for (const auto& subject : subjects) {
    for (const RaySet& set : subject->sets)
      for (const auto& [mode, flags, in_packets] : {std::tuple{"default", RTC_SCENE_FLAG_NONE, false},
                                                    {"robust", RTC_SCENE_FLAG_ROBUST, false},
                                                    {"packets", RTC_SCENE_FLAG_NONE, true}})
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", subject->name, set.name, mode).c_str(),
            [&subject, &set, flags = flags, in_packets = in_packets](benchmark::State& state) {
              compare_rays(state, *subject, set, flags, in_packets);
            })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((subject->name + "/build").c_str(),
                                 [&subject](benchmark::State& state) { compare_builds(state, *subject); })
        ->UseManualTime()
        ->MinTime(5)  // a build is longer than a pass over the rays
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
