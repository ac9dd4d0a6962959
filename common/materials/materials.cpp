// The families, one function each.
#include "common/materials/fresnel.h"
#include "common/materials/principled.h"
#include "common/materials/scattering.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

using Spread = Lobe::Spread;

Lobe reflected_diffusely(const Interaction& at, const Color& albedo) {
  return {Spread::diffuse, false, at.normal, 0, albedo};
}
Lobe along(const Vec3& axis, const Color& attenuation, double exponent, bool is_transmitted = false) {
  return {exponent > 0 ? Spread::glossy : Spread::perfect, is_transmitted, axis, exponent, attenuation};
}

/// Equation 2.12 read as a surface that scatters. Highlights are reflections of lights, so they are a lobe of
/// their own only where nothing else is reflected, and of no more light than the other terms leave.
void classical(const Material& m, const Interaction& at, Lobes& lobes) {
  if (m.diffuse > 0) lobes.push_back(reflected_diffusely(at, m.diffuse * m.color));
  const double left = 1 - m.diffuse * max_component(m.color) - m.transmit;
  if (m.specular > 0 && left > 0 && !(m.reflect > 0))
    lobes.push_back(along(mirrored(at), Color(std::min(m.specular, left)), std::max(m.shininess, 1e-3)));
  Color reflect(m.reflect);
  if (m.transmit > 0) {
    const Vec3 through = refracted(at);
    if (through == Vec3(0))
      reflect += m.transmit;
    else
      lobes.push_back(along(through, m.transmit * m.interior, m.exponent, true));
  }
  if (reflect.x > 0) lobes.push_back(along(mirrored(at), reflect, m.exponent));
}

void conductor(const Material& m, const Interaction& at, Lobes& lobes) {
  const double cosine = glm::dot(at.normal, at.to_viewer);
  lobes.push_back(along(mirrored(at), fresnel_conductor(cosine, m.n, m.k), m.exponent));
}

void dielectric(const Material& m, const Interaction& at, Lobes& lobes) {
  const double cosine = glm::dot(at.normal, at.to_viewer);
  const double reflectance = fresnel_dielectric(cosine, at.index_ratio);
  if (reflectance > 0) lobes.push_back(along(mirrored(at), Color(reflectance), m.exponent));
  // Radiance is squeezed into a narrower cone behind a denser surface.
  if (reflectance < 1)
    lobes.push_back(
        along(refracted(at), Color((1 - reflectance) / (at.index_ratio * at.index_ratio)), m.exponent, true));
}

/// A diffuse substrate under a thin dielectric: what the polish does not reflect the substrate does.
void polished(const Material& m, const Interaction& at, Lobes& lobes) {
  const double polish = fresnel_dielectric(glm::dot(at.normal, at.to_viewer), m.index);
  lobes.push_back(along(mirrored(at), Color(polish), m.exponent));
  lobes.push_back(reflected_diffusely(at, (1 - polish) * m.color));
}

void translucent(const Material& m, const Interaction& at, Lobes& lobes) {
  lobes.push_back(reflected_diffusely(at, at.is_front ? m.color : m.back));
  lobes.push_back({Spread::diffuse, true, -at.normal, 0, m.through});
}

}  // namespace

void scatter(const Material& material, const Interaction& at, Lobes& lobes) {
  lobes.clear();
  switch (material.kind) {
    case MaterialKind::classical:
      return classical(material, at, lobes);
    case MaterialKind::lambertian:
    case MaterialKind::luminaire:
      lobes.push_back(reflected_diffusely(at, material.color));
      return;
    case MaterialKind::conductor:
      return conductor(material, at, lobes);
    case MaterialKind::dielectric:
      return dielectric(material, at, lobes);
    case MaterialKind::polished:
      return polished(material, at, lobes);
    case MaterialKind::translucent:
      return translucent(material, at, lobes);
    case MaterialKind::mix:  // its parts scatter
      return;
    case MaterialKind::principled:
      return at.principled ? scatter_principled(*at.principled, at, lobes)
                           : scatter_by_coefficients(material, at, lobes);
  }
}

Color emitted(const Material& material, const Interaction& at) {
  if (!is_luminaire(material)) return Color(0);
  if (material.is_unlit) return material.emission;
  if (at.is_front == (material.is_inward != 0)) return Color(0);
  const double cosine = std::max(0.0, glm::dot(at.normal, at.to_viewer));
  return (material.exponent > 0 ? portable_pow(cosine, material.exponent) : 1.0) * material.emission;
}

}  // namespace rayfarm
