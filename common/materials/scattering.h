#pragma once
// What a material does with light (Shirley, Sung and Brown 1991, section 2.4): which rays it scatters, with
// which attenuation; what it sends to the viewer of light from one direction; what it emits. A material
// answers with a few lobes; sampling and evaluation are the same for all.
#include "common/materials/material.h"
#include "common/math/inline_vector.h"

namespace rayfarm {

struct PrincipledPoint;

/// Where a ray meets a surface.
struct Interaction {
  Vec3 to_viewer{0};       ///< unit
  Vec3 normal{0};          ///< unit, on the viewer's side
  bool is_front = true;    ///< the viewer is outside
  double index_ratio = 1;  ///< index of refraction behind the surface over that on the viewer's side
  /// Of a principled material, as it is here; it must outlive this. None: its nearest coefficients do.
  const PrincipledPoint* principled = nullptr;
};

/// A part of the scattered light that one distribution describes.
struct Lobe {
  enum class Spread : uint32_t {
    diffuse,  ///< cos θ / π about the axis
    glossy,   ///< (n + 1) / 2π cosⁿ α about the axis, cut off by the surface
    perfect   ///< along the axis alone
  };
  /// Which of a principled material's layers it is of: such a lobe is spread by the material, not by its
  /// exponent.
  enum class Layer : uint8_t { coat, facets, substrate };
  Spread spread = Spread::diffuse;
  bool is_transmitted = false;
  Vec3 axis{0};  ///< unit
  double exponent = 0;
  Color attenuation{0};  ///< of all the lobe's light; about, of a principled material's that is not perfect
  Layer layer = Layer::coat;
};
using Lobes = InlineVector<Lobe, 4>;

/// The rays that a material scatters.
void scatter(const Material& material, const Interaction& at, Lobes& lobes);

/// Radiance emitted to the viewer.
Color emitted(const Material& material, const Interaction& at);
inline bool is_luminaire(const Material& material) {
  return material.emission != Color(0);
}

/// Light from `direction` that reaches the viewer: BSDF × cosine, and the density with which `sample` chooses
/// the direction. Perfect lobes have neither.
struct Scattered {
  Color value{0};
  double pdf = 0;
};
Scattered eval(const Lobes& lobes, const Interaction& at, const Vec3& direction);

/// A direction to follow.
struct ScatteredRay {
  Vec3 direction{0};
  Color weight{0};  ///< BSDF × cosine / density; 0: the light is absorbed
  double pdf = 0;   ///< 0: of a perfect lobe
  Lobe::Spread spread = Lobe::Spread::diffuse;
  bool is_transmitted = false;
};
ScatteredRay sample(const Lobes& lobes, const Interaction& at, const Vec2& direction, double lobe);

/// Of what all lobes scatter.
double total_luminance(const Lobes& lobes);
/// A lobe chosen by luminance.
struct ChosenLobe {
  const Lobe* lobe = nullptr;
  double probability = 0;  ///< 0: there is none that scatters anything
};
ChosenLobe choose_lobe(const Lobes& lobes, double choice);

/// The mirror direction, and the refracted one (zero on total internal reflection).
inline Vec3 mirrored(const Interaction& at) {
  return normalized(2 * glm::dot(at.to_viewer, at.normal) * at.normal - at.to_viewer);
}
inline Vec3 refracted(const Interaction& at) {
  const double cosine = glm::dot(at.to_viewer, at.normal), eta = 1 / at.index_ratio;
  const double behind2 = 1 - eta * eta * (1 - cosine * cosine);
  if (behind2 < 0) return Vec3(0);
  return normalized((eta * cosine - std::sqrt(behind2)) * at.normal - eta * at.to_viewer);
}

/// Rec. 709.
inline double luminance(const Color& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

}  // namespace rayfarm
