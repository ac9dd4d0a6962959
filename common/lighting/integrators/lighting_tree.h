#pragma once
// The lighting tree (thesis 2.3.4) as a list of work: batches of rays to trace, each with its branch of the
// tree, and forks, surfaces that wait for the light of theirs. What is seen does not depend on the order in
// which batches are traced: a fork adds up what its branches brought in the order of their kinds, once all
// have. The last batch in is the first out, so that few wait: a transmitted and a reflected one at each
// depth, and what a model adds.
#include <array>
#include <deque>
#include <numeric>
#include <optional>

#include "common/lighting/integrators/classical_surfaces.h"
#include "common/lighting/integrators/pool.h"
#include "common/lighting/self_hits.h"

namespace rayfarm {

/// Whom a ray brings its light to.
struct Receiver {
  /// A fork, of which it is the transmitted or the reflected branch (of a fork that adds up a lobe's rays:
  /// one of them, or the rest); the eye; or something that the model keeps itself.
  enum class Kind : uint8_t { transmitted, reflected, eye, own };
  Kind kind = Kind::eye;
  uint32_t fork = 0;   ///< own: what the model likes
  uint32_t place = 0;  ///< eye: among the eye rays; own: what the model likes
  Color share{1};      ///< of what the ray sees in what the fork shows, the model's own, or the eye
};

/// Where a ray stands in its lighting tree.
struct Branch {
  /// Of an eye ray. It sets what is read and no more: many are made, and clearing all of one first, as a
  /// constructor that the compiler makes does, costs more than making it.
  Branch(const SampleId& of, size_t ray, double of_width, double of_spread)
      : receiver{.place = static_cast<uint32_t>(ray)},
        id(of),
        width(of_width),
        spread(of_spread),
        eye_ray(static_cast<uint8_t>(ray)) {}
  Receiver receiver;
  double weight = 1;    ///< the largest share that its colour can have in its pixel
  SampleId id;          ///< its sample
  uint32_t stream = 0;  ///< tells the branches of one sample apart, for their random numbers
  /// Of its cone where it begins (once traced: where it ends), and what it gains with each unit of length.
  double width, spread;
  uint16_t reflections = 0, transmissions = 0;  ///< on the way from the eye, this ray's own with them
  Media media;                                  ///< that it is in
  /// Sources that it meets were found by the shadow rays of the surface that a diffuse ray left.
  bool skips_sources = false;
  uint8_t eye_ray;  ///< from which all this comes

  /// It has met something. Media weaken what it brings.
  void arrive(const Scene& scene, double distance) {
    width += distance * spread;
    if (!media.is_in_air()) weaken(media.transmittance(scene, distance));
  }
  /// This is left of what it brings.
  void weaken(const Color& left) {
    receiver.share *= left;
    weight *= max_component(left);
  }
};
static_assert(std::is_trivially_copyable_v<Branch>);

/// A surface that branches leave.
struct Fork {
  Fork(const Receiver& of, const Color& light) : receiver(of), color(light) {}
  Receiver receiver;                   ///< of what it shows
  uint32_t pending = 0;                ///< how many of its branches are on their way
  Color color;                         ///< without its branches' light
  Color transmitted{0}, reflected{0};  ///< what branches brought

  Color sum() const { return color + transmitted + reflected; }
};
static_assert(std::is_trivially_copyable_v<Fork>);

/// What rays are in.
inline MediaOfRays media_of(const OfPacket<Branch>& branches) {
  MediaOfRays media{};
  for (size_t i = 0; i < branches.size(); ++i) media[i] = &branches[i].media;
  return media;
}

/// Puts the closest hits that are no holes in the place of `hits`.
void pass_holes(const FrameContext& context, const RayPacket& rays, const OfPacket<Branch>& branches,
                Hit* hits);

/// Rays of one depth to trace.
struct Batch {
  uint32_t depth;
  RayPacket rays;
  OfPacket<Branch> branches;
};

/// The rays that a surface refracts and mirrors.
struct SecondaryRays {
  uint32_t transmitted_rays = 0, reflected_rays = 0;  ///< how many there are
  uint32_t cut_rays = 0;                              ///< how many would contribute too little
  Vec3 transmitted, reflected;                        ///< their axis, unit
  Color transmit{0};                                  ///< the share of all of them together
  double reflect = 0;
};

/// Those of surface i, which has any. One that transmits also spawns a reflected ray, even one of weight 0 if
/// there is no cut-off: that is how published ray counts were made. Total internal reflection sends the
/// transmitted share along the mirror direction, and is a reflection. `branch`: that met the surface; limits
/// other than the depth are kept.
SecondaryRays secondary_rays(const ClassicalSurfaces& surfaces, size_t i, const Branch& branch,
                             const RenderSettings& settings);

class LightingTree {
 public:
  /// Begins anew with eye rays, of depth 1, and returns their branches; `colors` are set as what they see is
  /// known.
  OfPacket<Branch>& plant(const FrameContext& context, std::span<const SampleId> ids, Color* colors);

