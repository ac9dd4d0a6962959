#include "common/materials/principled.h"

#include <numbers>

#include "common/materials/ggx.h"
#include "common/math/portable_math.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

/// Of a smooth coat (glTF's KHR_materials_clearcoat: an index of 1.5).
constexpr double kCoatReflectance = 0.04;
/// Facets that lean less than this are none: the surface is smooth.
constexpr double kLeastSpreadAlpha = 1e-4;

/// Of what a rough surface lets through, to choose it at all.
constexpr double kLeastLeft = 0.1;

/// Between these roughnesses classical models cease to mirror.
constexpr double kSharpRoughness = 0.1, kWideRoughness = 0.7;

double alpha_of(double roughness) {
  return roughness * roughness;
}
bool is_smooth(double roughness) {
  return alpha_of(roughness) < kLeastSpreadAlpha;
}

/// (1 - cosine)⁵, by which Fresnel's equations are replaced (Schlick 1994).
double schlick(double cosine) {
  const double x = 1 - std::clamp(cosine, 0.0, 1.0), square = x * x;
  return square * square * x;
}

Color blend(const Color& a, const Color& b, double part) {
  return (1 - part) * a + part * b;
}

/// A point's parameters for light that comes to one viewer.
class PrincipledLayers {
 public:
  PrincipledLayers(const PrincipledPoint& p, const Interaction& at)
      : p_(p), at_(at), cosine_(glm::dot(at.normal, at.to_viewer)) {
    const double ratio = p.is_solid ? at.index_ratio : p.ior;
    const double r = (ratio - 1) / (ratio + 1);
    f0_ = p.specular * glm::min(r * r * p.specular_color, Color(1));
    has_coat_normal_ = p.coat_normal != Vec3(0) && glm::dot(p.coat_normal, at.to_viewer) > 0;
  }

  const Vec3& coat_normal() const { return has_coat_normal_ ? p_.coat_normal : at_.normal; }

  /// What a coat reflects, by the cosine to its facet.
  double coat(double cosine) const {
    return p_.coat > 0 ? p_.coat * (kCoatReflectance + (1 - kCoatReflectance) * schlick(cosine)) : 0;
  }
  /// What the dielectric reflects, by the cosine to the facet on the viewer's side.
  Color dielectric(double cosine) const {
    if (p_.is_solid && at_.index_ratio < 1) {
      const double sine2 = (1 - cosine * cosine) / (at_.index_ratio * at_.index_ratio);
      if (sine2 >= 1) return Color(1);
      cosine = std::sqrt(1 - sine2);
    }
    return f0_ + schlick(cosine) * (Color(p_.specular) - f0_);
  }
  Color reflected(double cosine) const {
    const Color metal = p_.base + schlick(cosine) * (Color(1) - p_.base);
    return blend(dielectric(cosine), metal, p_.metallic);
  }
  /// What the dielectric does not reflect: for the layer below it.
  double left(double cosine) const { return std::max(0.0, 1 - max_component(dielectric(cosine))); }
  Color diffuse() const { return (1 - p_.metallic) * (1 - p_.transmission) * p_.base; }
  Color transmitted() const { return (1 - p_.metallic) * p_.transmission * p_.base; }

  /// Light that has met several of a metal's facets, of all that came (Kulla and Conty 2017): diffuse, with
  /// Fresnel's mean reflectance at each. Without the factor of the direction that it comes from.
  Color several() const {
    if (!(p_.metallic > 0)) return Color(0);
    const double mean = mean_ggx_albedo(p_.roughness);
    const Color fresnel = p_.base + (Color(1) - p_.base) / 21.0;
    const Color all = fresnel * fresnel * mean / (Color(1) - fresnel * (1 - mean));
    return p_.metallic * (1 - ggx_albedo(cosine_, p_.roughness)) * all;
  }
  /// That factor: its mean over the hemisphere, weighed by the cosine, is 1.
  double share_of_several(double cosine) const {
    const double left = 1 - mean_ggx_albedo(p_.roughness);
    return left > 0 ? (1 - ggx_albedo(cosine, p_.roughness)) / left : 1;
  }

