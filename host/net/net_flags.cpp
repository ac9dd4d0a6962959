#include "host/net/net_flags.h"

#include <fmt/core.h>

#include <charconv>

namespace rayfarm {

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
    throw CLI::ValidationError(
        fmt::format("'{}' is not a rate; give bits per second as 8mbit, 10gbit, 64kbit or 9600bit", text));
  return value * factor;
}

void add_rate(CLI::App* app, double& rate_bit_per_s) {
  app->add_option_function<std::string>(
         "--rate", [&rate_bit_per_s](const std::string& text) { rate_bit_per_s = parse_rate(text); },
         "of the net, in bits per second (default: 8mbit)")
      ->type_name("RATE");
}

void add_format(CLI::App* app, TableFormat& format) {
  app->add_option_function<std::string>(
         "--format",
         [&format](const std::string& word) {
           format = word == "csv" ? TableFormat::csv : word == "json" ? TableFormat::json : TableFormat::text;
         },
         "of the tables (default: text)")
      ->check(CLI::IsMember({"text", "csv", "json"}));
}

}  // namespace rayfarm
