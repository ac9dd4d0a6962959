#include "host/farm/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "host/process/console.h"

namespace rayfarm {
namespace {

constexpr double kTtyInterval_s = 0.2;
constexpr double kPlainInterval_s = 5;
constexpr double kJsonInterval_s = 1;
constexpr int kBarWidth = 24;

}  // namespace

std::optional<double> time_left_s(double elapsed_s, double share_done) {
  if (!(share_done > 0)) return std::nullopt;
  return elapsed_s * (1 - share_done) / share_done;
}

std::string format_duration(double seconds) {
  const auto s = static_cast<long long>(std::llround(seconds));
  return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string format_count(double count) {
  if (count >= 1e9) return fmt::format("{:.2f} G", count / 1e9);
  if (count >= 1e6) return fmt::format("{:.2f} M", count / 1e6);
  if (count >= 1e3) return fmt::format("{:.1f} k", count / 1e3);
  return fmt::format("{:.0f}", count);
}

std::string format_rate(double count, const char* unit) {
  const std::string text = format_count(count);
  return fmt::format("{}{}{}", text, text.find(' ') == std::string::npos ? " " : "", unit);
}

Progress::Progress(ProgressStyle style, uint64_t pixels_total) : style_(style), pixels_total_(pixels_total) {
  if (style_ == ProgressStyle::automatic)
    style_ = isatty(STDERR_FILENO) ? ProgressStyle::tty : ProgressStyle::plain;
}

bool Progress::is_due(double now_s) const {
  const double interval = style_ == ProgressStyle::tty    ? kTtyInterval_s
                          : style_ == ProgressStyle::json ? kJsonInterval_s
                                                          : kPlainInterval_s;
  return style_ != ProgressStyle::none && now_s - shown_s_ >= interval;
}

bool Progress::is_time(double now_s) {
  if (!is_due(now_s)) return false;
  shown_s_ = now_s;
  return true;
}

void Progress::print(const std::string& text, double share_done) {
  if (style_ == ProgressStyle::plain) {
    say("{}\n", text);
  } else {
    const auto filled = static_cast<size_t>(share_done * kBarWidth);
    say("\r\033[K[{}{}] {}", std::string(filled, '#'), std::string(kBarWidth - filled, '.'), text);
    line_is_open_ = true;
  }
}

void Progress::print(Json::Object told, double now_s, double share_done) {
  told["elapsed_s"] = now_s;
  told["share"] = share_done;
  say("{}\n", Json(std::move(told)).dump());
}

void Progress::show_bytes(const char* what, double now_s, uint64_t done, uint64_t total) {
  if (style_ == ProgressStyle::none || total == 0 || !is_time(now_s)) return;
  const double share = static_cast<double>(std::min(done, total)) / static_cast<double>(total);
  if (style_ == ProgressStyle::json)
    return print({{"phase", what}, {"bytes", done}, {"bytes_total", total}}, now_s, share);
  const double total_MB = static_cast<double>(total) / 1e6;
  print(fmt::format("{:5.1f} %  {}  {} {:.1f} of {:.1f} MB", 100 * share, format_duration(now_s), what,
                    share * total_MB, total_MB),
        share);
}

void Progress::show_building(double now_s, uint64_t done, uint64_t total) {
  if (style_ == ProgressStyle::none || total == 0 || !is_time(now_s)) return;
  // Clipping makes more pieces than there were primitives.
  const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  if (style_ == ProgressStyle::json)
    return print({{"phase", "building"}, {"primitives_total", total}}, now_s, share);
  print(fmt::format("{:5.1f} %  {}  building the hierarchy of {} primitives", 100 * share,
                    format_duration(now_s), format_count(static_cast<double>(total))),
        share);
}

void Progress::show_zones(double now_s, const ZoneProgress& zones, int nodes) {
  if (style_ == ProgressStyle::none || !is_time(now_s)) return;
  if (style_ == ProgressStyle::json)
    return print({{"phase", "zones"}, {"rounds", zones.rounds}, {"rays", zones.rays}, {"nodes", nodes}},
                 now_s, std::clamp(1 - zones.unsent, 0.0, 1.0));
  print(fmt::format("zones: round {}, {:.1f} % unsent, {}  {}  {} node{}", zones.rounds, 100 * zones.unsent,
                    format_rate(static_cast<double>(zones.rays), "rays"), format_duration(now_s), nodes,
                    nodes == 1 ? "" : "s"),
        std::clamp(1 - zones.unsent, 0.0, 1.0));
}

void Progress::show(double now_s, uint64_t pixels_done, uint64_t pixels_resumed, uint64_t rays,
                    uint64_t result_bytes, int nodes, bool at_end) {
  if (style_ == ProgressStyle::none || (!is_time(now_s) && !at_end)) return;
  const double done =
      pixels_total_ ? static_cast<double>(pixels_done) / static_cast<double>(pixels_total_) : 1;
  const auto pixels_made = static_cast<double>(pixels_done - pixels_resumed);
  const double bytes_per_pixel = pixels_made > 0 ? static_cast<double>(result_bytes) / pixels_made : 0.0;
  const std::optional<double> left_s =
      time_left_s(now_s, pixels_made / static_cast<double>(pixels_total_ - pixels_resumed));
  if (style_ == ProgressStyle::json) {
    Json::Object told{{"phase", "tracing"}, {"pixels", pixels_done}, {"pixels_total", pixels_total_},
                      {"rays", rays},       {"nodes", nodes},        {"bytes_per_pixel", bytes_per_pixel}};
    if (left_s) told["eta_s"] = *left_s;
    return print(std::move(told), now_s, done);
  }
  const std::string eta = left_s ? format_duration(*left_s) : "?";
  print(fmt::format("{:5.1f} %  {}  ETA {}  {}  {:.2f} bytes/pixel  {} node{}", 100 * done,
                    format_duration(now_s), eta,
                    format_rate(now_s > 0 ? static_cast<double>(rays) / now_s : 0, "rays/s"), bytes_per_pixel,
                    nodes, nodes == 1 ? "" : "s"),
        done);
}

void Progress::clear() {
  if (line_is_open_) say("\n");
  line_is_open_ = false;
}

}  // namespace rayfarm