  /// Density of directions below the layer of facets: light of the diffuse body by the cosine; light that has
  /// met several facets, which leaves where those hide each other, by 1 / (cosine + alpha).
  double substrate_pdf(double cosine) const {
    if (!(cosine > 0)) return 0;
    const double diffuse = diffuse_share();
    return diffuse * cosine_pdf(cosine) +
           (1 - diffuse) / ((cosine + alpha()) * 2 * std::numbers::pi * log_range());
  }
  Vec3 sample_substrate(Vec2 u) const {
    const double diffuse = diffuse_share();
    if (u.x < diffuse) return sample_cosine({u.x / diffuse, u.y});
    u.x = (u.x - diffuse) / (1 - diffuse);
    const double cosine = std::min(1.0, alpha() * (portable_exp(u.x * log_range()) - 1));
    const double sine = std::sqrt(1 - cosine * cosine);
    const auto [y, x] = portable_sine_cosine(2 * std::numbers::pi * u.y);
    return {sine * x, sine * y, cosine};
  }

  double cosine() const { return cosine_; }

 private:
  double alpha() const { return alpha_of(p_.roughness); }
  double log_range() const { return portable_log((1 + alpha()) / alpha()); }
  /// Of the light below the facets.
  double diffuse_share() const {
    if (!(p_.metallic > 0) || is_smooth(p_.roughness)) return 1;
    const double body = luminance(left(1) * diffuse()), facets = luminance(several());
    return facets > 0 ? body / (body + facets) : 1;
  }

  const PrincipledPoint& p_;
  const Interaction& at_;
  double cosine_;
  Color f0_;
  bool has_coat_normal_;
};

/// Through a sheet light goes on as it came, through an index that does not change, too.
bool is_bent(const PrincipledPoint& p, const Interaction& at) {
  return p.is_solid && std::abs(at.index_ratio - 1) > 1e-6;
}
bool passes_perfectly(const PrincipledPoint& p, const Interaction& at) {
  return is_smooth(p.roughness) || (p.is_solid && !is_bent(p, at));
}

Vec3 mirrored_about(const Vec3& normal, const Vec3& v) {
  return normalized(2 * glm::dot(v, normal) * normal - v);
}
Vec3 behind(const Vec3& direction, const Vec3& normal) {
  return direction - 2 * glm::dot(direction, normal) * normal;
}

/// Radiance is squeezed into a narrower cone behind a denser surface.
double squeeze(const PrincipledPoint& p, const Interaction& at) {
  return p.is_solid ? 1 / (at.index_ratio * at.index_ratio) : 1;
}

Vec3 sample_facet(const Vec3& normal, const Vec3& to_viewer, double alpha, const Vec2& u) {
  const Frame frame(normal);
  const Vec3 local(glm::dot(frame.tangent, to_viewer), glm::dot(frame.bitangent, to_viewer),
                   glm::dot(normal, to_viewer));
  return frame.to_world(sample_ggx_normal(local, alpha, u));
}

/// Facets about `normal` that show the viewer light from `direction`: the density with which it is chosen,
/// and the value of white ones.
struct Reflection {
  double pdf = 0, value = 0;
};
Reflection reflection(const Vec3& normal, const Vec3& to_viewer, const Vec3& direction, const Vec3& half,
                      double alpha) {
  const double viewer = glm::dot(normal, to_viewer), light = glm::dot(normal, direction),
               facet = glm::dot(half, to_viewer);
  if (!(viewer > 0 && light > 0 && facet > 0)) return {};
  const double pdf = ggx_normal_pdf(viewer, facet, glm::dot(normal, half), alpha) / (4 * facet);
  return {pdf, pdf * ggx_shadowing(light, alpha)};
}