  /// A ray of this depth leaves the branch.
  void reach(const Branch& from, uint32_t depth) {
    depths_[from.eye_ray] = std::max(depths_[from.eye_ray], depth);
  }
  /// How deep the trees of the eye rays are, summed up.
  uint64_t depths() const {
    return std::accumulate(depths_.begin(), depths_.begin() + eye_branches_.size(), uint64_t{0});
  }

  /// Numbers of the rays that leave a surface, which tell them apart; from kFirstOwn on they are the model's,
  /// and from kOfLobe on the others of a lobe, each that far from the one before it.
  enum Child : uint32_t { kTransmitted = 1, kReflected, kFirstOwn, kOfLobe = 1 << 16 };
  /// A ray from `origin`, just off the surface that `from` met, whose width is that at the surface, enters
  /// the batch.
  static Branch& grow(const Branch& from, const Vec3& origin, const Vec3& direction, double share,
                      uint32_t child, Batch& batch);
  /// The surface that a ray met waits for others; `light` is what it shows without them.
  uint32_t add_fork(const Receiver& receiver, const Color& light) { return forks_.add(receiver, light); }
  Fork& operator[](uint32_t fork) { return forks_[fork]; }
  /// The secondary rays of surface i, as far as there are any; others take the place of batches that are
  /// full.
  void grow_secondary(const FrameContext& context, uint32_t fork, const Branch& from,
                      const ClassicalSurfaces& surfaces, size_t i, const SecondaryRays& rays,
                      Batch*& transmitted, Batch*& reflected);

  /// An empty batch, to be filled, that is traced before all there are. It stays where it is until it is
  /// traced, and so do the others.
  Batch& begin_batch(uint32_t depth) {
    if (batch_count_ == batches_.size()) batches_.emplace_back();
    Batch& batch = batches_[batch_count_++];
    batch.depth = depth;
    return batch;
  }
  /// The newest batch, where it is of this depth and has room for so many rays, so that rays of several
  /// surfaces fill one; else an empty one. None may be on its way.
  Batch& batch_with_room(uint32_t depth, size_t rays) {
    if (batch_count_ > 0) {
      Batch& newest = batches_[batch_count_ - 1];
      if (newest.depth == depth && newest.rays.size + rays <= kMostPacketRays) return newest;
    }
    return begin_batch(depth);
  }
  /// The batch to trace next, null at the end. Whoever has traced it ends it.
  Batch* next_batch() {
    while (batch_count_ > 0 && batches_[batch_count_ - 1].rays.empty()) --batch_count_;
    return batch_count_ > 0 ? &batches_[batch_count_ - 1] : nullptr;
  }
  static void end(Batch& batch) {
    batch.rays.clear();
    batch.branches.clear();
  }

  /// What comes to something of the model's own.
  struct Delivery {
    Receiver receiver;
    Color color;
  };
  /// Brings the light of a ray to its receiver, and so on from forks that it was the last for.
  std::optional<Delivery> deliver(const Receiver& to, Color color) {
    for (const Receiver* receiver = &to;;) {
      if (receiver->kind == Receiver::Kind::eye) {
        colors_[receiver->place] = receiver->share * color;
        return std::nullopt;
      }
      if (receiver->kind == Receiver::Kind::own) return Delivery{*receiver, receiver->share * color};
      Fork& fork = forks_[receiver->fork];
      (receiver->kind == Receiver::Kind::transmitted ? fork.transmitted : fork.reflected) =
          receiver->share * color;
      if (--fork.pending > 0) return std::nullopt;
      forks_.release(receiver->fork);  // it stays as it is until another is added
      color = fork.sum();
      receiver = &fork.receiver;
    }
  }
  /// The same for something of the model's own that a fork waited for.
  std::optional<Delivery> settle(uint32_t place) {
    Fork& fork = forks_[place];
    if (--fork.pending > 0) return std::nullopt;
    forks_.release(place);
    return deliver(fork.receiver, fork.sum());
  }

 private:
  /// What tells a lobe's rays from others.
  struct OfLobe {
    uint32_t rays;
    const Vec3& axis;
    Color share;  ///< of each
    uint32_t child;
  };
  template <typename Cross>
  void grow_lobe(const FrameContext& context, Receiver receiver, const Branch& from,
                 const ClassicalSurfaces& surfaces, size_t i, const OfLobe& lobe, Batch*& batch, Cross cross);

  Pool<Fork> forks_;
  OfPacket<Branch> eye_branches_;
  std::array<uint32_t, kMostPacketRays> depths_{};  ///< by eye ray
  std::deque<Batch> batches_;  ///< the first `batch_count_` of them: what lies under others may have ended
  size_t batch_count_ = 0;
  Color* colors_ = nullptr;
};

}  // namespace rayfarm
