#include "common/description/formats/ies_loader.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

#include "common/description/formats/scene_loaders.h"
#include "common/description/scene_description.h"
#include "common/errors/input_error.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

constexpr uintmax_t kMostBytes = 64u << 20;
constexpr double kMostAngles = 10'000;

class Reader {
 public:
  Reader(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  std::string_view line() {
    line_ = next_line_++;
    const size_t end = std::min(text_.find('\n'), text_.size());
    std::string_view row = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    if (!row.empty() && row.back() == '\r') row.remove_suffix(1);
    return row;
  }
  bool at_end() const { return text_.empty(); }

  double number(const char* what) {
    while (!text_.empty() &&
           (std::isspace(static_cast<unsigned char>(text_.front())) || text_.front() == ',')) {
      if (text_.front() == '\n') ++next_line_;
      text_.remove_prefix(1);
    }
    line_ = next_line_;
    if (!text_.empty() && text_.front() == '+') text_.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value))
      fail(text_.empty() ? fmt::format("the file ends before {}", what)
                         : fmt::format("{} is no number", what));
    text_.remove_prefix(static_cast<size_t>(stop - text_.data()));
    return value;
  }

  [[noreturn]] void fail(const std::string& problem) const { throw InputError({path_, line_, 1}, problem); }

 private:
  std::string_view text_;
  std::string path_;
  int line_ = 1, next_line_ = 1;
};

}  // namespace

std::vector<double> load_ies(const std::string& path, GoniometricDiagram& diagram,
                             const std::stop_token& stop) {
  const std::string text = read_text_file(path, kMostBytes, stop);
  Reader reader(text, path);
  std::string_view tilt;
  while (true) {
    if (reader.at_end()) reader.fail("no TILT line: this is no photometric file of the IES");
    tilt = reader.line();
    if (tilt.starts_with("TILT=")) break;
  }
  tilt.remove_prefix(5);
  if (tilt.starts_with("INCLUDE")) {
    reader.number("the lamp's geometry");
    const double pairs = reader.number("the number of tilt angles");
    if (!(pairs >= 0 && pairs <= kMostAngles)) reader.fail("the number of tilt angles is out of bounds");
    for (int i = 0; i < 2 * static_cast<int>(pairs); ++i) reader.number("a tilt angle or factor");
  } else if (!tilt.starts_with("NONE")) {
    reader.fail(fmt::format("TILT={}: tilt factors in a file of their own are not read; use NONE or INCLUDE",
                            std::string(tilt.substr(0, 40))));
  }
  reader.number("the number of lamps");
  reader.number("the lumens per lamp");
  const double multiplier = reader.number("the multiplier");
  const double vertical = reader.number("the number of vertical angles");
  const double horizontal = reader.number("the number of horizontal angles");
  if (!(vertical >= 2 && vertical <= kMostAngles && horizontal >= 1 && horizontal <= kMostAngles))
    reader.fail(
        fmt::format("{:g} vertical and {:g} horizontal angles are out of bounds", vertical, horizontal));
  if (const double type = reader.number("the photometric type"); type != 1)
    reader.fail(fmt::format("photometry of type {}; only type C (1) is read", type == 2   ? "B"
                                                                              : type == 3 ? "A"
                                                                                          : "?"));
  for (const char* what : {"the units", "the width", "the length", "the height"}) reader.number(what);
  const double ballast = reader.number("the ballast factor");
  reader.number("the ballast-lamp factor");
  reader.number("the watts");
  diagram.vertical_count = static_cast<uint32_t>(vertical);
  diagram.horizontal_count = static_cast<uint32_t>(horizontal);
  std::vector<double> values;
  const auto read_angles = [&](uint32_t count, const char* what, double least, double most) {
    for (uint32_t i = 0; i < count; ++i) {
      const double angle = reader.number(what);
      if (angle < least || angle > most || (i > 0 && angle <= values.back()))
        reader.fail(fmt::format("{} must rise from {:g} to at most {:g}, but {:g} stands there", what, least,
                                most, angle));
      values.push_back(angle);
    }
  };
  read_angles(diagram.vertical_count, "a vertical angle", 0, 180);
  read_angles(diagram.horizontal_count, "a horizontal angle", 0, 360);
  const double last = values.back();
  if (last != 0 && last != 90 && last != 180 && last != 360)
    reader.fail(fmt::format("the horizontal angles must end at 0, 90, 180 or 360, not at {:g}", last));
  const size_t count = size_t{diagram.vertical_count} * diagram.horizontal_count;
  for (size_t i = 0; i < count; ++i) {
    const double candela = reader.number("an intensity") * multiplier * ballast;
    if (candela < 0) reader.fail("an intensity is negative");
    values.push_back(candela);
  }
  return values;
}

}  // namespace rayfarm
