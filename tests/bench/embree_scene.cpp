#include "embree_scene.h"

#include <chrono>

namespace rayfarm::bench {
namespace {

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

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene, RTCSceneFlags flags) : device_(rtcNewDevice(nullptr)) {
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
  const double begin_cpu = cpu_s();
  const auto begin = std::chrono::steady_clock::now();
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
  build_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  build_cpu_s_ = cpu_s() - begin_cpu;
  for (RTCScene part : parts)
    if (part) rtcReleaseScene(part);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree reports an error");
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(root_);
  rtcReleaseDevice(device_);
}

RTCScene EmbreeScene::new_scene(RTCSceneFlags flags) {
  RTCScene scene = rtcNewScene(device_);
  rtcSetSceneFlags(scene, flags);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

void EmbreeScene::finish(RTCScene scene, RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::attach(RTCScene scene, const PartGeometry& from) const {
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

std::vector<RTCRay> embree_rays(const RaySet& set) {
  std::vector<RTCRay> rays;
  rays.reserve(set.rays.size());
  for (const Ray& ray : set.rays) rays.push_back(embree_ray(ray));
  return rays;
}

size_t EmbreeScene::trace(const RaySet& set, const std::vector<RTCRay>& rays, size_t begin,
                          size_t end) const {
  size_t hits = 0;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = begin; i < end; ++i) {
    if (set.is_any_hit) {
      RTCRay ray = rays[i];
      rtcOccluded1(root_, &context, &ray);
      hits += ray.tfar < 0;
    } else {
      RTCRayHit hit;
      hit.ray = rays[i];
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(root_, &context, &hit);
      hits += hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
  }
  return hits;
}

}  // namespace rayfarm::bench
