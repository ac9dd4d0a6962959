#include "common/lighting/medium_walk.h"

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

double sum_of(const Color& c) {
  return c.x + c.y + c.z;
}

/// Which channel's share of `weights` holds u in [0, 1).
int choose_channel(const Color& weights, double u) {
  const double place = u * sum_of(weights);
  return place < weights.x ? 0 : place < weights.x + weights.y ? 1 : 2;
}

/// An optical depth: exponentially distributed, of mean 1.
double random_depth(MediumNumbers& numbers) {
  return -portable_log(1 - numbers.next());
}

MediumEvent walk_homogeneous(const ParticipatingMedium& medium, const MediumSegment& segment, double length,
                             Color& throughput, MediumNumbers& numbers) {
  const Color extinction = medium.extinction();
  const double depth = random_depth(numbers);
  const bool is_grey = extinction.x == extinction.y && extinction.y == extinction.z;
  const int channel = is_grey ? 0 : choose_channel(throughput, numbers.next());
  const double whole = (segment.t1 - segment.t0) * length;
  const bool gets_through = !(depth < extinction[channel] * whole);
  const double distance = gets_through ? whole : depth / extinction[channel];
  const Color left = attenuation(distance * extinction);
  const Color shares = throughput / sum_of(throughput);
  if (gets_through) {
    throughput *= is_grey ? Color(1) : left / glm::dot(shares, left);
    return {};
  }
  throughput *= is_grey ? medium.scattering / extinction
                        : left * medium.scattering / glm::dot(shares, left * extinction);
  return {segment.medium, segment.t0 + distance / length};
}

/// The optical depth of a block's piece at its majorant. No more than a box can have, however rays from far
/// away are rounded; steps count it down, as there t itself may not move by one.
double depth_of(const MajorantWalk& block, double rate) {
  return std::min((block.t1() - block.t0()) * rate, kMostOpticalDepth);
}

MediumEvent walk_grid(const Scene& scene, const Ray& ray, const MediumSegment& segment, double length,
                      Color& throughput, MediumNumbers& numbers) {
  const ParticipatingMedium& medium = scene.media[segment.medium];
  const Color extinction = medium.extinction();
  double depth = random_depth(numbers);  // to the next collision
  for (MajorantWalk block(scene, ray, segment); block.next();) {
    const double rate = max_component(extinction) * block.majorant() * length;  // of collisions, by t
    double rest = depth_of(block, rate);
    for (; depth < rest; depth = random_depth(numbers)) {
      rest -= depth;
      const double t = block.t1() - rest / rate,
                   density = density_at(scene, medium, ray.origin + t * ray.direction);
      const Color real = (density * length / rate) * extinction;  // the probability in each channel
      const double chance = std::min(1.0, glm::dot(throughput, real) / sum_of(throughput));
      if (numbers.next() < chance) {
        throughput *= (density * length / (rate * chance)) * medium.scattering;
        return {segment.medium, t};
      }
      throughput *= glm::max(Color(1) - real, Color(0)) / (1 - chance);
    }
    depth -= rest;
  }
  return {};
}

/// What ratio tracking leaves of `left`.
void track_ratio(const Scene& scene, const Ray& ray, const MediumSegment& segment, double length, Color& left,
                 MediumNumbers& numbers) {
  constexpr double kLittle = 0.05;
  const ParticipatingMedium& medium = scene.media[segment.medium];
  const Color extinction = medium.extinction();
  double depth = random_depth(numbers);
  for (MajorantWalk block(scene, ray, segment); block.next();) {
    const double rate = max_component(extinction) * block.majorant() * length;
    double rest = depth_of(block, rate);
    for (; depth < rest; depth = random_depth(numbers)) {
      rest -= depth;
      const double density =
          density_at(scene, medium, ray.origin + (block.t1() - rest / rate) * ray.direction);
      left *= glm::max(Color(1) - (density * length / rate) * extinction, Color(0));
      if (max_component(left) >= kLittle) continue;
      if (numbers.next() < 0.5) {
        left = Color(0);
        return;
      }
      left *= 2.0;
    }
    depth -= rest;
  }
}

bool is_walked(const ParticipatingMedium& medium) {
  return medium.scattering != Color(0);
}

}  // namespace

double MediumNumbers::next() {
  const uint64_t number = count_++;
  if (number == 0) pair_ = sampler_.point(id_, dimension_);
  if (number < 2) return number == 0 ? pair_.x : pair_.y;
  if (number == 2)
    key_ =
        mix_bits(mix_bits(sampler_.pixel_key(id_) ^ sampler_.frame_and_dimension(dimension_)) + id_.sample);
  return static_cast<double>(mix_bits(key_ + number * 0x9e3779b97f4a7c15ull) >> 11) * 0x1p-53;
}

MediumEvent walk_through_media(const Scene& scene, const Ray& ray, Color& throughput,
                               MediumNumbers& numbers) {
  const double length = glm::length(ray.direction);
  for (const MediumSegment& segment : media_along(scene, ray)) {
    const ParticipatingMedium& medium = scene.media[segment.medium];
    if (!(sum_of(throughput) > 0)) return {};
    if (!is_walked(medium)) {
      throughput *= attenuation(density_along(scene, ray, segment) * medium.extinction());
      continue;
    }
    const MediumEvent event = medium.has_grid()
                                  ? walk_grid(scene, ray, segment, length, throughput, numbers)
                                  : walk_homogeneous(medium, segment, length, throughput, numbers);
    if (event.is_scattered()) return event;
  }
  return {};
}

Color estimate_transmittance(const Scene& scene, const Ray& ray, MediumNumbers& numbers) {
  const double length = glm::length(ray.direction);
  Color depth(0), left(1);
  for (const MediumSegment& segment : media_along(scene, ray)) {
    const ParticipatingMedium& medium = scene.media[segment.medium];
    if (medium.has_grid() && is_walked(medium))
      track_ratio(scene, ray, segment, length, left, numbers);
    else
      depth += density_along(scene, ray, segment) * medium.extinction();
  }
  return depth == Color(0) ? left : left * attenuation(depth);
}

}  // namespace rayfarm
