#pragma once
// What the user asks of a render, beside the scene: today's "rendering code", which load code carries to
// every node.
#include <array>

#include "common/image/pixel_format.h"
#include "common/image/pixel_rect.h"
#include "common/materials/spectrum.h"
#include "common/sampling/pixel_filter.h"
#include "common/sampling/sampler.h"
#include "common/scene/projection.h"
#include "common/scene/zone_settings.h"

namespace rayfarm {

enum class LightingModel : uint8_t { phong, torrance_sparrow, whitted, thesis, path, radiosity, zonal };

/// True if light is kept in zones, which are solved before pictures are made.
inline bool has_zones(LightingModel model) {
  return model == LightingModel::radiosity || model == LightingModel::zonal;
}
/// True if pictures follow paths: of light all the way, or from what zones hold.
inline bool follows_paths(LightingModel model) {
  return model == LightingModel::path || has_zones(model);
}

/// By what the thesis's diffuse rays share the hemisphere evenly, θ from the normal (section 3.3): the light
/// that passes, sin²θ; or the volume of their cones within the lobe of Lambert's law, 1 - cos⁴θ.
enum class DiffuseBands : uint8_t { flux, cone };

/// How the thesis's set of diffuse directions meets the picture: turned about the normal and dealt out at
/// random, anew for each pixel; or laid out once for the whole picture.
enum class DiffuseSet : uint8_t { turned, fixed };

/// Of corner sampling: the parts that a pixel is cut into, whose corners rays go through.
struct Subpixels {
  uint32_t columns = 1, rows = 1;

  static constexpr uint32_t kMost = 64;  ///< of columns, and of rows
  uint32_t corners() const { return (columns + 1) * (rows + 1); }

  template <typename Archive>
  void serialize(Archive& archive) {
    archive(columns, rows);
  }
  friend bool operator==(const Subpixels&, const Subpixels&) = default;
};

/// What bodies that transmit light do to shadow rays.
enum class GlassShadows : uint8_t {
  blocked,      ///< they stop them as others do
  transparent,  ///< they let them go straight on, weakened (thesis 2.2.4: nonrefractive transparent objects)
  none          ///< they cast no shadow (thesis 3.5.1: many researchers omit it)
};

/// What becomes of the item that a z-buffer found nearest at a corner of a pixel (Weghorst, Hooper and
/// Greenberg 1984, section 4).
enum class ItemBuffer : uint8_t {
  none,     ///< there is no such buffer
  bound,    ///< where an eye ray hits it, nothing behind is searched: pictures stay as they are
  trusted,  ///< nothing else is tested (theirs)
  checked   ///< the same; and an ordinary search tells how often it would have found something else
};
inline constexpr std::array kItemBufferWords{"none", "bound", "trusted", "checked"};
/// The most corners of an item buffer, and points of all lights' maps of items: of 12 bytes each.
inline constexpr int64_t kMostItemPoints = 1 << 26;
/// Of corners that tell of a sample: at the least so that each sample has one.
inline constexpr double kLeastItemRadius_px = 0.75, kMostItemRadius_px = 8;
/// Along a side of a light's map of items.
inline constexpr uint32_t kLeastLightCells = 2, kMostLightCells = 3344;

/// How a ray is kept from hitting the surface that it leaves.
enum class SelfHit : uint8_t {
  bound,  ///< it starts off the surface by a bound on the rounding error of where that was hit
  medium  ///< it can't hit a side on which there is not what it is in (Shirley, Sung and Brown 1991, 3.1)
};
inline constexpr std::array kSelfHitWords{"bound", "medium"};

/// What weighs ambient light (thesis 2.2.2).
enum class AmbientColour : uint8_t { surface, light };

/// The most rays of one lobe: rays that a surface reflects, or transmits.
inline constexpr uint32_t kMostLobeRays = 1000;
/// Of a pixel. Sobol's sequence has 2³² points: those of all rays that gather for all samples are among them.
inline constexpr uint32_t kMostSamples = 1 << 20;
static_assert(uint64_t{kMostSamples} * kMostGatherRays <= uint64_t{1} << 32);

/// Of pictures, brighter or darker.
inline constexpr double kMostExposure_stops = 64;

/// The depth of paths if nothing else is asked for: roulette ends nearly all long before.
inline constexpr uint32_t kPathDepth = 100;
/// The greatest depth that can be asked for.
inline constexpr uint32_t kMostDepth = 1000;

/// Everything that a pixel's value depends on beside scene, frame and position.
struct RenderSettings {
  int width_px = 512, height_px = 512;
  PixelRect crop{0, 0, 512, 512};  ///< what is rendered of the image
  Fit fit = Fit::width;
  LightingModel lighting = LightingModel::whitted;
  SamplingPattern sampling = SamplingPattern::sobol;
  FilterKind filter = FilterKind::box;
  ColourModel colour = ColourModel::rgb;
  std::vector<double> colour_nodes_nm;  ///< of the spectral model; none: the scene's
  double exposure_stops = 0;            ///< pictures hold 2^stops times the light that there is
  double shutter = 0;                   ///< how long it is open, in frames
  uint32_t samples = 1;                 ///< per pixel; 1 where rays go through corners
  Subpixels subpixels;                  ///< other than one only where rays go through corners
  /// Pixels whose first samples differ by no more than this from their neighbours' get no others; 0: all do.
  double adaptive_contrast = 0;
  /// A pixel gets no more samples when its mean's standard error on the display's range (0 to 1) is no
  /// greater; 0: all samples are taken.
  double noise = 0;
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
  /// N_RS and N_T of Equation 3.2: rays that a surface with an exponent reflects and transmits in the models
  /// of Whitted and of the thesis, spread over its lobe; 1: along its axis.
  uint32_t reflected_rays = 1, transmitted_rays = 1;
  GlassShadows glass_shadows = GlassShadows::blocked;
  AmbientColour ambient_colour = AmbientColour::surface;
  SelfHit self_hit = SelfHit::bound;
  bool diffuse_jitter = false;  ///< each diffuse ray anywhere in its part of a band, not in its middle
  DiffuseBands diffuse_bands = DiffuseBands::flux;
  DiffuseSet diffuse_set = DiffuseSet::turned;
  ItemBuffer item_buffer = ItemBuffer::none;
  double item_radius_px = 1;  ///< corners so near to a sample tell of it; one that is a corner needs no other
  uint32_t light_cells = 0;   ///< along a side of each light's map of items; 0: they have none
  ZoneSettings zones;
  uint64_t seed = 0;
  PixelFormat pixel_format = PixelFormat::half_float;

