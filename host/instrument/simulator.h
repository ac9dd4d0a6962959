#pragma once
// A discrete-event simulation of the net: a host, up to 16,383 processors and what joins them, frame by
// frame. The only random thing in it is what the cost map holds, so equal inputs give equal outputs.
#include <cstdint>
#include <vector>

#include "protocol/job_plan.h"

namespace rayfarm {

/// What tracing costs over the image, on one processor, and what its results weigh: by the cells of an even
/// division.
struct CostMap {
  int width_px = 1024, height_px = 1024;
  int columns = 1, rows = 1, frames = 1;  ///< later frames repeat these
  std::vector<double> pixel_s{0.04};      ///< frames × rows × columns: time to trace one pixel of the cell
  std::vector<double> pixel_bytes{1.0};   ///< frames × rows × columns: of a compressed block, per pixel
};

enum class NetShape {
  bus,    ///< all messages one after the other (the thesis's net)
  ports,  ///< a switch with full duplex: the host's port is all that is shared
};

enum class ResultForm {
  pixels,     ///< 9 bytes a pixel
  blocks,     ///< 3 bytes a pixel, one message a subpolygon
  compressed  ///< a block of what its cells say
};

/// As least_side_of a wire.
constexpr int least_side_of(ResultForm form) {
  return least_side_of(form == ResultForm::pixels ? Wire::pixel : Wire::block);
}

struct Simulation {
  int processors = 1;
  int frames = 1;
  AssignmentPolicy policy = AssignmentPolicy::interleaved;
  SetPattern sets = SetPattern::lattice;  ///< interleaved
  bool rotates = true;                    ///< interleaved: sets move on from frame to frame
  int subpolygons_per_processor = kSubpolygonsPerProcessor;
  int least_side_px = 1;  ///< of a subpolygon
  int frames_open = 3;    ///< a frame is begun only when the one so many before it is whole
  ResultForm form = ResultForm::pixels;
  int pixels_per_message = 1;  ///< of the pixel form
  int messages_held = 1;       ///< by a processor before it waits for the net; 0: any number
  int assigned_ahead = 2;      ///< on demand: subpolygons that a processor has
  NetShape net = NetShape::bus;
  int nets = 1;                      ///< each joins its share of the processors with the host
  double rate_bit_per_s = 8e6;       ///< of each
  double message_bytes = 0;          ///< what the net adds to every packet
  double packet_bytes = 0;           ///< the most that a packet carries; 0: no limit
  double latency_s = 0;              ///< of every message, beside its transmission
  int frame_buffers = 1;             ///< that take turns at the subpolygons
  double frame_buffer_s = 0;         ///< in which one stores a pixel
  double host_message_s = 0;         ///< that the host spends on each message
  double load_bytes = 0;             ///< code and data, broadcast once
  std::vector<double> time_factors;  ///< of the processors, in turn: 2 is half as fast; empty: all 1
  CostMap cost;
};

/// How the picture is cut.
SubpolygonGrid grid_of(const Simulation& simulation);

struct SimulatedFrame {
  double end_s = 0;  ///< its last pixel is stored, from the start of the job
};

struct SimulationResult {
  std::vector<SimulatedFrame> frames;
  double total_s = 0;
  double first_frame_s = 0;  ///< with loading
  double frame_s = 0;        ///< mean time between the ends of frames; the whole time if there is one
  double busy_s = 0;         ///< of all processors: tracing
  double efficiency = 0;     ///< busy_s, as if all were equally fast, over processors × time after loading
  double net_use = 0;        ///< share of the time after loading, mean over the nets
  double waited_s = 0;       ///< of all processors, for the net
  double bytes = 0;          ///< on the net, without loading
  uint64_t messages = 0;
};

/// Throws std::invalid_argument for numbers that make no sense.
SimulationResult simulate(const Simulation& simulation);

}  // namespace rayfarm
