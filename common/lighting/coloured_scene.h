#pragma once
// The scene as one colour pass sees it: materials and lights with the pass's channels in place of red, green
// and blue. All else is shared with the scene block.
#include "common/lighting/frame_lights.h"
#include "common/materials/spectrum.h"
#include "common/scene/scene.h"

namespace rayfarm {

class ColouredScene {
 public:
  ColouredScene(const Scene& scene, const ColourPass& pass);
  ColouredScene(ColouredScene&&) = default;  // what the view looks at stays where it is
  const Scene& scene() const { return scene_; }
  const ColourPass& pass() const { return pass_; }
  /// From now on these sources shine, of all that there are.
  void set_lights(const FrameLights& lights);

 private:
  ColourPass pass_;
  Scene scene_;
  std::vector<SceneHeader> header_;
  std::vector<Material> materials_;
  std::vector<Light> lights_;  ///< all of them
  std::vector<Light> shining_;
  std::vector<double> shares_;
};

/// One for each pass of a job.
std::vector<ColouredScene> make_coloured_scenes(const Scene& scene, ColourModel model);

}  // namespace rayfarm
