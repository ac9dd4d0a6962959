#pragma once
// Tells people how far the job is: one line that is rewritten on a terminal, a line every few seconds
// elsewhere; programs a line of JSON every second.
#include <cstdint>
#include <optional>
#include <string>

#include "common/lighting/zones/zone_solver.h"
#include "host/files/json.h"

namespace rayfarm {

enum class ProgressStyle { automatic, tty, plain, json, none };

class Progress {
 public:
  explicit Progress(ProgressStyle style, uint64_t pixels_total = 0);
  /// Shows how much of the scene's files is read, or of the scene is sent ("reading", "sending"), in bytes,
  /// if it is time to.
  void show_bytes(const char* what, double now_s, uint64_t done, uint64_t total);
  /// Shows how far the hierarchy of a big scene is, if it is time to.
  void show_building(double now_s, uint64_t done, uint64_t total);
  /// Shows how far light is spread over zones, if it is time to; `now_s` is the time since that began.
  void show_zones(double now_s, const ZoneProgress& zones, int nodes);
  /// Shows the state if it is time to; `now_s` is the time since tracing began, and `pixels_resumed` are
  /// those of the pixels done that were there then.
  void show(double now_s, uint64_t pixels_done, uint64_t pixels_resumed, uint64_t rays, uint64_t result_bytes,
            int nodes, bool at_end = false);
  /// Ends the rewritten line, so that other text may follow.
  void clear();
  /// True if the next that is shown at this time would be printed: who has to count first may ask.
  bool is_due(double now_s) const;

 private:
  bool is_time(double now_s);
  void print(const std::string& text, double share_done);
  void print(Json::Object told, double now_s, double share_done);

  ProgressStyle style_;
  uint64_t pixels_total_;
  double shown_s_ = 0;
  bool line_is_open_ = false;
};

/// What is left of work of which this share is done, if it goes on as it went; nothing if nothing is done.
std::optional<double> time_left_s(double elapsed_s, double share_done);
std::string format_duration(double seconds);
/// Three digits and more: 8.81 M, 12.3 k, 812.
std::string format_count(double count);
/// 1.31 Mrays/s, 12.3 krays/s, 812 rays/s.
std::string format_rate(double count, const char* unit);

}  // namespace rayfarm
