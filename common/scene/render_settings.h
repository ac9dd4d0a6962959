#pragma once
// What the user asks of a render, beside the scene: today's "rendering code", which load code carries to
// every node.
#include "common/image/pixel_format.h"
#include "common/image/pixel_rect.h"
#include "common/materials/spectrum.h"
#include "common/sampling/pixel_filter.h"
#include "common/sampling/sampler.h"

namespace rayfarm {

enum class LightingModel : uint8_t { phong, torrance_sparrow, whitted, thesis, path };

/// The depth of paths if nothing else is asked for: roulette ends nearly all long before.
inline constexpr uint32_t kPathDepth = 100;
/// The greatest depth that can be asked for.
inline constexpr uint32_t kMostDepth = 1000;

/// Everything that a pixel's value depends on beside scene, frame and position.
struct RenderSettings {
  int width_px = 512, height_px = 512;
  PixelRect crop{0, 0, 512, 512};  ///< what is rendered of the image
  LightingModel lighting = LightingModel::whitted;
  SamplingPattern sampling = SamplingPattern::sobol;
  FilterKind filter = FilterKind::box;
  ColourModel colour = ColourModel::rgb;
  double shutter = 0;    ///< how long it is open, in frames
  uint32_t samples = 1;  ///< per pixel
  /// Pixels whose first samples differ by no more than this from their neighbours' get no others; 0: all do.
  double adaptive_contrast = 0;
  /// Limits of each branch of the lighting tree, or of a path, by the kinds of its rays; diffuse ones count
  /// as reflected. "After about four or five reflections or about seven transparent objects there is little
  /// more" (thesis 2.3.4).
  uint32_t max_reflections = 4, max_transmissions = 7;
  uint32_t max_depth = 12;    ///< of all kinds; the eye ray is depth 1, and both limits fit in
  double min_weight = 1e-6;   ///< rays that would contribute less are not traced; 0: no cut-off
  uint32_t diffuse_rays = 1;  ///< N_D of the thesis's model, per hit
  double diffuse_reach = 0;   ///< where a diffuse ray's strength has fallen to a half; 0: it never falls
  /// Difference of neighbouring diffuse rays, times weight, that calls for one more; 0: never.
  double diffuse_contrast = 0;
  bool diffuse_jitter = false;  ///< each diffuse ray anywhere in its part of a band, not in its middle
  uint64_t seed = 0;
  PixelFormat pixel_format = PixelFormat::half_float;

  SamplerSettings sampler() const { return {sampling, samples, seed}; }

  template <typename Archive>
  void serialize(Archive& archive) {
    auto jitter = static_cast<uint8_t>(diffuse_jitter ? 1 : 0);  // a bool holds no other byte
    archive(width_px, height_px, crop, lighting, sampling, filter, colour, shutter, samples,
            adaptive_contrast, max_reflections, max_transmissions, max_depth, min_weight, diffuse_rays,
            diffuse_reach, diffuse_contrast, jitter, seed, pixel_format);
    diffuse_jitter = jitter != 0;
  }
};

/// The depth alone limits, whatever the rays are.
inline void limit_by_depth(RenderSettings& settings, uint32_t depth) {
  settings.max_depth = depth;
  settings.max_reflections = settings.max_transmissions = depth - 1;
}

/// The most directions that the diffuse rays of a pixel are spread over; every renderer holds them.
inline constexpr uint64_t kMostDiffuseDirections = 1 << 22;

/// Their number: the thesis spreads one set of diffuse rays over all the samples of a pixel;
/// over four for rays through corners, each of which four pixels share.
inline uint64_t samples_that_share_directions(const RenderSettings& settings) {
  return settings.sampling == SamplingPattern::corners ? 4 : settings.samples;
}
/// 0 in other models.
inline uint64_t diffuse_directions_of(const RenderSettings& settings) {
  return settings.lighting == LightingModel::thesis
             ? settings.diffuse_rays * samples_that_share_directions(settings)
             : 0;
}

}  // namespace rayfarm
