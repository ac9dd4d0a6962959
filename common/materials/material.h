#pragma once
// What a surface is made of: plain data, the same in a scene's description and in its compiled block.
#include <array>
#include <cstdint>

#include "common/math/index.h"
#include "common/math/vector.h"

namespace rayfarm {

/// Families, each with the parameters that shape it (Shirley, Sung and Brown 1991, section 2.4), beside the
/// classical coefficients.
enum class MaterialKind : uint32_t {
  classical,   ///< color, ambient, diffuse, specular, shininess, reflect, transmit, index, interior, exponent
  lambertian,  ///< color: the albedo
  conductor,   ///< n, k, exponent
  dielectric,  ///< index, filter, exponent, priority
  polished,    ///< color: the substrate's albedo; index, exponent: of the polish
  translucent,  ///< color, back: the albedos of the two sides; through: what passes diffusely
  luminaire,    ///< color: the albedo; emission, exponent, is_inward
  mix,          ///< parts, texture: which of them is where; nothing else of it is read
  principled  ///< principled: its parameters; color, emission, filter, index; the classical coefficients, and
              ///< back, the colour of what it reflects, are the nearest to it (principled.h)
};

inline constexpr std::array kMaterialKindWords{"classical",  "lambertian", "conductor",
                                               "dielectric", "polished",   "translucent",
                                               "luminaire",  "mix",        "principled"};

/// Which rays a material reflects ("It is useful to be able to turn off reflections from a particular
/// material": Shirley, Sung and Brown 1991, section 2.4). Light straight from sources is reflected always.
enum class Reflections : uint32_t {
  all,
  specular,  ///< along mirror directions, spread or not: the polish, but not the substrate
  none
};

struct Material {
  // The coefficients of Equations 2.4 and 2.12. The families fill them in too, for the classical lighting
  // models.
  Color color{1};
  double ambient = 0.2, diffuse = 0.8, specular = 0, shininess = 20, reflect = 0, transmit = 0;
  double index = 1;  ///< of refraction, inside the surface relative to outside

  // What every hit asks for stands together with the above.
  MaterialKind kind = MaterialKind::classical;
  int32_t priority = 0;  ///< where dielectrics overlap the one of the highest priority is there
  uint32_t texture = kNone, bump = kNone;
  Color emission{0};  ///< radiance along the normal
  Color interior{1};  ///< weighs what a classical surface transmits (thesis 3.2)
  Reflections reflections = Reflections::all;
  float zone_size = 0;  ///< of zones on it, in the world; 0: as is asked for all
  // Of a principled material; 1: it holds.
  uint8_t is_solid = 0;     ///< it lets light into a body, as a dielectric does
  uint8_t is_pierced = 0;   ///< rays may pass it as if it were not there (lighting/holes.h)
  uint8_t is_unlit = 0;     ///< it shines with its colour to both sides, and scatters nothing
  uint8_t is_no_lamp = 0;   ///< it shines, but no shadow ray is sent to it
  uint32_t is_colored = 0;  ///< 1: colours of meshes' vertices weigh its color, and their opacity its own

  double bump_height = 0;  ///< of the bump texture's white over its black
  /// Spread of what is reflected or refracted, cosⁿ about its direction; 0: none, the surface is smooth. Of a
  /// luminaire: its radiance falls with cosⁿ.
  double exponent = 0;
  Color n{1}, k{0};        ///< complex index of refraction of a conductor
  uint32_t metal = kNone;  ///< whose n and k these are (materials/presets.h); none if given by number
  uint32_t is_inward = 0;  ///< 1: a luminaire shines from its back
  double abbe = 0;         ///< dispersion of a dielectric: its Abbe number; 0: none
  Color filter{1};         ///< what is left of light after one unit of length in a dielectric
  Color back{0}, through{0};
  /// Of a luminaire whose radiance differs by direction; with its axis and where its horizontal angle is 0,
  /// unit, in the object's space.
  uint32_t diagram = kNone;
  uint32_t principled = kNone;  ///< of the scene's principled materials
  Vec3 diagram_axis{0, -1, 0}, diagram_zero{1, 0, 0};
  /// Of a mix: materials before it. Where the texture is black the first is there, where it is white the
  /// second, in between each with that probability.
  std::array<uint32_t, 2> parts{kNone, kNone};
};

/// Of a mesh's vertex: linear Rec. 709 and opacity, 65535 for 1.
using VertexColor = glm::u16vec4;
inline constexpr VertexColor kWhiteVertex{65535};
inline VertexColor make_vertex_color(const Color& color, double opacity = 1) {
  const auto part = [](double x) {  // no number is 0
    return static_cast<uint16_t>(x > 0 ? std::min(x, 1.0) * 65535 + 0.5 : 0);
  };
  return {part(color.x), part(color.y), part(color.z), part(opacity)};
}

/// Light goes through its surface into a body that has an index and a filter.
inline bool has_inside(const Material& m) {
  return m.kind == MaterialKind::dielectric || m.is_solid != 0;
}
inline bool has_reflected_rays(const Material& m) {
  return m.reflections != Reflections::none;
}
inline bool has_diffuse_rays(const Material& m) {
  return m.reflections == Reflections::all;
}

}  // namespace rayfarm
