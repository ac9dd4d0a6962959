#include "common/lighting/torrance_sparrow.h"

#include <numbers>

#include "common/materials/fresnel.h"
#include "common/math/portable_math.h"

namespace rayfarm {

double facet_distribution(double cosine, double shininess) {
  const double half_angle = portable_acos(portable_pow(0.5, 1 / std::max(shininess, 1e-3)));
  const double ratio = portable_acos(cosine) / half_angle;
  return portable_exp(-std::numbers::ln2 * ratio * ratio);
}

double facet_visibility(double normal_half, double normal_light, double normal_viewer, double viewer_half) {
  return std::min(1.0, 2 * normal_half * std::min(normal_light, normal_viewer) / viewer_half);
}

Color facet_highlight(const Material& material, const Vec3& normal, const Vec3& to_light,
                      const Vec3& to_viewer) {
  const Vec3 half = normalized(to_light + to_viewer);
  const double normal_viewer = glm::dot(normal, to_viewer), normal_light = glm::dot(normal, to_light);
  const double normal_half = glm::dot(normal, half), viewer_half = glm::dot(to_viewer, half);
  if (!(normal_viewer > 0 && normal_light > 0 && viewer_half > 0)) return Color(0);
  const double shape = facet_distribution(normal_half, material.shininess) *
                       facet_visibility(normal_half, normal_light, normal_viewer, viewer_half) /
                       normal_viewer;
  if (material.kind == MaterialKind::conductor)
    return shape * fresnel_conductor(viewer_half, material.n, material.k);
  const double reflectance = material.index == 1 ? 1 : fresnel_dielectric(viewer_half, material.index);
  return Color(material.specular * shape * reflectance);
}

}  // namespace rayfarm
