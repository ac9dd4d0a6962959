#include "host/commands/net_options.h"

#include <fmt/core.h>

#include <charconv>

namespace rayfarm {
namespace {

double parse_rate(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string unit(end, text.data() + text.size());
  const double factor = unit == "bit"    ? 1
                        : unit == "kbit" ? 1e3
                        : unit == "mbit" ? 1e6
                        : unit == "gbit" ? 1e9
                                         : 0;
  if (error != std::errc{} || factor == 0 || !(value > 0) || value * factor > 1e15)
    throw UsageError(
        fmt::format("'{}' is not a rate; give bits per second as 8mbit, 10gbit, 64kbit or 9600bit", text));
  return value * factor;
}

}  // namespace

void add_rate(Options& options, double& rate_bit_per_s) {
  options.text(
      "--rate", [&rate_bit_per_s](const std::string& text) { rate_bit_per_s = parse_rate(text); },
      "of the net, in bits per second (default: 8mbit)", "RATE");
}

void add_sets(Options& options, SetPattern& sets) {
  options.choice<SetPattern>("--sets", sets, {{"lattice", SetPattern::lattice}, {"rows", SetPattern::rows}},
                             "interleaved: how the subpolygons of one processor lie: without short steps, or "
                             "counted off row by row, one in every N (default: lattice)");
}

void add_format(Options& options, TableFormat& format) {
  options.word(
      "--format",
      [&format](const std::string& word) {
        format = word == "csv" ? TableFormat::csv : word == "json" ? TableFormat::json : TableFormat::text;
      },
      {"text", "csv", "json"}, "of the tables (default: text)");
}

}  // namespace rayfarm
