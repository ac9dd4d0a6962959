#include "host/instrument/model.h"

#include <algorithm>
#include <limits>

#include "protocol/messages.h"

namespace rayfarm {

NetModel thesis_model() {
  NetModel model;
  model.code_bytes = 194'424;
  model.data_bytes = 247'000;
  model.wires = {{"pixel", kPixelBytes, 1}};
  return model;
}

NetTimes evaluate(const NetModel& model, const WireModel& wire, double processors) {
  const double byte_s = 8 / model.rate_bit_per_s;
  const double copies = model.copies_per_processor > 0 ? model.copies_per_processor * processors : 1;
  const double message_pixels = wire.pixels_per_message > 0
                                    ? wire.pixels_per_message
                                    : model.pixels / (model.subpolygons_per_processor * processors);
  NetTimes t;
  t.processors = processors;
  t.code_s = copies * model.code_bytes * byte_s;
  t.data_s = copies * model.data_bytes * byte_s;
  t.assignment_s = processors * model.assignment_bytes * byte_s;
  t.results_s = processors * message_pixels * wire.bytes_per_pixel * byte_s;
  t.trace_s = model.pixels / processors * model.pixel_time_s;
  t.net_s = model.pixels * wire.bytes_per_pixel * byte_s + t.assignment_s;
  t.frame_buffer_s = model.pixels * model.frame_buffer_s;
  t.next_frame_s = std::max({t.trace_s, t.net_s, t.frame_buffer_s});
  t.first_frame_s = t.code_s + t.data_s + t.assignment_s + t.results_s + t.next_frame_s;
  const double alone_s = model.pixels * model.pixel_time_s;
  t.first_speedup = alone_s / t.first_frame_s;
  t.next_speedup = alone_s / t.next_frame_s;
  t.net_use = t.net_s / t.next_frame_s;
  return t;
}

ZonesTimes evaluate_zones(const NetModel& model, double processors) {
  const double byte_s = 8 / model.rate_bit_per_s;
  const ZonesModel& z = model.zones;
  return {z.rounds * kZoneBytes * z.zones * byte_s, z.rounds * z.rays * z.ray_time_s / processors,
          z.rounds * z.result_bytes * byte_s};
}

double saturating_processors(const NetModel& model, const WireModel& wire) {
  return model.pixel_time_s * model.rate_bit_per_s / 8 / wire.bytes_per_pixel;
}

double frame_buffer_processors(const NetModel& model) {
  return model.frame_buffer_s > 0 ? model.pixel_time_s / model.frame_buffer_s
                                  : std::numeric_limits<double>::infinity();
}

int best_processors(const NetModel& model, const WireModel& wire) {
  int best = 1;
  double least = evaluate(model, wire, 1).first_frame_s;
  for (int n = 2; n <= kMostProcessors; ++n) {
    const double time = evaluate(model, wire, n).first_frame_s;
    if (time < least) {
      least = time;
      best = n;
    }
  }
  return best;
}

}  // namespace rayfarm
