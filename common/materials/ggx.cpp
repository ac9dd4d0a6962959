#include "common/materials/ggx.h"

#include <array>
#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

constexpr size_t kAlbedoSteps = 32;

/// Rows by roughness, columns by cosine; at last the means.
constexpr std::array<double, (kAlbedoSteps + 1) * kAlbedoSteps> kAlbedo{
#include "common/materials/ggx_albedo.inc"
};

/// The table's first row is of this alpha, at least.
constexpr double kLeastAlpha = 1e-5;

/// Linear between two of the 32 numbers from `first` on; `place` in [0, 1].
double table_value(size_t first, double place) {
  const double at = std::clamp(place, 0.0, 1.0) * (kAlbedoSteps - 1);
  const size_t below = std::min(static_cast<size_t>(at), kAlbedoSteps - 2);
  const double part = at - static_cast<double>(below);
  return (1 - part) * kAlbedo[first + below] + part * kAlbedo[first + below + 1];
}

}  // namespace

double ggx_density(double height, double alpha) {
  if (!(height > 0)) return 0;
  const double d = height * height * (alpha * alpha - 1) + 1;
  return alpha * alpha / (std::numbers::pi * d * d);
}

double ggx_shadowing(double cosine, double alpha) {
  return 2 * cosine / (cosine + std::sqrt(alpha * alpha + (1 - alpha * alpha) * cosine * cosine));
}

Vec3 sample_ggx_normal(const Vec3& to_viewer, double alpha, const Vec2& u) {
  // Where facets are a hemisphere: its visible half and the half behind it, as they project.
  const Vec3 v = normalized(Vec3(alpha * to_viewer.x, alpha * to_viewer.y, to_viewer.z));
  const double across = v.x * v.x + v.y * v.y;
  const Vec3 x = across > 0 ? Vec3(-v.y, v.x, 0) / std::sqrt(across) : Vec3(1, 0, 0), y = glm::cross(v, x);
  const double r = std::sqrt(u.x), lean = 0.5 * (1 + v.z);
  const auto [sine, cosine] = portable_sine_cosine(2 * std::numbers::pi * u.y);
  const double p = r * cosine;
  const double q = (1 - lean) * std::sqrt(std::max(0.0, 1 - p * p)) + lean * (r * sine);
  const Vec3 n = p * x + q * y + std::sqrt(std::max(0.0, 1 - p * p - q * q)) * v;
  return normalized(Vec3(alpha * n.x, alpha * n.y, std::max(1e-300, n.z)));
}

double ggx_normal_pdf(double cosine, double cosine_to_facet, double height, double alpha) {
  if (!(cosine > 0 && cosine_to_facet > 0)) return 0;
  return ggx_shadowing(cosine, alpha) * cosine_to_facet * ggx_density(height, alpha) / cosine;
}

double ggx_albedo(double cosine, double roughness) {
  const double alpha = std::max(kLeastAlpha, roughness * roughness);
  const double place = cosine * (1 + alpha) / (cosine + alpha);
  const double at = std::clamp(roughness, 0.0, 1.0) * (kAlbedoSteps - 1);
  const size_t below = std::min(static_cast<size_t>(at), kAlbedoSteps - 2);
  const double part = at - static_cast<double>(below);
  return (1 - part) * table_value(below * kAlbedoSteps, place) +
         part * table_value((below + 1) * kAlbedoSteps, place);
}

double mean_ggx_albedo(double roughness) {
  return table_value(kAlbedoSteps * kAlbedoSteps, roughness);
}

}  // namespace rayfarm
