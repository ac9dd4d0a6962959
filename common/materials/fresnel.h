#pragma once
// Fresnel's equations for unpolarised light.
#include "common/math/vector.h"

namespace rayfarm {

/// The share reflected where light meets a dielectric at `cosine` >= 0. `eta`: the index behind the surface
/// over the index before it. 1 on total internal reflection.
double fresnel_dielectric(double cosine, double eta);

/// The share reflected by a conductor of complex index n + ik, seen from a dielectric of index 1.
double fresnel_conductor(double cosine, double n, double k);
Color fresnel_conductor(double cosine, const Color& n, const Color& k);

}  // namespace rayfarm