/// Light from behind that facets bend or, of a sheet, only spread.
void add_transmitted(double share, const PrincipledPoint& p, const Interaction& at,
                     const PrincipledLayers& surfaces, const Vec3& direction, Scattered& result) {
  const double alpha = alpha_of(p.roughness), light = -glm::dot(at.normal, direction);
  double facet, pdf;
  if (is_bent(p, at)) {
    const double eta = at.index_ratio;
    Vec3 half = normalized(-(at.to_viewer + eta * direction));
    if (glm::dot(half, at.normal) < 0) half = -half;
    facet = glm::dot(half, at.to_viewer);
    const double beyond = glm::dot(half, direction);
    if (!(facet > 0 && beyond < 0)) return;
    const double sum = facet + eta * beyond;
    pdf = ggx_normal_pdf(surfaces.cosine(), facet, glm::dot(at.normal, half), alpha) * eta * eta * -beyond /
          (sum * sum);
  } else {
    const Vec3 before = behind(direction, at.normal), half = normalized(at.to_viewer + before);
    facet = glm::dot(half, at.to_viewer);
    pdf = reflection(at.normal, at.to_viewer, before, half, alpha).pdf;
  }
  if (!(pdf > 0)) return;
  result.pdf += share * pdf;
  result.value += pdf * ggx_shadowing(light, alpha) * squeeze(p, at) * surfaces.left(facet) *
                  (1 - surfaces.coat(facet)) * surfaces.transmitted();
}

}  // namespace

PrincipledMaterial usual_principled() {
  PrincipledMaterial m;
  const auto scalar = [&m](PrincipledInput input, double value) {
    m[input].factor = Color(value);
    m[input].channel = TextureChannel::luminance;
  };
  scalar(PrincipledInput::metallic, 0);
  scalar(PrincipledInput::roughness, 0.5);
  scalar(PrincipledInput::specular, 1);
  scalar(PrincipledInput::transmission, 0);
  scalar(PrincipledInput::clearcoat, 0);
  scalar(PrincipledInput::clearcoat_roughness, 0);
  scalar(PrincipledInput::opacity, 1);
  return m;
}

void finish_principled(PrincipledMaterial& principled, Material& material) {
  principled.has_textures = 0;
  for (size_t i = 0; i < kPrincipledInputs; ++i)
    if (i != static_cast<size_t>(PrincipledInput::opacity) && principled.sources[i].texture != kNone)
      principled.has_textures = 1;
  const PrincipledSource& opacity = principled[PrincipledInput::opacity];
  const double whole = principled.cutoff > 0 ? principled.cutoff : 1;
  PrincipledPoint without_textures = principled_point(
      principled, material, [&](PrincipledInput input) { return principled[input].factor.x; });
  without_textures.base = material.color;
  without_textures.specular_color = principled[PrincipledInput::specular_color].factor;
  if (!principled.has_coefficients) set_nearest_coefficients(without_textures, material);
  material.kind = MaterialKind::principled;
  material.is_pierced = opacity.texture != kNone || opacity.factor.x < whole || principled.is_one_sided != 0;
  if (material.is_unlit) material.emission = material.color;
  // Light is not sent from where there is none.
  material.is_no_lamp = material.is_unlit != 0 || principled[PrincipledInput::emission].texture != kNone ||
                        (material.is_pierced != 0 && principled.is_one_sided == 0);
}

