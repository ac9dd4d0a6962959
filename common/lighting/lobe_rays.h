#pragma once
// The rays of one lobe: those that a surface reflects, or transmits, in the lighting tree (Equation 3.2).
// Each stands for the same share of cosⁿ about the axis, as diffuse rays do of Lambert's law (thesis 3.3:
// "This entire technique can be applied to the highlights found on glossy objects").
#include "common/sampling/warps.h"

namespace rayfarm {

class LobeRays {
 public:
  /// `u` in [0, 1)²: where each ray lies in its part, and the turn of all; evenly spread over the samples of
  /// a pixel. `axis` and `surface_normal`: unit.
  LobeRays(const Vec3& axis, double exponent, const Vec3& surface_normal, uint32_t rays, const Vec2& u)
      : frame_(axis), normal_(surface_normal), exponent_(exponent), rays_(rays), u_(u) {}

  /// Parts are rings about the axis, of equal light; from ring to ring rays turn by the golden section, as
  /// seeds of a sunflower. A ray that would pass the surface is mirrored by it back to the side of the axis:
  /// so the weights' sum stays the coefficient (thesis 3.2), where rays cut off would lose light at grazing
  /// angles.
  Vec3 operator[](uint32_t ray) const {
    constexpr double kGoldenSection = 0.6180339887498949;
    const double turn = ray * kGoldenSection + u_.y;
    const Vec3 direction =
        frame_.to_world(sample_phong({(ray + u_.x) / rays_, turn - std::floor(turn)}, exponent_));
    const double height = glm::dot(normal_, direction);
    const bool is_inside = (height >= 0) == (glm::dot(normal_, frame_.normal) >= 0);
    return is_inside ? direction : direction - 2 * height * normal_;
  }

 private:
  Frame frame_;
  Vec3 normal_;
  double exponent_;
  uint32_t rays_;
  Vec2 u_;
};

}  // namespace rayfarm
