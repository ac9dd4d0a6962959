#pragma once
// Microfacets by Trowbridge and Reitz's distribution ("GGX": Walter, Marschner, Li and Torrance 2007,
// "Microfacet Models for Refraction through Rough Surfaces"), with Smith's shadowing of each direction by
// itself: the form of glTF 2.0's appendix B. Directions are in a frame whose z axis is the surface's normal.
#include "common/math/vector.h"

namespace rayfarm {

/// D: the density of facets of this height (cosine to the surface's normal), so that their projected areas
/// add up to the surface's.
double ggx_density(double height, double alpha);
/// G1: the share of a direction's facets that no others hide. `cosine` > 0.
double ggx_shadowing(double cosine, double alpha);
/// The normal of a facet, unit, as the viewer sees them (Heitz 2018, "Sampling the GGX Distribution of
/// Visible Normals"). to_viewer.z > 0.
Vec3 sample_ggx_normal(const Vec3& to_viewer, double alpha, const Vec2& u);
/// The density of that, over solid angle: of a facet at `height`, which the viewer at `cosine` to the surface
/// sees at `cosine_to_facet`.
double ggx_normal_pdf(double cosine, double cosine_to_facet, double height, double alpha);

/// What white facets of a roughness (alpha is its square) send on of light from a direction at its first
/// bounce, and its mean over the hemisphere: the rest has met several. Table; within 0.002.
double ggx_albedo(double cosine, double roughness);
double mean_ggx_albedo(double roughness);

}  // namespace rayfarm
