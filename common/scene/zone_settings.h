#pragma once
// What is asked of zones: cells of surfaces and media that hold light (the thesis's 2.2.5; Shirley, Sung and
// Brown 1991, section 3).
#include <array>
#include <cstdint>

namespace rayfarm {

/// How a picture shows the light that zones hold.
enum class ZoneView : uint8_t {
  flat,    ///< each zone as one colour
  smooth,  ///< linear between the zones' corners
  direct,  ///< light straight from sources by shadow rays, the rest from zones, smoothed
  gather   ///< light straight from sources by shadow rays, the rest by rays that read zones
};
inline constexpr std::array kZoneViewWords{"flat", "smooth", "direct", "gather"};

/// How the full matrix comes by its form factors.
enum class FormFactors : uint8_t {
  rays,     ///< from points all over a zone, in cosine directions
  hemicube  ///< from a zone's centre through the pixels of half a cube (Cohen and Greenberg 1985)
};
inline constexpr std::array kFormFactorWords{"rays", "hemicube"};

/// Where light begins.
enum class ZonePrimary : uint8_t {
  direct,  ///< zones ask all sources by shadow rays (Nishita and Nakamae: primary sources apart)
  shot     ///< luminous zones shoot what they emit; other sources as above
};
inline constexpr std::array kZonePrimaryWords{"direct", "shot"};

/// Which zones send their light in a round.
enum class ZoneShooting : uint8_t {
  all,  ///< all that hold unsent power
  one   ///< the one that holds most
};
inline constexpr std::array kZoneShootingWords{"all", "one"};

/// Of a round; ranges of them travel as pairs of 32 bits.
inline constexpr uint32_t kMostZoneRays = 1u << 30;

/// From a point that is seen.
inline constexpr uint32_t kMostGatherRays = 1024;

struct ZoneSettings {
  double size = 0;  ///< of a zone, in the world: its longest side is no longer; 0: chosen by the scene's area
  uint32_t rays =
      1'000'000;            ///< of the first round; later rounds have as many as keep a ray's power the same
  uint32_t samples = 16;    ///< points of a zone at which light from sources is measured
  uint32_t batch = 4096;    ///< rays that a node traces at a time
  double tolerance = 1e-3;  ///< rounds end when so much of all power is unsent
  ZoneView view = ZoneView::direct;
  uint32_t gather_rays = 1;  ///< of the view `gather`, from each point that is seen
  FormFactors form_factors = FormFactors::rays;
  uint32_t hemicube_cells = 64;  ///< along an edge of the cube's top
  ZonePrimary primary = ZonePrimary::direct;
  ZoneShooting shooting = ZoneShooting::all;
  double most_GiB = 4;  ///< that zones may take in a process

  uint64_t most_bytes() const { return static_cast<uint64_t>(most_GiB * 0x1p30); }

  template <typename Archive>
  void serialize(Archive& archive) {
    archive(size, rays, samples, batch, tolerance, view, gather_rays, form_factors, hemicube_cells, primary,
            shooting, most_GiB);
  }
  friend bool operator==(const ZoneSettings&, const ZoneSettings&) = default;
};

}  // namespace rayfarm
