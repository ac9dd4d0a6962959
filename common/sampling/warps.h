#pragma once
// Maps from the unit square to the places that are sampled (Shirley, Sung and Brown 1991, section 2.2.2),
// each with its density. Directions are in a local frame whose z axis is the normal.
#include <array>

#include "common/math/vector.h"

namespace rayfarm {

/// Uniform on the unit disk; concentric (Shirley and Chiu 1997), so that neighbours stay neighbours.
Vec2 sample_disk(const Vec2& u);
/// Density cos θ / π on the upper hemisphere.
Vec3 sample_cosine(const Vec2& u);
double cosine_pdf(double cosine);
/// Density (n + 1) / 2π cosⁿ θ on the upper hemisphere.
Vec3 sample_phong(const Vec2& u, double exponent);
double phong_pdf(double cosine, double exponent);
/// Uniform on the unit sphere: density 1 / 4π.
Vec3 sample_sphere(const Vec2& u);
/// Uniform in solid angle in the cone about z whose half angle has the cosine 1 - one_minus_cosine.
Vec3 sample_cone(const Vec2& u, double one_minus_cosine);
double cone_pdf(double one_minus_cosine);
/// The phase function of Henyey and Greenstein (1941) about z, in which light came: the density (1 - g²) /
/// 4π (1 + g² - 2 g cos θ)^(3/2) on the sphere, whose mean cosine is g, -1 < g < 1.
Vec3 sample_henyey_greenstein(const Vec2& u, double g);
double henyey_greenstein_pdf(double cosine, double g);
/// Uniform on a triangle: the weights of its second and third vertex. Density 1 / area.
Vec2 sample_triangle(const Vec2& u);

/// Two unit vectors that are perpendicular to a unit normal and to each other, right-handed (Duff et al.
/// 2017).
struct Frame {
  Vec3 tangent, bitangent, normal;
  explicit Frame(const Vec3& n);
  Vec3 to_world(const Vec3& local) const {
    return local.x * tangent + local.y * bitangent + local.z * normal;
  }
};

}  // namespace rayfarm
