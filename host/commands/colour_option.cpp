#include "host/commands/colour_option.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "common/errors/input_error.h"

namespace rayfarm {
namespace {

/// `spectral:` is followed by how many wavelengths, or by the wavelengths.
std::vector<double> parse_colour_nodes(const std::string& text) {
  std::vector<double> numbers;
  for (const char* begin = text.data();; ++begin) {
    double number = 0;
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
    numbers.push_back(number);
    if (error != std::errc{} || (end != text.data() + text.size() && *end != ','))
      throw UsageError(
          fmt::format("--colour spectral:{}: after the colon stands how many wavelengths, as in "
                      "spectral:40, or which, as in spectral:400,450,550,650",
                      text));
    if (end == text.data() + text.size()) break;
    begin = end;
  }
  if (numbers.size() > 1) return numbers;
  const double count = numbers.front();
  if (!(count >= 4 && count <= double(kMostColourNodes)) || count != std::floor(count))
    throw UsageError(fmt::format("--colour spectral:{}: it takes from 4 to {} evenly spaced wavelengths",
                                 text, kMostColourNodes));
  return even_nodes(static_cast<size_t>(count));
}

void set_colour(const std::string& text, RenderSettings& settings) {
  static const std::vector<std::string> kWords{"rgb", "meyer4", "spectral20", "spectral"};  // as ColourModel
  const size_t colon = text.find(':');
  const std::string word = text.substr(0, colon);
  const auto found = std::find(kWords.begin(), kWords.end(), word);
  settings.colour = static_cast<ColourModel>(found - kWords.begin());
  settings.colour_nodes_nm.clear();
  if (found == kWords.end() || (colon != std::string::npos && settings.colour != ColourModel::spectral))
    throw UsageError(
        fmt::format("--colour {}: it must be rgb, meyer4, spectral20, spectral, spectral:N or "
                    "spectral:NM,NM,...{}",
                    text, suggestion(word, kWords)));
  if (colon != std::string::npos) settings.colour_nodes_nm = parse_colour_nodes(text.substr(colon + 1));
}

}  // namespace

void add_colour_option(Options& options, RenderSettings& settings) {
  options.text(
      "--colour", [&settings](const std::string& text) { set_colour(text, settings); },
      "what colours are computed as: red, green and blue, or spectra that are straight lines between 4 or 20 "
      "wavelengths, between those that the scene's colours have (spectral), between N evenly spaced ones "
      "(spectral:N) or these (spectral:400,500,600 in nm) (default: rgb)",
      "rgb|meyer4|spectral20|spectral[:N|:NM,...]");
}

}  // namespace rayfarm
