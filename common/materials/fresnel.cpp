#include "common/materials/fresnel.h"

namespace rayfarm {

double fresnel_dielectric(double cosine, double eta) {
  const double sine2 = (1 - cosine * cosine) / (eta * eta);  // of the refracted direction
  if (sine2 >= 1) return 1;
  const double behind = std::sqrt(1 - sine2);
  const double parallel = (eta * cosine - behind) / (eta * cosine + behind);
  const double perpendicular = (cosine - eta * behind) / (cosine + eta * behind);
  return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

double fresnel_conductor(double cosine, double n, double k) {
  // Born and Wolf, Principles of Optics, 14.2: a² + b² is |sqrt((n + ik)² - sin²)|².
  const double cosine2 = cosine * cosine, sine2 = 1 - cosine2;
  const double t = n * n - k * k - sine2;
  const double a2_plus_b2 = std::sqrt(t * t + 4 * n * n * k * k);
  const double a = std::sqrt(std::max(0.0, 0.5 * (a2_plus_b2 + t)));
  const double perpendicular =
      (a2_plus_b2 + cosine2 - 2 * a * cosine) / (a2_plus_b2 + cosine2 + 2 * a * cosine);
  const double parallel = perpendicular * (cosine2 * a2_plus_b2 + sine2 * sine2 - 2 * a * cosine * sine2) /
                          (cosine2 * a2_plus_b2 + sine2 * sine2 + 2 * a * cosine * sine2);
  return 0.5 * (parallel + perpendicular);
}

Color fresnel_conductor(double cosine, const Color& n, const Color& k) {
  return {fresnel_conductor(cosine, n.x, k.x), fresnel_conductor(cosine, n.y, k.y),
          fresnel_conductor(cosine, n.z, k.z)};
}

}  // namespace rayfarm