void scatter_principled(const PrincipledPoint& p, const Interaction& at, Lobes& lobes) {
  if (p.is_black) return;
  using Spread = Lobe::Spread;
  const PrincipledLayers surfaces(p, at);
  const auto add = [&](Lobe::Layer layer, Spread spread, bool is_transmitted, const Vec3& axis,
                       const Color& attenuation) {
    if (attenuation == Color(0)) return;
    Lobe& lobe = lobes.push_back({spread, is_transmitted, axis, 0, attenuation});
    lobe.layer = layer;
  };
  const double cosine = surfaces.cosine(), cosine_to_coat = glm::dot(surfaces.coat_normal(), at.to_viewer);
  add(Lobe::Layer::coat, is_smooth(p.coat_roughness) ? Spread::perfect : Spread::glossy, false,
      mirrored_about(surfaces.coat_normal(), at.to_viewer), Color(surfaces.coat(cosine_to_coat)));
  const double under = 1 - surfaces.coat(cosine);
  const Vec3 mirror = mirrored(at);
  const bool is_mirror = is_smooth(p.roughness);
  add(Lobe::Layer::facets, is_mirror ? Spread::perfect : Spread::glossy, false, mirror,
      under * surfaces.reflected(cosine));
  // What is not perfect is only chosen by these.
  add(Lobe::Layer::substrate, Spread::diffuse, false, at.normal,
      under * (surfaces.left(1) * surfaces.diffuse() + (is_mirror ? Color(0) : surfaces.several())));
  Vec3 through = is_bent(p, at) ? refracted(at) : -at.to_viewer;
  double left = surfaces.left(cosine);
  if (!passes_perfectly(p, at)) {  // some facets let light through that the surface as a whole would reflect
    left = std::max(left, kLeastLeft);
    if (through == Vec3(0)) through = -at.to_viewer;
  }
  if (through != Vec3(0))
    add(Lobe::Layer::facets, passes_perfectly(p, at) ? Spread::perfect : Spread::glossy, true, through,
        under * left * squeeze(p, at) * surfaces.transmitted());
}

Scattered eval_principled(const Lobes& lobes, const Interaction& at, const Vec3& direction) {
  const PrincipledPoint& p = *at.principled;
  Scattered result;
  const double total = total_luminance(lobes), light = glm::dot(at.normal, direction);
  if (!(total > 0)) return result;
  const PrincipledLayers surfaces(p, at);
  const Vec3 half = normalized(at.to_viewer + direction);
  const double facet = glm::dot(half, at.to_viewer);
  for (const Lobe& lobe : lobes) {
    if (lobe.spread == Lobe::Spread::perfect || lobe.is_transmitted == (light > 0)) continue;
    const double share = luminance(lobe.attenuation) / total;
    if (lobe.is_transmitted) {
      add_transmitted(share, p, at, surfaces, direction, result);
    } else if (lobe.layer == Lobe::Layer::coat) {
      const Reflection seen =
          reflection(surfaces.coat_normal(), at.to_viewer, direction, half, alpha_of(p.coat_roughness));
      result.pdf += share * seen.pdf;
      result.value += Color(seen.value * surfaces.coat(facet));
    } else if (lobe.layer == Lobe::Layer::facets) {
      const Reflection seen = reflection(at.normal, at.to_viewer, direction, half, alpha_of(p.roughness));
      result.pdf += share * seen.pdf;
      result.value += seen.value * (1 - surfaces.coat(facet)) * surfaces.reflected(facet);
    } else {
      const double pdf = cosine_pdf(light);
      result.pdf += share * surfaces.substrate_pdf(light);
      Color value = surfaces.left(facet) * surfaces.diffuse();
      if (!is_smooth(p.roughness)) value += surfaces.share_of_several(light) * surfaces.several();
      result.value += pdf * (1 - surfaces.coat(facet)) * value;
    }
  }
  return result;
}

