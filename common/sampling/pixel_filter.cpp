#include "common/sampling/pixel_filter.h"

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

constexpr size_t kSteps = 1024;  // of the tables
constexpr double kGaussianRadius = 1.5, kGaussianAlpha = 2;

double gaussian(double x) {
  return std::abs(x) < kGaussianRadius ? portable_exp(-kGaussianAlpha * x * x) -
                                             portable_exp(-kGaussianAlpha * kGaussianRadius * kGaussianRadius)
                                       : 0;
}

/// Mitchell and Netravali 1988, B = C = 1/3.
double mitchell(double offset) {
  const double x = std::abs(offset);
  if (x >= 2) return 0;
  if (x >= 1) return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
  return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
}

}  // namespace

PixelFilter::PixelFilter(FilterKind kind) : kind_(kind) {
  if (kind == FilterKind::box) return;
  radius_ = kind == FilterKind::tent ? 1 : kind == FilterKind::gaussian ? kGaussianRadius : 2;
  if (kind == FilterKind::tent) return;
  cumulative_.push_back(0);
  const double width = 2 * radius_ / kSteps;
  for (size_t i = 0; i < kSteps; ++i) {
    const double x = -radius_ + (static_cast<double>(i) + 0.5) * width;
    const double v = kind == FilterKind::gaussian ? gaussian(x) : mitchell(x);
    cumulative_.push_back(cumulative_.back() + std::abs(v) * width);
  }
}

double PixelFilter::value(double x) const {
  switch (kind_) {
    case FilterKind::box:
      return std::abs(x) <= 0.5 ? 1 : 0;
    case FilterKind::tent:
      return std::max(0.0, 1 - std::abs(x));
    case FilterKind::gaussian:
      return gaussian(x) / cumulative_.back();
    case FilterKind::mitchell:
      return mitchell(x);
  }
  return 0;
}

double PixelFilter::sample_axis(double u) const {
  switch (kind_) {
    case FilterKind::box:
      return u - 0.5;
    case FilterKind::tent:
      return u < 0.5 ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 * (1 - u));
    default:
      break;
  }
  const double target = u * cumulative_.back();
  auto step = std::upper_bound(cumulative_.begin(), cumulative_.end(), target) - cumulative_.begin() - 1;
  step = std::clamp<ptrdiff_t>(step, 0, kSteps - 1);
  const double below = cumulative_[static_cast<size_t>(step)],
               above = cumulative_[static_cast<size_t>(step) + 1];
  const double part = above > below ? (target - below) / (above - below) : 0.5;
  return -radius_ + (static_cast<double>(step) + part) * (2 * radius_ / kSteps);
}

PixelFilter::Place PixelFilter::sample(const Vec2& u) const {
  const Vec2 offset(sample_axis(u.x), sample_axis(u.y));
  if (kind_ != FilterKind::mitchell) return {offset, 1};
  // Where the filter is negative so is the sample's weight; what was made positive has to be given back.
  const double total = cumulative_.back() * cumulative_.back();
  const bool is_negative = (mitchell(offset.x) < 0) != (mitchell(offset.y) < 0);
  return {offset, is_negative ? -total : total};
}

}  // namespace rayfarm
