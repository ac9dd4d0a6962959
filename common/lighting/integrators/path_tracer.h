#pragma once
// A packet of paths on their way: what `path`, and the pictures of zones, are made of. The steps of packets
// are in path.cpp, what a path finds at a surface by itself in path_visit.cpp, what media do in
// path_in_media.cpp, several rays in place of one in path_split.cpp.
#include <vector>

#include "common/lighting/integrators/path_media.h"
#include "common/lighting/integrators/path_step.h"
#include "common/lighting/media.h"
#include "common/lighting/ray_counts.h"
#include "common/lighting/self_hits.h"
#include "common/lighting/zones/zone_light.h"

namespace rayfarm {

/// From this depth on paths end by chance.
inline constexpr uint32_t kFirstRoulette = 4;

/// A path on its way.
struct Path {
  Color throughput{1};
  uint32_t place = 0;  ///< of its eye ray, whose colour it adds to
  SampleId id;
  Media media;
  double pdf = 0;  ///< of the last direction; 0: only chance could have led here, as along a mirror's
  double width = 0, spread = 0;  ///< of the ray's cone
  uint32_t depth = 1, reflections = 0, transmissions = 0;
  bool is_gathering = false;  ///< its last turn was by chance all over: zones that it meets end it
  bool is_split = false;      ///< one of the rays that a point sends in place of one
};
static_assert(std::is_trivially_copyable_v<Path>);

/// A path at a surface that sends it on.
struct Turn {
  size_t lane = 0;
  Surface surface;
  Interaction at;
  Lobes lobes;
  bool is_dielectric = false;
};

/// Up to kMostPacketRays paths go on together; what becomes of one does not depend on the others. Those whose
/// surfaces allow it take their steps in lanes at once, the others one by one, and no bit of a colour tells
/// which.
class PathTracer {
 public:
  PathTracer(const FrameContext& context, bool is_in_lanes, RayCounts& counts, Color* colors)
      : context_(context),
        scene_(context.scene),
        pose_(context.pose),
        settings_(context.tables.settings),
        sampler_(context.tables.sampler),
        is_in_lanes_(is_in_lanes),
        has_media_(!context.scene.media.empty()),
        is_by_medium_(is_by_medium(context)),
        gather_rays_(context.zones && context.zones->view() == ZoneView::gather
                         ? context.tables.settings.zones.gather_rays
                         : 1),
        counts_(counts),
        colors_(colors) {}

  /// Returns how many rays met an object.
  size_t trace(const RayPacket& rays, std::span<const SampleId> ids);

 private:
  void step();

  /// Adds what shadow rays bring.
  void add_unblocked(ShadowLanes& shadows);

  PathStage stage(StepPart part = StepPart::both) const {
    return {context_, ids_.span(), depth_, depth_ >= kFirstRoulette, part};
  }

  /// Adds what zones of media keep along the rays, and weakens what is behind them. In the view `direct`
  /// light straight from sources is asked for at one point of each ray.
  void read_media(const Hit* hits);

  /// Returns the lanes that media scatter before they meet what `hits` says; those whose paths go on join
  /// `go_on`. Scattering counts as a diffuse reflection.
  LaneSet visit_media(const Hit* hits, LaneSet& go_on);

  /// Rays know what they are in, and so do the shadow rays of this step.
  [[gnu::noinline]] void keep_real(Hit* hits);

  /// Rays go on through surfaces that are not there, and light comes through them.
  [[gnu::noinline]] void pass_holes(Hit* hits);
  [[gnu::noinline]] void light_holes(uint32_t& blocked, ShadowLanes& shadows) const;

  [[gnu::noinline]] uint32_t find_really_blocked(const ShadowLanes& shadows) const;

  /// Whether, where a path spreads for the first time, several rays go on in its place.
  bool splits(const Path& path) const { return gather_rays_ > 1 && !path.is_split; }
  bool is_split_here(size_t lane) const {
    return splits(paths_[lanes_.places[lane]]) && (lanes_.substrates & lanes_.can_reflect) >> lane & 1;
  }

  /// Follows to their ends the rays that each of these lanes sends on, and those of `turns_`; other lanes
  /// stay as they are.
  [[gnu::noinline]] void follow_split(LaneSet together);

  /// A path's step by itself.
  bool visit_alone(size_t lane, const Hit& hit);

  /// Sets what a step in lanes needs. False if the path must go alone: nothing has happened to it then.
  bool prepare(size_t lane, const Hit& hit);

  /// The steps of the lanes that are prepared. Returns those whose paths go on.
  LaneSet visit_together(LaneSet lanes, StepPart part = StepPart::both);

  /// Adds what the path finds where it hits, and turns `ray` into what follows. False: the path ends, or goes
  /// on as several rays by a turn that is added to `turns_`.
  bool visit(size_t lane, Path& path, Ray& ray, const Hit& hit, Surface& surface);
  /// Turns the path's ray. False: it ends.
  bool turn(Path& path, Ray& ray, const Surface& surface, const Interaction& at, const Lobes& lobes,
            bool is_dielectric);

  /// Whether light that zones keep is read from them where the path is.
  bool ends_at_zones(const Path& path) const {
    return path.is_gathering || context_.zones->view() != ZoneView::gather;
  }

  /// Adds what zones keep, and leaves the lobes that they do not. Returns those that they do where what
  /// comes straight from sources is still to be asked for.
  Lobes take_from_zones(const Path& path, const Hit& hit, const Surface& surface, const Interaction& at,
                        Lobes& lobes);

  /// Light that has been reflected or transmitted as often as is allowed goes on by the other lobes alone. So
  /// what a shadow ray finds is limited as what the path itself finds.
  void keep_allowed(const Path& path, Lobes& lobes) const;

  Vec2 point(const Path& path, dimension::Bounce use) const {
    return sampler_.point(path.id, dimension::of_bounce(path.depth, use));
  }

  void add_emission(Path& path, const Ray& ray, const Hit& hit, const Surface& surface,
                    const Material& material, const Interaction& at);

  static bool is_followed(const Material& material, const Lobe& lobe) {
    return lobe.is_transmitted || (has_reflected_rays(material) && lobe.spread != Lobe::Spread::diffuse);
  }

  /// A shadow ray to one of the sources. `followed`: the lobes along which paths may find it, too.
  void add_direct_light(const Path& path, const Surface& surface, const Interaction& at, const Lobes& lobes,
                        const Lobes& followed);

  bool survives(Path& path, double u) const;

  const FrameContext& context_;
  const Scene& scene_;
  const Pose& pose_;
  const RenderSettings& settings_;
  const Sampler& sampler_;
  bool is_in_lanes_, has_media_, is_by_medium_;
  uint32_t gather_rays_;
  RayCounts& counts_;
  Color* colors_;  ///< of the eye rays
  size_t eye_hits_ = 0;
  OfPacket<SampleId> ids_;  ///< by place
  uint32_t depth_ = 1;      ///< of all paths: each step adds one
  OfPacket<Path> paths_;    ///< by place; throughput and pdf stand in lanes_
  PathLanes lanes_;         ///< in the order of the rays
  ShadowLanes shadows_;
  std::vector<Turn> turns_;                          ///< of this step, at which paths split
  std::array<Media, kMostPacketRays> shadow_media_;  ///< by place, where rays have to know
};

}  // namespace rayfarm
