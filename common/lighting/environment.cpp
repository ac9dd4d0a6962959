#include "common/lighting/environment.h"

#include <array>
#include <numbers>

#include "common/image/half_float.h"
#include "common/materials/scattering.h"
#include "common/math/portable_math.h"
#include "common/math/spherical.h"
#include "common/sampling/shares.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

const Texture& image_of(const Scene& scene) {
  return scene.textures[scene.head().environment];
}

/// The parameters of a direction in the image: longitude, and height angle from the bottom.
Vec2 parameters_of(const Scene& scene, const Vec3& direction) {
  const double u = longitude(direction.x, direction.z) + scene.head().environment_turn;
  return {u - std::floor(u), 1 - portable_acos(direction.y) / pi};
}

Color texel_of(const Texture& image, std::span<const uint16_t> texels, size_t x, size_t y) {
  const size_t at = 3 * (image.first_texel + y * image.width_px + x);
  return {float_of_half(texels[at]), float_of_half(texels[at + 1]), float_of_half(texels[at + 2])};
}

/// The mean luminance of what is seen within a texel, where the image is bilinear between the texels'
/// middles.
double mean_luminance(const Texture& image, std::span<const uint16_t> texels, size_t x, size_t y) {
  const std::array<size_t, 3> columns{x > 0 ? x - 1 : image.width_px - 1, x,
                                      x + 1 < image.width_px ? x + 1 : 0},
      rows{y > 0 ? y - 1 : 0, y, y + 1 < image.height_px ? y + 1 : y};
  constexpr std::array<double, 3> weights{0.125, 0.75, 0.125};
  double sum = 0;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      sum += weights[i] * weights[j] * luminance(texel_of(image, texels, columns[j], rows[i]));
  return sum;
}

/// Of the row's middle.
double sine_of_row(const Texture& image, size_t y) {
  return portable_sin(pi * (static_cast<double>(y) + 0.5) / image.height_px);
}

/// One of the shares' steps, and the rest of `u` within it.
size_t choose(std::span<const double> shares, double& u) {
  const size_t i = choose_by_share(shares, u);
  const double below = i > 0 ? shares[i - 1] : 0;
  u = shares[i] > below ? std::clamp((u - below) / (shares[i] - below), 0.0, 1.0) : 0.5;
  return i;
}

std::span<const double> rows_of(const Scene& scene) {
  return scene.environment_shares.first(image_of(scene).height_px);
}
std::span<const double> columns_of(const Scene& scene, size_t row) {
  const Texture& image = image_of(scene);
  return scene.environment_shares.subspan(image.height_px + row * image.width_px, image.width_px);
}

/// In solid angle; a texel is a rectangle in (u, v).
double texel_pdf(const Scene& scene, size_t x, size_t y, double sine) {
  const Texture& image = image_of(scene);
  const double share = share_of(rows_of(scene), y) * share_of(columns_of(scene, y), x);
  return sine > 0 ? share * image.width_px * image.height_px / (2 * pi * pi * sine) : 0;
}

}  // namespace

Color eval_environment(const Scene& scene, const Vec3& direction) {
  const SceneHeader& head = scene.head();
  const Texture& image = image_of(scene);
  Vec2 uv = parameters_of(scene, direction);
  // Beyond the poles' middle lies no other row.
  const double half_texel = 0.5 / image.height_px;
  uv.y = std::clamp(uv.y, half_texel, 1 - half_texel);
  const Color rgb = eval_texture(image, scene.texels, {Vec3(0), uv, 0, 0});
  return head.background * glm::max(head.channels_from_rgb * rgb, Color(0));
}

std::vector<double> make_environment_shares(const Texture& image, std::span<const uint16_t> texels) {
  const size_t w = image.width_px, h = image.height_px;
  std::vector<double> shares(h + w * h);
  for (size_t y = 0; y < h; ++y) {
    const std::span<double> row(&shares[h + y * w], w);
    for (size_t x = 0; x < w; ++x) row[x] = mean_luminance(image, texels, x, y);
    for (const double value : row) shares[y] += value * sine_of_row(image, y);
    accumulate_shares(row);
  }
  accumulate_shares(std::span(shares).first(h));
  return shares;
}

Color mean_environment(const Texture& image, std::span<const uint16_t> texels) {
  Color sum(0);
  double weight = 0;
  for (size_t y = 0; y < image.height_px; ++y) {
    const double sine = sine_of_row(image, y);
    for (size_t x = 0; x < image.width_px; ++x) sum += sine * texel_of(image, texels, x, y);
    weight += sine * image.width_px;
  }
  return sum / weight;
}

LightSample sample_environment(const Scene& scene, const Vec2& u) {
  const Texture& image = image_of(scene);
  Vec2 rest = u;
  const size_t y = choose(rows_of(scene), rest.x), x = choose(columns_of(scene, y), rest.y);
  const double polar = pi * (static_cast<double>(y) + rest.x) / image.height_px;
  const double turned = (static_cast<double>(x) + rest.y) / image.width_px - scene.head().environment_turn;
  const double azimuth = 2 * pi * (turned - std::floor(turned));
  const auto [sine, cosine] = portable_sine_cosine(polar);
  const SineCosine around = portable_sine_cosine(azimuth);
  LightSample result;
  result.to_light = {sine * around.cosine, cosine, sine * around.sine};
  result.pdf = texel_pdf(scene, x, y, sine);
  if (!(result.pdf > 0)) return {};
  result.incident = eval_environment(scene, result.to_light) / result.pdf;
  return result;
}

double environment_pdf(const Scene& scene, const Vec3& direction) {
  const Texture& image = image_of(scene);
  const Vec2 uv = parameters_of(scene, direction);
  const auto x = std::min(static_cast<size_t>(uv.x * image.width_px), size_t{image.width_px} - 1);
  const auto y = std::min(static_cast<size_t>((1 - uv.y) * image.height_px), size_t{image.height_px} - 1);
  return texel_pdf(scene, x, y, std::sqrt(std::max(0.0, 1 - direction.y * direction.y)));
}

}  // namespace rayfarm
