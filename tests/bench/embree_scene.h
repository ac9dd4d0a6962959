#pragma once
// A compiled scene's geometry in Embree: parts that move become instances.
#include <embree3/rtcore.h>

#include "ray_sets.h"

namespace rayfarm::bench {

class EmbreeScene {
 public:
  /// Throws std::runtime_error if Embree fails.
  EmbreeScene(const Scene& scene, RTCSceneFlags flags);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// The hits of rays [begin, end) of the set, which embree_rays made into Embree's.
  size_t trace(const RaySet& set, const std::vector<RTCRay>& rays, size_t begin, size_t end) const;
  double build_cpu_s() const { return build_cpu_s_; }  ///< of all threads
  double build_s() const { return build_s_; }
  ssize_t bytes() const { return bytes_; }

 private:
  RTCScene new_scene(RTCSceneFlags flags);
  static void finish(RTCScene scene, RTCGeometry geometry);
  void attach(RTCScene scene, const PartGeometry& from) const;

  RTCDevice device_;
  RTCScene root_ = nullptr;
  double build_cpu_s_ = 0, build_s_ = 0;
  ssize_t bytes_ = 0;
};

std::vector<RTCRay> embree_rays(const RaySet& set);

}  // namespace rayfarm::bench