  SamplerSettings sampler() const { return {sampling, samples, seed}; }

  template <typename Archive>
  void serialize(Archive& archive) {
    auto jitter = static_cast<uint8_t>(diffuse_jitter ? 1 : 0);  // a bool holds no other byte
    archive(width_px, height_px, crop, fit, lighting, colour, pixel_format, seed);
    archive(sampling, samples, subpixels, filter, shutter, adaptive_contrast, noise, exposure_stops);
    archive(max_reflections, max_transmissions, max_depth, min_weight);
    archive(diffuse_rays, diffuse_reach, diffuse_contrast, jitter, diffuse_bands, diffuse_set);
    archive(reflected_rays, transmitted_rays, glass_shadows, ambient_colour);
    archive(item_buffer, item_radius_px, light_cells, self_hit, zones);
    diffuse_jitter = jitter != 0;
    // A count off the wire asks for no more memory than is allowed; one too large is refused by the checks.
    auto nodes = static_cast<uint32_t>(colour_nodes_nm.size());
    archive(nodes);
    colour_nodes_nm.resize(std::min<size_t>(nodes, kMostColourNodes + 1));
    for (double& nm : colour_nodes_nm) archive(nm);
  }
};

/// The depth alone limits, whatever the rays are.
inline void limit_by_depth(RenderSettings& settings, uint32_t depth) {
  settings.max_depth = depth;
  settings.max_reflections = settings.max_transmissions = depth - 1;
}

/// The most directions that the diffuse rays of a pixel are spread over; every renderer holds them.
inline constexpr uint64_t kMostDiffuseDirections = 1 << 22;

/// The samples of a pixel, over which the thesis spreads one set of diffuse rays: for rays through corners as
/// many as a pixel has, (a + 1)(b + 1) (section 3.4.1), though neighbours share them.
inline uint64_t samples_that_share_directions(const RenderSettings& settings) {
  return settings.sampling == SamplingPattern::corners ? settings.subpixels.corners() : settings.samples;
}
/// 0 in other models.
inline uint64_t diffuse_directions_of(const RenderSettings& settings) {
  return settings.lighting == LightingModel::thesis
             ? settings.diffuse_rays * samples_that_share_directions(settings)
             : 0;
}

}  // namespace rayfarm
