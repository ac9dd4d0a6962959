#pragma once
// The light that one method of smooth shading shows on a turning ball of pentagons and hexagons.
#include <memory>

#include "common/compile/compile.h"
#include "common/hierarchy/frame_state.h"
#include "common/lighting/integrators/integrator.h"
#include "common/scene/camera.h"

namespace rayfarm {

/// The ways to shade. The first four are the renderer's own. The last two are Gouraud's and Phong's as they
/// were published, and as the thesis shows them (Figure 2.11b): linear along two edges to the picture's line
/// through the point, and along that line.
enum class ShadingMethod { flat, gouraud, phong, center, gouraud_by_lines, phong_by_lines };
inline constexpr std::array kShadingMethods{
    ShadingMethod::flat,   ShadingMethod::gouraud,          ShadingMethod::phong,
    ShadingMethod::center, ShadingMethod::gouraud_by_lines, ShadingMethod::phong_by_lines};
const char* name_of(ShadingMethod method);

inline constexpr int kBallFrames = 60;
inline constexpr double kDegreesPerFrame = 1.5;

/// White, lit by one source that stands at the eye, at (0, 0, 4): what faces it shows 1.
class ShadedBall {
 public:
  /// `axis`: about which it turns from frame to frame.
  ShadedBall(ShadingMethod method, const Vec3& axis);

  void set_frame(double frame);
  /// Along a ray from the eye; 0 beside the ball.
  double intensity(const Ray& ray);
  /// Where a point of the ball stands in this frame.
  Vec3 in_world(const Vec3& p) const { return pose_->operator[](0).world_from_object.point(p); }
  /// Of the current frame, for a square picture.
  Camera camera(int side_px) const;
  static Vec3 eye() { return {0, 0, 4}; }
  const Scene& scene() const { return compiled_.scene; }

 private:
  double by_lines(const Hit& hit, const Vec3& p) const;

  ShadingMethod method_;
  CompiledScene compiled_;
  FrameState state_;
  std::optional<Pose> pose_;
  double frame_ = 0;
  RenderSettings settings_;
  SamplingTables tables_;
  std::unique_ptr<Integrator> integrator_;
};

}  // namespace rayfarm
