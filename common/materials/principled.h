#pragma once
// The principled material: a few parameters that artists know, from which lobes follow. It is glTF 2.0's
// metallic-roughness material (its appendix B) with the extensions ior, specular, transmission, volume,
// clearcoat, emissive_strength and unlit. Differences: metals are compensated for light that meets several
// facets (Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks"), and a coat's Fresnel
// term is that of the facet, not of the surface, so that light takes the same way back.
#include "common/materials/scattering.h"

namespace rayfarm {

/// What a texture may vary. Scalars first.
enum class PrincipledInput : uint32_t {
  metallic,
  roughness,
  specular,
  transmission,
  clearcoat,
  clearcoat_roughness,
  opacity,
  base_color,
  specular_color,
  emission,
  normal,           ///< the factor scales how far it leans
  clearcoat_normal  ///< as `normal`; without one a coat has the surface's
};
inline constexpr size_t kPrincipledInputs = 12;

/// What of a texture's colour is the value.
enum class TextureChannel : uint32_t { luminance, red, green, blue, color };

/// A parameter: a factor, times a texture if there is one.
struct PrincipledSource {
  Color factor{1};  ///< of scalars: its red
  uint32_t texture = kNone;
  TextureChannel channel = TextureChannel::color;
  /// The texture's (u, v) are u_row · (u, v, 1) and v_row · (u, v, 1) of the surface's.
  Vec3 u_row{1, 0, 0}, v_row{0, 1, 0};
  uint32_t uv_set = 0;  ///< 1: these are the second coordinates of meshes that have two
  uint32_t padding = 0;
};

/// A material's parameters: beside its Material, which names it. Base colour and emission are also weighed by
/// the Material's `color` and `emission`, which a colour pass converts; `index` there is of what is behind
/// the surface, 1 of sheets.
struct PrincipledMaterial {
  std::array<PrincipledSource, kPrincipledInputs> sources;
  double ior = 1.5;  ///< for what the surface reflects, if there is no inside
  /// Opacity below it is none, from it on all; 0: it is the probability that a ray meets the surface.
  double cutoff = 0;
  uint32_t is_one_sided = 0;  ///< 1: rays from behind do not meet it
  uint32_t has_textures = 0;  ///< 1: of anything but opacity
  /// 1: in classical models, and zones, its Material's coefficients scatter, and only its colour is the base
  /// colour; 0: those that are nearest to the parameters.
  uint32_t has_coefficients = 0;
  uint32_t padding = 0;

  PrincipledSource& operator[](PrincipledInput input) { return sources[static_cast<size_t>(input)]; }
  const PrincipledSource& operator[](PrincipledInput input) const {
    return sources[static_cast<size_t>(input)];
  }
};
/// Of a material that nobody describes further: a grey plastic.
PrincipledMaterial usual_principled();
/// For loaders, at the end: makes `material`, whose colours, index and bits is_solid and is_unlit are set
/// (with has_coefficients these, too), one of these parameters. What else follows from them is set in both.
void finish_principled(PrincipledMaterial& principled, Material& material);

/// Its parameters where a ray meets it.
struct PrincipledPoint {
  Color base{1}, specular_color{1};  ///< in the pass's channels
  double metallic = 0, roughness = 0.5, specular = 1, ior = 1.5, transmission = 0, coat = 0,
         coat_roughness = 0;
  Vec3 coat_normal{0};    ///< unit, on the viewer's side; 0: the surface's
  bool is_solid = false;  ///< what it lets through is bent, and inside from there on; else it is a sheet
  bool is_black = false;  ///< it scatters nothing (unlit)
};

/// With all but its colours. `number(input)`: what an input is there.
template <typename Number>
PrincipledPoint principled_point(const PrincipledMaterial& m, const Material& material, Number number) {
  PrincipledPoint p;
  p.metallic = number(PrincipledInput::metallic);
  p.roughness = number(PrincipledInput::roughness);
  p.specular = number(PrincipledInput::specular);
  p.transmission = number(PrincipledInput::transmission);
  p.coat = number(PrincipledInput::clearcoat);
  p.coat_roughness = number(PrincipledInput::clearcoat_roughness);
  p.ior = m.ior;
  p.is_solid = material.is_solid != 0;
  p.is_black = material.is_unlit != 0;
  return p;
}

void scatter_principled(const PrincipledPoint& p, const Interaction& at, Lobes& lobes);
Scattered eval_principled(const Lobes& lobes, const Interaction& at, const Vec3& direction);
ScatteredRay sample_principled(const Lobes& lobes, const Interaction& at, const Vec2& direction, double lobe);

/// The nearest coefficients of the classical models, and of zones: sets what says how the material scatters,
/// but not its indices nor what it emits. Beside Material's own: `back` is the colour of what it reflects.
void set_nearest_coefficients(const PrincipledPoint& p, Material& material);
/// Lobes by those coefficients, where light is kept in zones.
void scatter_by_coefficients(const Material& material, const Interaction& at, Lobes& lobes);

}  // namespace rayfarm
