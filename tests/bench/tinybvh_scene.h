#pragma once
// Triangles in tinybvh's BVH8_CPU, its fastest structure for single rays. tinybvh is one header that the user
// fetches (github.com/jbikker/tinybvh) and names to CMake: -DRAYFARM_TINYBVH=FOLDER; nothing of it is
// shipped, and without it there is no such scene. Its header, warnings and instruction sets stay in
// tinybvh_scene.cpp, which therefore includes nothing of Rayfarm's: a function of both would be linked once,
// as either compiled it.
#include <array>
#include <memory>
#include <span>
#include <string>

namespace rayfarm::bench {

enum class TinyBvhBuild {
  sah,            ///< Build: binned by surface areas
  spatial_splits  ///< BuildHQ
};

struct TinyBvhRay {
  std::array<float, 3> origin, direction;  ///< the direction has unit length
  float t_max;                             ///< infinite: none
};

class TinyBvhScene {
 public:
  /// False if it was not built in, or this machine lacks its instructions (AVX2 and FMA).
  static bool is_available();
  /// As the header states it; empty if it was not built in.
  static std::string version();

  /// 9 coordinates a triangle.
  TinyBvhScene(std::span<const float> triangle_vertices, TinyBvhBuild build);
  ~TinyBvhScene();
  TinyBvhScene(const TinyBvhScene&) = delete;
  TinyBvhScene& operator=(const TinyBvhScene&) = delete;

  /// Takes the rays that trace() is to follow.
  void set_rays(std::span<const TinyBvhRay> rays);
  /// The hits of rays [begin, end): the closest, or any before t_max.
  size_t trace_closest(size_t begin, size_t end);
  size_t trace_any(size_t begin, size_t end) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfarm::bench
