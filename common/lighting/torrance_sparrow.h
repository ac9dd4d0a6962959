#pragma once
// The highlight of a rough surface of small mirrors (Torrance and Sparrow 1967, as Blinn adapted it in 1977;
// thesis 2.2.3).
#include "common/materials/material.h"

namespace rayfarm {

/// K_S D G F / (N·E): the distribution of the facets, how they shadow and mask each other, and Fresnel's
/// reflectance. `normal`, `to_light`, `to_viewer`: unit. A conductor reflects with its n and k, other
/// materials with their index; an index of 1 says nothing of the facets, which then reflect all light.
Color facet_highlight(const Material& material, const Vec3& normal, const Vec3& to_light,
                      const Vec3& to_viewer);

/// D: 1 along the normal, 1/2 where cosⁿ is 1/2, Gaussian in the angle (Blinn's D2).
double facet_distribution(double cosine, double shininess);
/// G: the share of a facet's light that others do not take.
double facet_visibility(double normal_half, double normal_light, double normal_viewer, double viewer_half);

}  // namespace rayfarm
