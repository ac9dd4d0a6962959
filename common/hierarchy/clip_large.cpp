#include "common/hierarchy/clip_large.h"

#include <bit>
#include <optional>
#include <queue>

namespace rayfarm {
namespace {

/// How often long loops ask whether to stop.
constexpr uint32_t kReferencesPerLook = 1 << 12;

class Splitter {
 public:
  Splitter(LargeVector<PrimitiveReference>& references, const PrimitiveSource& source,
           const std::stop_token& stop)
      : references_(references), source_(source), stop_(stop) {
    for (const PrimitiveReference& r : references_) whole_.grow(r.box());
  }

  void run() {
    const double least_gain = kLeastGain * whole_.area();
    std::priority_queue<Candidate> queue;
    const auto consider = [&](uint32_t reference) {
      if (reference % kReferencesPerLook == 0) throw_if_stopped(stop_);
      // A split can't gain more than the box has.
      if (references_[reference].box().area() < least_gain) return;
      const std::optional<Candidate> candidate = try_split(reference);
      if (candidate && candidate->gain >= least_gain) queue.push(*candidate);
    };
    for (uint32_t i = 0; i < references_.size(); ++i) consider(i);
    const size_t most =
        references_.size() + static_cast<size_t>(kMostGrowth * static_cast<double>(references_.size()));
    while (!queue.empty() && references_.size() < most) {
      const Candidate best = queue.top();
      queue.pop();
      const uint32_t primitive = references_[best.reference].primitive;
      references_[best.reference] = make_reference(primitive, best.low);
      references_.push_back(make_reference(primitive, best.high));
      consider(best.reference);
      consider(static_cast<uint32_t>(references_.size() - 1));
    }
  }

 private:
  static constexpr double kLeastGain = 1e-4;  ///< of the whole box's area, for which a split pays (measured)
  static constexpr double kMostGrowth = 0.2;  ///< in references

  struct Candidate {
    double gain;  ///< of surface area
    uint32_t reference;
    Box low, high;
    bool operator<(const Candidate& other) const {
      return gain != other.gain ? gain < other.gain : reference > other.reference;
    }
  };

  /// Nothing if no plane divides the primitive.
  std::optional<Candidate> try_split(uint32_t reference) const {
    const Box box = references_[reference].box();
    const Vec3 extent = box.extent();
    const auto axis = static_cast<int>(largest_axis(extent));
    if (!(extent[axis] > 0)) return std::nullopt;
    // The first plane of the repeated halving that separates the box's ends.
    const double scale = 0x1p30 / (whole_.hi[axis] - whole_.lo[axis]);
    const auto low_cell = static_cast<uint32_t>((box.lo[axis] - whole_.lo[axis]) * scale);
    const auto high_cell = static_cast<uint32_t>((box.hi[axis] - whole_.lo[axis]) * scale);
    if (low_cell == high_cell) return std::nullopt;
    const uint32_t plane_cell = high_cell & ~((std::bit_floor(low_cell ^ high_cell)) - 1);
    const double plane = whole_.lo[axis] + plane_cell / scale;
    if (!(plane > box.lo[axis] && plane < box.hi[axis])) return std::nullopt;
    Box low = box, high = box;
    low.hi[axis] = high.lo[axis] = plane;
    const uint32_t primitive = references_[reference].primitive;
    low = intersection(low, source_.clipped(primitive, low));
    high = intersection(high, source_.clipped(primitive, high));
    if (low.is_empty() || high.is_empty()) return std::nullopt;
    return Candidate{box.area() - low.area() - high.area(), reference, low, high};
  }

  LargeVector<PrimitiveReference>& references_;
  const PrimitiveSource& source_;
  const std::stop_token& stop_;
  Box whole_;
};

}  // namespace

void clip_large(LargeVector<PrimitiveReference>& references, const PrimitiveSource& source,
                const std::stop_token& stop) {
  Splitter(references, source, stop).run();
}

}  // namespace rayfarm
