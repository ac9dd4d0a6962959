#include "common/materials/scattering.h"

#include "common/materials/principled.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

/// Light leaves on the side that the lobe is for.
bool is_on_side_of(const Lobe& lobe, const Interaction& at, const Vec3& direction) {
  return (glm::dot(at.normal, direction) > 0) != lobe.is_transmitted;
}

double pdf(const Lobe& lobe, const Vec3& direction) {
  const double cosine = glm::dot(lobe.axis, direction);
  return lobe.spread == Lobe::Spread::diffuse ? cosine_pdf(cosine) : phong_pdf(cosine, lobe.exponent);
}

}  // namespace

double total_luminance(const Lobes& lobes) {
  double total = 0;
  for (const Lobe& lobe : lobes) total += luminance(lobe.attenuation);
  return total;
}

ChosenLobe choose_lobe(const Lobes& lobes, double choice) {
  const double total = total_luminance(lobes);
  if (!(total > 0)) return {};
  double rest = choice * total;
  size_t chosen = 0;
  while (chosen + 1 < lobes.size() && rest >= luminance(lobes[chosen].attenuation))
    rest -= luminance(lobes[chosen++].attenuation);
  return {&lobes[chosen], luminance(lobes[chosen].attenuation) / total};
}

Scattered eval(const Lobes& lobes, const Interaction& at, const Vec3& direction) {
  if (at.principled) return eval_principled(lobes, at, direction);
  Scattered result;
  const double total = total_luminance(lobes);
  for (const Lobe& lobe : lobes) {
    if (lobe.spread == Lobe::Spread::perfect || !(total > 0)) continue;
    const double density = pdf(lobe, direction);
    result.pdf += luminance(lobe.attenuation) / total * density;
    if (is_on_side_of(lobe, at, direction)) result.value += density * lobe.attenuation;
  }
  return result;
}

ScatteredRay sample(const Lobes& lobes, const Interaction& at, const Vec2& direction, double choice) {
  if (at.principled) return sample_principled(lobes, at, direction, choice);
  const auto [found, probability] = choose_lobe(lobes, choice);
  if (!(probability > 0)) return {};
  const Lobe& lobe = *found;
  ScatteredRay ray{lobe.axis, lobe.attenuation / probability, 0, lobe.spread, lobe.is_transmitted};
  if (lobe.spread == Lobe::Spread::perfect) return ray;
  const Vec3 local = lobe.spread == Lobe::Spread::diffuse ? sample_cosine(direction)
                                                          : sample_phong(direction, lobe.exponent);
  ray.direction = Frame(lobe.axis).to_world(local);
  if (!is_on_side_of(lobe, at, ray.direction)) {
    ray.weight = Color(0);
    return ray;
  }
  if (lobes.size() == 1) {  // then value and density are proportional
    ray.pdf = pdf(lobe, ray.direction);
    return ray;
  }
  const Scattered scattered = eval(lobes, at, ray.direction);
  ray.pdf = scattered.pdf;
  ray.weight = scattered.pdf > 0 ? scattered.value / scattered.pdf : Color(0);
  return ray;
}

}  // namespace rayfarm
