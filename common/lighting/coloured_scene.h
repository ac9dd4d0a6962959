#pragma once
// The scene as one colour pass sees it: materials and lights with the pass's channels in place of red, green
// and blue. All else is shared with the scene block.
#include "common/lighting/frame_lights.h"
#include "common/scene/render_settings.h"
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
  Color* color_of(const SpectralColor& c);

  ColourPass pass_;
  Scene scene_;
  std::vector<SceneHeader> header_;
  std::vector<Material> materials_;
  std::vector<Light> lights_;  ///< all of them
  std::vector<ParticipatingMedium> media_;
  std::vector<Light> shining_;
  std::vector<double> shares_;
};

/// The wavelengths, in nm, at which the settings' colour model knows spectra; none for RGB. The general model
/// (Shirley, Sung and Brown 1991, section 2.1) has those of all colours of the scene, so that each is what it
/// is, and products of theirs are right at every node.
std::vector<double> colour_nodes(const Scene& scene, const RenderSettings& settings);

/// One for each pass of a job.
std::vector<ColouredScene> make_coloured_scenes(const Scene& scene, const RenderSettings& settings);

}  // namespace rayfarm