ScatteredRay sample_principled(const Lobes& lobes, const Interaction& at, const Vec2& u, double choice) {
  const PrincipledPoint& p = *at.principled;
  const auto [found, probability] = choose_lobe(lobes, choice);
  if (!(probability > 0)) return {};
  const Lobe& lobe = *found;
  ScatteredRay ray{lobe.axis, lobe.attenuation / probability, 0, lobe.spread, lobe.is_transmitted};
  if (lobe.spread == Lobe::Spread::perfect) return ray;
  ray.weight = Color(0);
  if (lobe.layer == Lobe::Layer::substrate) {
    ray.direction = Frame(at.normal).to_world(PrincipledLayers(p, at).sample_substrate(u));
  } else if (lobe.layer == Lobe::Layer::coat) {
    const Vec3 normal = PrincipledLayers(p, at).coat_normal();
    ray.direction =
        mirrored_about(sample_facet(normal, at.to_viewer, alpha_of(p.coat_roughness), u), at.to_viewer);
  } else {
    const Vec3 half = sample_facet(at.normal, at.to_viewer, alpha_of(p.roughness), u);
    if (lobe.is_transmitted && is_bent(p, at)) {
      Interaction facet = at;
      facet.normal = half;
      ray.direction = refracted(facet);
      if (ray.direction == Vec3(0)) return ray;
    } else {
      ray.direction = mirrored_about(half, at.to_viewer);
      if (lobe.is_transmitted) ray.direction = behind(ray.direction, at.normal);
    }
  }
  if ((glm::dot(at.normal, ray.direction) > 0) == lobe.is_transmitted) return ray;
  const Scattered scattered = eval_principled(lobes, at, ray.direction);
  ray.pdf = scattered.pdf;
  if (scattered.pdf > 0) ray.weight = scattered.value / scattered.pdf;
  return ray;
}

void set_nearest_coefficients(const PrincipledPoint& p, Material& m) {
  const Interaction along{{0, 0, 1}, {0, 0, 1}, true, p.is_solid ? p.ior : 1};
  const PrincipledLayers surfaces(p, along);
  const double left = surfaces.left(1), coat = surfaces.coat(1);
  // One mirrored ray shows nothing of a wide lobe: metals' are taken for diffuse, others left to highlights.
  const double sharp = 1 - smooth_step(kSharpRoughness, kWideRoughness, p.roughness);
  m.color = p.base;
  m.ambient = 0;
  m.diffuse = (1 - coat) * (left * (1 - p.metallic) * (1 - p.transmission) + (1 - sharp) * p.metallic);
  m.transmit = (1 - coat) * left * (1 - p.metallic) * p.transmission;
  m.interior = glm::min(p.base, Color(1));
  m.back = Color(coat) + (1 - coat) * sharp * surfaces.reflected(1);
  m.specular = coat + (1 - coat) * luminance(surfaces.reflected(1));
  if (p.is_black) {
    m.diffuse = m.transmit = m.specular = 0;
    m.back = Color(0);
  }
  m.reflect = luminance(m.back);
  // Facets cosᵐ lean as GGX's of this alpha where m is 2 / alpha² - 2; a mirrored ray turns twice as far.
  const double alpha = alpha_of(p.roughness);
  m.exponent = is_smooth(p.roughness) ? 0 : std::max(1.0, 0.5 / (alpha * alpha) - 0.5);
  m.shininess = is_smooth(p.roughness) ? 1e4 : m.exponent;
}

void scatter_by_coefficients(const Material& m, const Interaction& at, Lobes& lobes) {
  const Lobe::Spread spread = m.exponent > 0 ? Lobe::Spread::glossy : Lobe::Spread::perfect;
  if (m.diffuse > 0) lobes.push_back({Lobe::Spread::diffuse, false, at.normal, 0, m.diffuse * m.color});
  Color reflected = m.back;
  if (m.transmit > 0) {
    const Vec3 through = refracted(at);
    const Color transmitted = m.transmit * m.interior;
    if (through == Vec3(0))
      reflected += transmitted;
    else
      lobes.push_back({spread, true, through, m.exponent, transmitted / (at.index_ratio * at.index_ratio)});
  }
  if (reflected != Color(0)) lobes.push_back({spread, false, mirrored(at), m.exponent, reflected});
}

}  // namespace rayfarm
