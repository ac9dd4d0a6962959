#include "common/hierarchy/spatial_splits.h"

#include <algorithm>
#include <cmath>

namespace rayfarm {
namespace {

constexpr size_t kBins = 32;
/// Planes are tried where the children of the best division of whole references overlap by more than this
/// part of the whole box's surface: what lies deeper is met by few rays (measured).
float least_overlap(BuildQuality quality) {
  return quality == BuildQuality::high ? 1e-4f : 1e-3f;
}
/// In references a primitive.
double most_growth(BuildQuality quality) {
  return quality == BuildQuality::high ? 1.0 : 0.3;
}
/// Whether it pays at all is asked of so many primitives.
constexpr size_t kSamples = 1024;
/// A primitive counts if halving its box gains more than the first part of the whole box's surface, and all
/// that count must gain more than the second (measured: it tells architecture from meshes and hair).
constexpr double kLeastGain = 2.5e-4, kLeastGainOfAll = 0.5;

Bounds bounds_of(const PrimitiveReference& r) {
  return {{r.lo[0], r.lo[1], r.lo[2], 0}, {r.hi[0], r.hi[1], r.hi[2], 0}};
}

/// A reference to the piece on one side; empty bounds if there is none.
PrimitiveReference piece(const PrimitiveSource& source, const PrimitiveReference& r, int axis, float plane,
                         bool is_high) {
  PrimitiveReference side = r;
  (is_high ? side.lo : side.hi)[static_cast<size_t>(axis)] = plane;
  const Box cell = side.box();
  return make_reference(r.primitive, intersection(cell, source.clipped(r.primitive, cell)));
}

bool is_empty(const PrimitiveReference& r) {
  return !(r.lo[0] <= r.hi[0] && r.lo[1] <= r.hi[1] && r.lo[2] <= r.hi[2]);
}

/// Of the two pieces of a reference that is halved across its longest side.
double halved_area(const PrimitiveSource& source, const PrimitiveReference& r) {
  size_t axis = 0;
  for (size_t i = 1; i < 3; ++i)
    if (r.hi[i] - r.lo[i] > r.hi[axis] - r.lo[axis]) axis = i;
  const float plane = 0.5f * r.lo[axis] + 0.5f * r.hi[axis];
  double sum = 0;
  for (const bool is_high : {false, true}) {
    const PrimitiveReference half = piece(source, r, static_cast<int>(axis), plane, is_high);
    if (!is_empty(half)) sum += bounds_of(half).area();
  }
  return sum;
}

}  // namespace

float blocks_of(size_t count) {
  return static_cast<float>((count + 7) / 8);
}

SpatialSplits::SpatialSplits(const PrimitiveSource& source, BuildQuality quality,
                             std::span<const PrimitiveReference> references)
    : source_(source), quality_(quality) {
  if (quality == BuildQuality::fast) return;
  Bounds whole = Bounds::none();
  for (const PrimitiveReference& r : references) whole.grow(bounds_of(r));
  whole_area_ = whole.area();
  if (pays(references))
    budget_ = static_cast<size_t>(most_growth(quality) * static_cast<double>(references.size()));
}

bool SpatialSplits::pays(std::span<const PrimitiveReference> references) const {
  double sum = 0;
  for (const PrimitiveReference& r : references) sum += bounds_of(r).area();
  // A sample for every so much of area, so that the large ones are among them however few they are.
  const double step = sum / kSamples;
  double gain = 0, next = 0.5 * step, seen = 0;
  for (const PrimitiveReference& r : references) {
    const double area = bounds_of(r).area();
    seen += area;
    if (!(seen > next)) continue;
    const double samples = std::floor((seen - next) / step) + 1;
    next += samples * step;
    if (!(area > kLeastGain * whole_area_)) continue;
    const double part = 1 - halved_area(source_, r) / area;
    if (part * area > kLeastGain * whole_area_) gain += samples * step * part;
  }
  return gain > kLeastGainOfAll * whole_area_;
}

bool SpatialSplits::is_promising(const Bounds& left, const Bounds& right) const {
  Bounds overlap = left;
  overlap.cut(right.lo.data(), right.hi.data());
  return !overlap.is_empty() && overlap.area() > least_overlap(quality_) * whole_area_;
}

SpatialSplits::Plane SpatialSplits::best_plane(std::span<const PrimitiveReference> references,
                                               const Bounds& bounds, size_t most_added) const {
  struct Bin {
    Bounds bounds = Bounds::none();
    uint32_t enter = 0, leave = 0;
  };
  Plane best;
  std::array<Bin, kBins> bins;
  std::array<Bounds, kBins> pieces;
  for (size_t axis = 0; axis < 3; ++axis) {
    const float extent = bounds.hi[axis] - bounds.lo[axis];
    const Slabs slabs{axis, bounds.lo[axis], extent / static_cast<float>(kBins), kBins};
    if (!slabs.are_distinct()) continue;
    bins.fill(Bin());
    for (const PrimitiveReference& r : references) {
      const size_t first = slabs.index(r.lo[axis]), last = slabs.index(r.hi[axis]);
      ++bins[first].enter;
      ++bins[last].leave;
      if (first == last) {
        bins[first].bounds.grow(r.lo.data(), r.hi.data());
        continue;
      }
      for (size_t i = first; i <= last; ++i) pieces[i] = Bounds::none();
      source_.chop(r.primitive, slabs, first, last, pieces.data());
      for (size_t i = first; i <= last; ++i) {
        pieces[i].cut(r.lo.data(), r.hi.data());
        if (!pieces[i].is_empty()) bins[i].bounds.grow(pieces[i]);
      }
    }
    std::array<float, kBins> cost_above;
    std::array<size_t, kBins> count_above;
    Bounds side = Bounds::none();
    size_t count = 0;
    for (size_t i = kBins; i-- > 1;) {
      side.grow(bins[i].bounds);
      count += bins[i].leave;
      count_above[i] = count;
      cost_above[i] = count > 0 && !side.is_empty() ? side.area() * blocks_of(count) : 0;
    }
    side = Bounds::none();
    count = 0;
    for (size_t i = 1; i < kBins; ++i) {
      side.grow(bins[i - 1].bounds);
      count += bins[i - 1].enter;
      if (count == 0 || count_above[i] == 0 || side.is_empty()) continue;
      if (count + count_above[i] > references.size() + most_added) continue;
      const float cost = side.area() * blocks_of(count) + cost_above[i];
      if (cost < best.cost) best = {static_cast<int>(axis), slabs.plane(i), cost};
    }
  }
  return best;
}

SpatialSplits::Sides SpatialSplits::divide(PrimitiveReference* first, size_t count, const Plane& plane,
                                           size_t most_added) const {
  const auto axis = static_cast<size_t>(plane.axis);
  struct Straddler {
    PrimitiveReference whole, low, high;
  };
  std::vector<Straddler> straddlers;
  std::vector<PrimitiveReference> lefts, rights;
  Bounds left = Bounds::none(), right = Bounds::none();
  const auto keep_left = [&](const PrimitiveReference& r) {
    lefts.push_back(r);
    left.grow(r.lo.data(), r.hi.data());
  };
  const auto keep_right = [&](const PrimitiveReference& r) {
    rights.push_back(r);
    right.grow(r.lo.data(), r.hi.data());
  };
  for (const PrimitiveReference& r : std::span(first, count)) {
    if (r.hi[axis] <= plane.position) {
      keep_left(r);
    } else if (r.lo[axis] >= plane.position) {
      keep_right(r);
    } else {
      const Straddler s{r, piece(source_, r, plane.axis, plane.position, false),
                        piece(source_, r, plane.axis, plane.position, true)};
      if (is_empty(s.high))
        keep_left(is_empty(s.low) ? s.whole : s.low);  // both: by rounding
      else if (is_empty(s.low))
        keep_right(s.high);
      else
        straddlers.push_back(s);
    }
  }
  const auto with = [](Bounds b, const PrimitiveReference& r) {
    b.grow(r.lo.data(), r.hi.data());
    return b;
  };
  for (const Straddler& s : straddlers) {
    left.grow(s.low.lo.data(), s.low.hi.data());
    right.grow(s.high.lo.data(), s.high.hi.data());
  }
  size_t added = 0;
  auto on_left = static_cast<float>(lefts.size() + straddlers.size());
  auto on_right = static_cast<float>(rights.size() + straddlers.size());
  for (const Straddler& s : straddlers) {
    const float both = left.area() * on_left + right.area() * on_right;
    const float only_left = with(left, s.whole).area() * on_left + right.area() * (on_right - 1);
    const float only_right = left.area() * (on_left - 1) + with(right, s.whole).area() * on_right;
    const bool is_cut = added < most_added && both < only_left && both < only_right;
    if (is_cut) {
      keep_left(s.low);
      keep_right(s.high);
      ++added;
    } else if (only_left <= only_right) {
      keep_left(s.whole);
      --on_right;
    } else {
      keep_right(s.whole);
      --on_left;
    }
  }
  const Sides sides{lefts.size(), rights.size()};
  if (sides.left == 0 || sides.right == 0) return sides;
  std::copy(rights.begin(), rights.end(), std::copy(lefts.begin(), lefts.end(), first));
  return sides;
}

}  // namespace rayfarm
