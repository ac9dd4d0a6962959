#pragma once
// The thesis's model of the net (section 4.4.4.2, Equation 4.6): T = T_C + T_D + N T_P + D_R / N T_R, with
// what limits it: the net's and the frame buffer's own time for a frame's pixels.
#include <cstdint>
#include <string>
#include <vector>

namespace rayfarm {

/// A form in which results travel.
struct WireModel {
  std::string name;
  double bytes_per_pixel = 9;
  /// Of one message; 0: a subpolygon, of which a processor has `subpolygons_per_processor`.
  double pixels_per_message = 1;
};

/// Light that is spread over zones before pictures, in rounds.
struct ZonesModel {
  double zones = 0;  ///< n; 0: there are none
  double rounds = 1;
  double rays = 1e6;        ///< of a round
  double ray_time_s = 0;    ///< T_R: to trace a ray, on one processor
  double result_bytes = 0;  ///< of all processors in a round
};
/// What a zone's unsent power weighs, which every processor is told in each round: three numbers of 8 bytes.
inline constexpr double kZoneBytes = 24;

struct NetModel {
  double code_bytes = 0, data_bytes = 0;
  double copies_per_processor = 0;  ///< 0: code and data are broadcast, once for all
  double assignment_bytes = 0;      ///< per processor and frame
  double rate_bit_per_s = 8e6;
  double pixels = 1024.0 * 1024.0;  ///< D_R
  double pixel_time_s = 0.04;       ///< T_R: to trace a pixel, on one processor
  double frame_buffer_s = 0;        ///< in which the host stores a pixel; 0: no time at all
  double subpolygons_per_processor = 64;
  std::vector<WireModel> wires;
  ZonesModel zones;
};

/// The thesis's numbers: 194,424 bytes of code, 247K of data, 8 Mbit/s, 1024 × 1024 pixels of 0.04 s, 9
/// bytes. Assignments are left out, as the thesis leaves them out in the end.
NetModel thesis_model();

/// What `processors` need with one wire, in seconds.
struct NetTimes {
  double processors = 1;
  double code_s = 0, data_s = 0;  ///< T_C, T_D
  double assignment_s = 0;
  double results_s = 0;       ///< N T_P: a message of every processor
  double trace_s = 0;         ///< D_R / N T_R
  double net_s = 0;           ///< for all pixels of a frame
  double frame_buffer_s = 0;  ///< for all pixels of a frame
  double first_frame_s = 0, next_frame_s = 0;
  double first_speedup = 0, next_speedup = 0;
  double net_use = 0;  ///< share of a next frame's time in which the net is busy
};
NetTimes evaluate(const NetModel& model, const WireModel& wire, double processors);

/// What `processors` need for the light of zones, in seconds: rounds (24 n / W + rays T_R / N + results / W),
/// W the net's bytes per second; unsent power is broadcast.
struct ZonesTimes {
  double data_s = 0, trace_s = 0, results_s = 0;  ///< of all rounds
  double total_s() const { return data_s + trace_s + results_s; }
};
ZonesTimes evaluate_zones(const NetModel& model, double processors);

/// Processors whose results fill the net, or the frame buffer's time (infinity: never).
double saturating_processors(const NetModel& model, const WireModel& wire);
double frame_buffer_processors(const NetModel& model);

/// The number of processors, up to what a command can address, with the shortest first frame.
int best_processors(const NetModel& model, const WireModel& wire);

}  // namespace rayfarm
